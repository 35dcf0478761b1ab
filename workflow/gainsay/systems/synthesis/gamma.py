"""The least H-infinity norm that a controller from y to u reaches, by two Riccati equations.

References
----------
J. C. Doyle, K. Glover, P. P. Khargonekar, B. A. Francis, State-space solutions to standard H2 and H-infinity control
problems, IEEE Trans. Automatic Control 34 (1989) 831-847.
"""

import numpy as np
from scipy.linalg import schur

from gainsay.errors import ComputationError, InputError
from gainsay.systems.synthesis.plant import StandardPlant

__all__ = ["hinf_least_level"]

_LEAST, _MOST = 2.0**-60, 2.0**60


def hinf_least_level(plant: StandardPlant, *, tolerance: float = 1e-10) -> tuple[float, float]:
    """Enclose the least H-infinity norm from w to z over all controllers from y to u, by bisection.

    Both ends are computed in doubles and proved by nothing: a band for a number that a paper prints.

    Parameters
    ----------
    plant : StandardPlant
        In continuous time with D11 = 0, D12 of full column and D21 of full row rank.
    tolerance : float, optional
        Relative width at which the bisection stops.

    Returns
    -------
    low, high : float
        A level that is refused, zero where none is, and one that is reached.

    Raises
    ------
    InputError
        If the plant is not as asked.
    ComputationError
        If no level is reached: the plant cannot be stabilised.

    Examples
    --------
    >>> plant = StandardPlant([[0.0]], [[1.0, 0.0]], [[1.0]], [[1.0], [0.0]], [[1.0]],
    ...                       D12=[[0.0], [1.0]], D21=[[0.0, 1.0]])
    >>> low, high = hinf_least_level(plant)  # X = Y = 1/sqrt(1 - 1/g^2), and X Y = g^2 at g^2 = 2
    >>> low <= 2**0.5 <= high
    True
    """
    _check(plant)
    high = 1.0
    while not _reached(plant, high):
        high *= 2
        if high > _MOST:
            raise ComputationError("least H-infinity norm", f"no controller reaches {high:.3g}")
    low = high / 2
    while _reached(plant, low):
        low, high = low / 2, low
        if low < _LEAST:
            return 0.0, high
    while high - low > tolerance * high:
        middle = (low + high) / 2
        low, high = (low, middle) if _reached(plant, middle) else (middle, high)
    return low, high


def _check(plant: StandardPlant) -> None:
    if plant.D11.any():
        raise InputError("plant", field="D11", value=plant.D11.tolist(), expected="zero")
    for name, D, count in (("D12", plant.D12, plant.B2.shape[1]), ("D21", plant.D21, len(plant.C2))):
        if np.linalg.matrix_rank(D) < count:
            raise InputError("plant", field=name, value=D.tolist(), expected=f"rank {count}")


def _reached(plant: StandardPlant, level: float) -> bool:
    """Whether both Riccati equations have stabilising solutions X, Y >= 0 with the spectral radius of XY in bounds."""
    X = _stabilising(plant.A, plant.B1, plant.B2, plant.C1, plant.D12, level)
    Y = _stabilising(plant.A.T, plant.C1.T, plant.C2.T, plant.B1.T, plant.D21.T, level)
    return X is not None and Y is not None and bool(np.abs(np.linalg.eigvals(X @ Y)).max() < level**2)


def _stabilising(
    A: np.ndarray, B1: np.ndarray, B2: np.ndarray, C: np.ndarray, D: np.ndarray, level: float
) -> np.ndarray | None:
    """Stabilising solution X >= 0 of the equation of full information, None where it has none."""
    inverse = np.linalg.inv(D.T @ D)
    moved, rest = A - B2 @ inverse @ D.T @ C, C - D @ inverse @ D.T @ C
    H = np.block([[moved, B1 @ B1.T / level**2 - B2 @ inverse @ B2.T], [-rest.T @ rest, -moved.T]])
    n = len(A)
    _, U, stable = schur(H, sort="lhp")
    if stable != n or np.linalg.cond(U[:n, :n]) > 1 / np.finfo(float).eps:
        return None
    X = np.linalg.solve(U[:n, :n].T, U[n:, :n].T).T
    X = (X + X.T) / 2
    return X if np.linalg.eigvalsh(X).min() > -1e-9 * max(np.abs(X).max(), 1e-300) else None
