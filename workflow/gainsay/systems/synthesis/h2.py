"""H2 synthesis by two Riccati equations: the regulator, and the regulator on the Kalman filter's estimate.

The gains are rounded numbers; the norm of the loop that they close is enclosed from the gains as they stand, and is
returned only where it agrees with the optimum that the Riccati equations promise.

References
----------
J. Doyle, K. Glover, P. Khargonekar, B. Francis, State-space solutions to standard H2 and H-infinity control problems,
IEEE Trans. Automatic Control 34 (1989) 831-847.
T. Chen, B. Francis, Optimal Sampled-Data Control Systems, Springer 1995, chapter 6: in discrete time.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import solve_continuous_are, solve_discrete_are

from gainsay.errors import ComputationError, InputError
from gainsay.systems.norms import h2_enclosure, require_sample
from gainsay.systems.statespace import StateSpace
from gainsay.systems.synthesis.plant import StandardPlant, Synthesis


def h2_state_feedback(plant: StandardPlant, *, sample: float | None = None) -> Synthesis:
    """State feedback u = K x with the least H2 norm from w to z.

    Parameters
    ----------
    plant : StandardPlant
        In continuous time with D11 = 0 and D12 of full column rank.
    sample : float, optional
        Sampling time, s, of a plant in discrete time; continuous time where None.

    Raises
    ------
    InputError
        If the plant or the sampling time is not as asked.
    ComputationError
        If the Riccati equation has no stabilising solution.
    """
    _require_regular(plant, sample, output=False)
    regulator = _Riccati.of(plant.A, plant.B2, plant.C1, plant.D12, sample is not None)
    optimum = np.trace(plant.B1.T @ regulator.P @ plant.B1) + np.trace(plant.D11.T @ plant.D11)
    return _optimal(regulator.F, plant.with_gain(regulator.F), optimum, sample)


def h2_output_feedback(plant: StandardPlant, *, sample: float | None = None) -> Synthesis:
    """Controller from y to u with the least H2 norm from w to z, of the plant's order.

    Parameters
    ----------
    plant : StandardPlant
        In continuous time with D11 = 0, D12 of full column and D21 of full row rank.
    sample : float, optional
        Sampling time, s, of a plant and a controller in discrete time, where u may depend on y of the same instant;
        continuous time where None.

    Raises
    ------
    InputError
        If the plant or the sampling time is not as asked.
    ComputationError
        If a Riccati equation has no stabilising solution.
    """
    _require_regular(plant, sample, output=True)
    discrete = sample is not None
    A, B1, B2, C1, C2, D11, D12, D21 = (
        getattr(plant, name) for name in ("A", "B1", "B2", "C1", "C2", "D11", "D12", "D21")
    )
    regulator = _Riccati.of(A, B2, C1, D12, discrete)
    filtering = _Riccati.of(A.T, C2.T, B1.T, D21.T, discrete)
    (P, R, F), (S, E, L) = (regulator.P, regulator.R, regulator.F), (filtering.P, filtering.R, filtering.F.T)
    F0, L0 = np.zeros((F.shape[0], B1.shape[1])), np.zeros((F.shape[0], C2.shape[0]))
    if discrete:
        # With w known the best u is F x + F0 w; of that y tells F x^ + L0 (y - C2 x^), x^ the prediction.
        F0 = -np.linalg.solve(R, B2.T @ P @ B1 + D12.T @ D11)
        L0 = np.linalg.solve(E, (F @ S @ C2.T + F0 @ D21.T).T).T
    Ck = F - L0 @ C2
    controller = StateSpace(A + B2 @ Ck + L @ C2, B2 @ L0 - L, Ck, L0)
    full = np.trace(B1.T @ P @ B1) + np.trace(D11.T @ D11) - np.trace(F0.T @ R @ F0)
    missed = F @ S @ F.T + F0 @ F0.T - L0 @ E @ L0.T  # covariance of the best u about what y tells of it
    return _optimal(controller, plant.with_controller(controller), full + np.trace(R @ missed), sample)


@dataclass(frozen=True, eq=False)
class _Riccati:
    """The regulator of x' = A x + B u with the cost |C x + D u|^2.

    Attributes
    ----------
    P, R, F : ndarray
        Least cost x' P x, reached by u = F x; any other u costs (u - F x)' R (u - F x) more.
    """

    P: np.ndarray
    R: np.ndarray
    F: np.ndarray

    @classmethod
    def of(cls, A: np.ndarray, B: np.ndarray, C: np.ndarray, D: np.ndarray, discrete: bool) -> "_Riccati":
        solved = solve_discrete_are if discrete else solve_continuous_are
        try:
            # SciPy before 1.17 takes s only together with e
            P = solved(A, B, C.T @ C, D.T @ D, e=np.eye(len(A)), s=C.T @ D)
            R = D.T @ D + (B.T @ P @ B if discrete else 0)
            return cls(P, R, -np.linalg.solve(R, B.T @ P @ (A if discrete else np.eye(len(A))) + D.T @ C))
        except (np.linalg.LinAlgError, ValueError) as error:
            raise ComputationError("H2 synthesis", f"Riccati equation: {str(error).splitlines()[0]}") from None


def _optimal(controller: np.ndarray | StateSpace, loop: StateSpace, square: float, sample: float | None) -> Synthesis:
    """The synthesis, if the loop has the norm that the Riccati equations promise; two ways to the same number."""
    norm = h2_enclosure(loop.A, loop.B, loop.C, loop.D, sample=sample)
    least = float(np.sqrt(max(square, 0.0)))
    if not abs(norm.upper - least) <= 1e-7 * norm.upper:
        raise ComputationError("H2 synthesis", f"the loop has the norm {norm.upper!r}, the Riccati equations {least!r}")
    return Synthesis(controller, norm, least)


def _require_regular(plant: StandardPlant, sample: float | None, output: bool) -> None:
    if sample is not None:
        require_sample(sample)
        return
    if plant.D11.any():
        raise InputError("H2 synthesis", field="D11", expected="zero: else the norm is infinite")
    if np.linalg.matrix_rank(plant.D12) < plant.D12.shape[1]:
        raise InputError("H2 synthesis", field="D12", expected="full column rank")
    if output and np.linalg.matrix_rank(plant.D21) < plant.D21.shape[0]:
        raise InputError("H2 synthesis", field="D21", expected="full row rank")
