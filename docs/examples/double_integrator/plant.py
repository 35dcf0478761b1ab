"""A unit mass under a force: x'' = u, cost the integral of x^2 + u^2."""

import numpy as np

from gainsay.tables import Case

#: the same in formulas over the tables, which the checker evaluates exactly
FORMULAS = {
    "A": "[[0, 1], [0, 0]]",
    "B": "[[0], [1]]",
    "K": "printed('K')",
    "P": "printed('P')",
    "Acl": "A - B@K",
}
A = np.array([[0.0, 1.0], [0.0, 0.0]])
B = np.array([[0.0], [1.0]])
Q = np.diag([1.0, 0.0])


def closed_loop(case: Case) -> np.ndarray:
    """Return A - B K of the state (displacement, velocity), shape (2, 2)."""
    return A - B @ case.matrix("K")


def cost(case: Case, v0: float) -> float:
    """Return x' P x of the start with an initial velocity in m/s."""
    x = np.array([case.number("x0"), v0])
    return float(x @ case.matrix("P") @ x)
