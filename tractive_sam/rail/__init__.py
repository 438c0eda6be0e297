"""Wheel and rail: profiles, contact points and patches of a wheelset on a track."""
