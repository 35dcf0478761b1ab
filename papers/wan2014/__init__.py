"""Wan, Liu, Karimi 2014: observer-based robust control for spacecraft rendezvous with thrust saturation."""
