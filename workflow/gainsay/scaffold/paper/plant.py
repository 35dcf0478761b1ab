"""The physics of the paper: (1) and (2)."""

import numpy as np

from gainsay.tables import Case

#: the same in formulas over the tables, which the checker evaluates exactly
FORMULAS = {
    "A": "[[0, 1], [0, 0]]",
    "B": "[[0], [1 / number('J')]]",
    "K": "printed('K')",
    "Acl": "A - B@K",
}


def closed_loop(case: Case) -> np.ndarray:
    """Return A - B K of the state (angle, rate), shape (2, 2)."""
    B = np.array([[0.0], [1 / case.number("J")]])
    return np.array([[0.0, 1.0], [0.0, 0.0]]) - B @ case.matrix("K")
