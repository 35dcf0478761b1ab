"""Recomputes what a control paper prints and says, claim by claim, whether it holds."""

__version__ = "0.1.0"
