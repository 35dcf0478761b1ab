"""Integration of ordinary, periodic and delay differential equations."""
