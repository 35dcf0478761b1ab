"""The least H-infinity norm by two Riccati equations, another way than the inequalities."""

import numpy as np
from scipy.linalg import schur

from gainsay.tables import Case


def stabilising(H: np.ndarray) -> np.ndarray | None:
    """Stabilising solution of the Riccati equation of a Hamiltonian matrix, or None where it has none."""
    n = len(H) // 2
    _, U, stable = schur(H, sort="lhp")
    if stable != n:
        return None
    return np.linalg.solve(U[:n, :n].T, U[n:, :n].T).T


def attained(case: Case, gamma: float) -> bool:
    """Say whether some controller keeps the norm below gamma (Doyle, Glover, Khargonekar and Francis 1989)."""
    A, B1, B2, F, C, D = (case.matrix(name) for name in ("A", "B1", "B2", "Cinf", "C", "D"))
    seen = A - B1 @ C / D  # the measurement noise is the disturbance itself
    zero = np.zeros((3, 3))
    X = stabilising(np.block([[A, B1 @ B1.T / gamma**2 - B2 @ B2.T], [-F.T @ F, -A.T]]))
    Y = stabilising(np.block([[seen.T, F.T @ F / gamma**2 - C.T @ C / D**2], [zero, -seen]]))
    if X is None or Y is None:
        return False
    positive = min(np.linalg.eigvalsh(X).min(), np.linalg.eigvalsh(Y).min()) > -1e-9
    return bool(positive and abs(np.linalg.eigvals(X @ Y)).max() < gamma**2)


def least_level(case: Case) -> tuple[float, float]:
    """Levels that are not attained and attained, by bisection."""
    low, high = 1.0, 100.0
    while high - low > 1e-9:
        middle = (low + high) / 2
        low, high = (low, middle) if attained(case, middle) else (middle, high)
    return low, high
