"""Wheel and rail: profiles, contact points and patches of a wheelset on a track."""

from tractive_sam.lazy_names import attach_names

__getattr__, __dir__, __all__ = attach_names(__name__, __file__)
