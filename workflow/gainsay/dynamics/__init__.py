"""Equations of motion shared by papers: relative orbits, attitude, flexible modes, disturbances."""
