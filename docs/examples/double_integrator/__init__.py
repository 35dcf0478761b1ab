"""The linear-quadratic regulator of the double integrator, where every number has a closed form."""
