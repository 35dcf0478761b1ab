"""Zhang, Li, Guo 2013: disturbance-observer-based H-infinity control with time-varying input delay."""
