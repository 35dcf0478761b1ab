"""Linear systems: state space, poles, norms, regions, linear fractional transformations."""
