"""Wheel and rail: profiles, contact points and patches of a wheelset on a track."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
