"""Scherer, Gahinet and Chilali, Example 7: one controller for two norms, by linear matrix inequalities."""
