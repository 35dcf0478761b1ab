"""The least H2 norm that any controller reaches, bounded from below by a dissipation inequality that holds exactly."""

import math
from fractions import Fraction

import numpy as np
from scipy.linalg import solve_continuous_are, solve_continuous_lyapunov

from gainsay.errors import ComputationError
from gainsay.exact.ball import precision
from gainsay.exact.definite import positive_definite, positive_semidefinite
from gainsay.exact.matrix import Matrix
from gainsay.proof.kinds.h2_least import from_output, from_state
from gainsay.systems.synthesis.plant import StandardPlant

_GIVEN = tuple(10.0**k for k in range(-10, -3))  # parts of the optimum that are given away, so that rounding has room


def h2_least(plant: StandardPlant, *, output: bool = False) -> tuple[float, dict[str, np.ndarray]]:
    """Lower bound on the H2 norm of every stable loop, with the witness of a certificate of kind ``h2_least``.

    Parameters
    ----------
    plant : StandardPlant
        In continuous time with D11 = 0, D12 of full column rank; with `output` D21 of full row rank.
    output : bool, optional
        Whether controllers see y; else they see the state.

    Returns
    -------
    lower : float
        Proved: no stabilising controller of the kind reaches less.
    witness : dict of str to ndarray
        P, and with `output` F, R and S.

    Raises
    ------
    ComputationError
        If no witness was found that holds exactly.

    Examples
    --------
    x' = u + w with the cost x^2 + u^2: the least norm is one.

    >>> lower, _ = h2_least(StandardPlant([[0]], [[1]], [[1]], [[1], [0]], [[1]], D12=[[0], [1]]))
    >>> round(lower, 8)
    1.0
    """
    for part in _GIVEN:
        try:
            witness = _witness(plant, part, output)
        except (np.linalg.LinAlgError, ValueError):
            continue
        lower = _proved(plant, witness)
        if lower is not None:
            return lower, witness
    raise ComputationError("H2 synthesis", "no lower bound on the norm of every loop could be proved")


def _witness(plant: StandardPlant, part: float, output: bool) -> dict[str, np.ndarray]:
    """Solutions of Riccati equations of which that part of the optimum is given away."""
    weight = plant.D12.T @ plant.D12
    P = _below(plant.A, plant.B2, plant.C1, plant.D12, plant.B1 @ plant.B1.T, part)
    if not output:
        return {"P": P}
    F = -np.linalg.solve(weight, plant.B2.T @ P + plant.D12.T @ plant.C1)
    S = _below(plant.A.T, plant.C2.T, plant.B1.T, plant.D21.T, F.T @ weight @ F, part)
    return {"P": P, "F": F, "R": (1 - part) * weight, "S": S}


def _below(A: np.ndarray, B: np.ndarray, C: np.ndarray, D: np.ndarray, load: np.ndarray, part: float) -> np.ndarray:
    """P with M(P) > 0: the Riccati equation's solution once a little is taken off the weight of each state.

    As much as lowers trace P load, the load being the covariance of what drives the states, by that part of it.
    """

    def solved(weight: np.ndarray) -> np.ndarray:
        return solve_continuous_are(A, B, weight, D.T @ D, e=np.eye(len(A)), s=C.T @ D)

    P = solved(C.T @ C)
    loop = A - B @ np.linalg.solve(D.T @ D, B.T @ P + D.T @ C)
    spread = np.diag(solve_continuous_lyapunov(loop, -load)).clip(min=0)
    floor = 1e-6 * spread.max() or 1.0
    taken = part * max(np.trace(P @ load), np.finfo(float).tiny) / len(A) / np.maximum(spread, floor)
    P = solved(C.T @ C - np.diag(taken))
    return (P + P.T) / 2


def _proved(plant: StandardPlant, witness: dict[str, np.ndarray]) -> float | None:
    """The bound that the witness proves, rounded down, or None where it proves none."""
    given = {name: _matrix(getattr(plant, name)) for name in ("A", "B1", "B2", "C1", "C2", "D12", "D21")}
    exact = {name: _matrix(value) for name, value in witness.items()}
    with precision():
        if "S" in exact:
            conditions, value = from_output(given, exact["P"], exact["F"], exact["R"], exact["S"])
        else:
            conditions, value = from_state(given, exact["P"])
        if not all((positive_definite if r == ">" else positive_semidefinite)(m.data) for m, r, _ in conditions):
            return None
        return _root_below(value.value())


def _matrix(rows: np.ndarray) -> Matrix:
    return Matrix.of(rows.tolist())


def _root_below(square: Fraction) -> float:
    root = math.sqrt(max(float(square), 0.0))
    while root > 0 and Fraction(root) ** 2 > square:
        root = math.nextafter(root, 0.0)
    return root
