"""Least trace under a Riccati inequality: the example of the LMI Control Toolbox manual."""
