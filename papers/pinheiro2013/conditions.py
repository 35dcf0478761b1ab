"""Mixed H2/H-infinity state feedback of pinheiro2013: the LMIs (21), their limits, and checks by other means."""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import solve_continuous_are, solve_continuous_lyapunov
from scipy.optimize import minimize, root

from gainsay.errors import ComputationError, InputError
from gainsay.lmi import Program, Solved, solve
from gainsay.systems.norms import h2_norm, hinf_norm
from papers.pinheiro2013.plant import GeneralizedPlant
from papers.pinheiro2013.statements import given_problem

#: condition of the basis of an invariant subspace beyond which its solution is not believed
_WORST_BASIS = 1e12
#: how far above its infimum the H-infinity level is taken where the infimum itself is wanted
ABOVE = 1.001
#: how far two methods may lie apart before neither is believed
AGREE = 1e-5


def gamma_min(plant: GeneralizedPlant) -> float:
    """Infimum of the H-infinity level over all state feedbacks: the norm of D11.

    The norm of D11 bounds it from below, since the response at infinite frequency is D11 for every gain;
    `limit_gain` reaches it.
    """
    return float(np.linalg.norm(plant.D11, 2))


def limit_gain(plant: GeneralizedPlant) -> np.ndarray:
    """Gain that decouples the axes and reaches `gamma_min` exactly.

    Each axis then obeys q'' + k2 q' + k1 q = r w with z_inf = (q'', and a copies of q and b of q'), so that the
    squared gain is |r|^2 (w^4 + b w^2 + a)/((k1 - w^2)^2 + k2^2 w^2): at most |r|^2 at every frequency for
    k1 = sqrt a and k2^2 = 2 k1 + b.
    """
    a = len(plant.axes)
    # Accelerations stand once in z_inf; what remains of C1'C1 counts the copies of angles and rates.
    copies = np.round(np.diag(plant.C1.T @ plant.C1 - plant.A[a:].T @ plant.A[a:]))
    stiffness = np.sqrt(copies[:a])
    damping = np.sqrt(2 * stiffness + copies[a:])
    wanted = np.hstack([np.diag(stiffness), np.diag(damping)])
    return np.linalg.solve(plant.B2[a:], plant.A[a:] + wanted)


@dataclass(frozen=True)
class Design:
    """A state feedback u = -K x with what it achieves.

    Attributes
    ----------
    gamma : float or None
        H-infinity level of the LMI; None for the H2 limit.
    K : ndarray
    sqrt_trace : float
        Bound on the H2 norm by the LMI; for the H2 limit the norm itself.
    h2, hinf : float
        Actual norms from w to z_2 and to z_inf, recomputed from the gain.
    attempts : tuple of dict
    """

    gamma: float | None
    K: np.ndarray
    sqrt_trace: float
    h2: float
    hinf: float
    attempts: tuple[dict, ...] = ()


def mixed_program(
    plant: GeneralizedPlant, gamma: float, *, margin: float = 1e-7, typical: np.ndarray | None = None
) -> Program:
    """State the mixed problem: least trace of Q subject to (21) with the corrected sign.

    Parameters
    ----------
    plant : GeneralizedPlant
    gamma : float
    margin : float, optional
        See `gainsay.lmi.Program`.
    typical : ndarray, optional
        Typical size of X, for scaling.

    Raises
    ------
    InputError
        If gamma does not exceed gamma_min, which the message names.
    """
    least = gamma_min(plant)
    if not gamma > least:
        raise InputError(
            f"no state feedback reaches this level on {'/'.join(plant.axes)}, gamma_min = {least!r}",
            field="gamma",
            value=gamma,
            expected=f"above {least!r}",
        )
    typical = starting_gain(plant, gamma)[1] if typical is None else typical
    return given_problem(plant, gamma, typical, margin).program()


def mixed_design(plant: GeneralizedPlant, gamma: float, *, margin: float = 1e-7) -> Design:
    """Solve (21) with the corrected sign for the least trace of Q and recompute both norms from the gain (22).

    Raises
    ------
    InputError
        If gamma does not exceed gamma_min.
    ComputationError
        If the solver's point does not hold, or its gain violates (23).
    """
    solution = solve(mixed_program(plant, gamma, margin=margin)).need(f"(21) at gamma = {gamma!r}, above gamma_min")
    return evaluated(plant, gamma, solution)


def evaluated(plant: GeneralizedPlant, gamma: float, solution: Solved) -> Design:
    """Recompute what the gain of a solution achieves and hold it against (23)."""
    K = np.linalg.solve(solution["X"], solution["Y"].T).T
    A, B, C, D, C2 = plant.closed(K)
    h2, (hinf, _) = h2_norm(A, B, C2), hinf_norm(A, B, C, D)
    bound = float(np.sqrt(solution.objective))
    if hinf > gamma or h2 > bound:
        raise ComputationError(
            "(23)", f"norms {hinf!r}, {h2!r} above their bounds {gamma!r}, {bound!r}", solution.attempts
        )
    return Design(gamma, K, bound, h2, hinf, solution.attempts)


def h2_gain(plant: GeneralizedPlant) -> tuple[np.ndarray, np.ndarray]:
    """Gain of the H2 limit, gamma to infinity, and the solution of its Riccati equation."""
    R = plant.D22.T @ plant.D22
    S = solve_continuous_are(plant.A, plant.B2, plant.C2.T @ plant.C2, R)
    return np.linalg.solve(R, plant.B2.T @ S), S


def h2_design(plant: GeneralizedPlant) -> Design:
    """Solve the H2 limit by its Riccati equation and recompute both norms from the gain."""
    K, S = h2_gain(plant)
    A, B, C, D, C2 = plant.closed(K)
    bound = float(np.sqrt(np.trace(plant.B1.T @ S @ plant.B1)))
    return Design(None, K, bound, h2_norm(A, B, C2), hinf_norm(A, B, C, D)[0])


def _stabilising(A: np.ndarray, B: np.ndarray, C: np.ndarray, D: np.ndarray, R: np.ndarray) -> np.ndarray | None:
    """Stabilising solution of A X + X A' + B B' + (X C' + B D') R^-1 (X C' + B D')' = 0, or None.

    From the stable invariant subspace of the Hamiltonian matrix, which for two or four states costs a tenth of a
    generalized Schur decomposition; the caller checks the residual and that the solution stabilises.
    """
    inverse = np.linalg.inv(R)
    closed = A + B @ D.T @ inverse @ C
    weight = C.T @ inverse @ C
    constant = B @ B.T + B @ D.T @ inverse @ D @ B.T
    n = len(A)
    values, vectors = np.linalg.eig(np.block([[closed.T, weight], [-constant, -closed]]))
    stable = vectors[:, values.real < 0]
    if stable.shape[1] != n or np.linalg.cond(stable[:n]) > _WORST_BASIS:
        return None
    X = np.linalg.solve(stable[:n].T, stable[n:].T).T.real
    return 0.5 * (X + X.T)


def least_covariance(plant: GeneralizedPlant, K: np.ndarray, gamma: float) -> np.ndarray:
    """Least X that satisfies the first LMI of (21) for a fixed gain, from its Riccati equation, without an LMI.

    Raises
    ------
    ComputationError
        If the gain does not reach the level.
    """
    A, B, C, D, _ = plant.closed(K)
    R = gamma**2 * np.eye(C.shape[0]) - D @ D.T
    X = _stabilising(A, B, C, D, R)
    if X is None:
        raise ComputationError("(21)", f"no covariance at gamma = {gamma!r}")
    cross = X @ C.T + B @ D.T
    gain = np.linalg.solve(R, cross.T)
    residual = A @ X + X @ A.T + B @ B.T + cross @ gain
    # Only the stabilising solution is the least one, and only of an equation that was in fact solved.
    stable = max(np.linalg.eigvals(A).real.max(), np.linalg.eigvals(A + gain.T @ C).real.max()) < 0
    if not stable or np.abs(residual).max() > 1e-9 * np.abs(A @ X).max() or np.linalg.eigvalsh(X).min() <= 0:
        raise ComputationError("(21)", f"the gain does not reach gamma = {gamma!r}")
    return X


def trace_of_gain(plant: GeneralizedPlant, K: np.ndarray, gamma: float) -> float:
    """Least trace of Q for a fixed gain; infinite where the gain does not reach the level."""
    try:
        X = least_covariance(plant, K, gamma)
    except ComputationError:
        return np.inf
    C2 = plant.closed(K)[4]
    return float(np.trace(C2 @ X @ C2.T))


def trace_gradient(plant: GeneralizedPlant, K: np.ndarray, gamma: float) -> np.ndarray:
    """Derivative of `trace_of_gain` by the gain, by the adjoint of its Riccati equation.

    With L = (X C' + B D') (gamma^2 I - D D')^-1 the covariance changes by (dA + L dC) X + its transpose under the
    stable A + L C, so that the derivative is -2 [(B2 + L D12)' P + D22' C2] X with P (A + L C) + its transpose +
    C2' C2 = 0.

    Raises
    ------
    ComputationError
        If the gain does not reach the level.
    """
    X = least_covariance(plant, K, gamma)
    A, B, C, D, C2 = plant.closed(K)
    L = np.linalg.solve(gamma**2 * np.eye(C.shape[0]) - D @ D.T, C @ X + D @ B.T).T
    P = solve_continuous_lyapunov((A + L @ C).T, -C2.T @ C2)
    return -2 * ((plant.B2 + L @ plant.D12).T @ P + plant.D22.T @ C2) @ X


def mixed_by_descent(plant: GeneralizedPlant, gamma: float, start: np.ndarray) -> tuple[np.ndarray, float]:
    """Least trace of Q by descent over the gains, then its stationary point to rounding: a second method, no LMI.

    Returns
    -------
    K : ndarray
    sqrt_trace : float

    Raises
    ------
    ComputationError
        If the descent does not end in a stationary point.
    """
    scale = np.maximum(np.abs(start), 1e-3 * np.abs(start).max())
    size = trace_of_gain(plant, start, gamma)

    def gain(y: np.ndarray) -> np.ndarray:
        return y.reshape(start.shape) * scale

    def cost(y: np.ndarray) -> float:
        return min(trace_of_gain(plant, gain(y), gamma) / size, 1e6)

    def slope(y: np.ndarray) -> np.ndarray:
        try:
            return (trace_gradient(plant, gain(y), gamma) * scale / size).ravel()
        except ComputationError:
            return np.zeros(y.size)

    first = minimize(cost, (start / scale).ravel(), jac=slope, method="BFGS", options={"gtol": 1e-9})
    last = root(slope, first.x, tol=1e-13)
    # The root finder may leave the gains that reach the level, where no slope is defined.
    ends = [y for y in (first.x, last.x) if cost(y) <= first.fun * (1 + 1e-9)]
    best = min(ends, key=lambda y: np.abs(slope(y)).max())
    if not np.abs(slope(best)).max() < 1e-8:
        raise ComputationError("(21)", f"descent over the gains stopped at a slope of {np.abs(slope(best)).max():.1e}")
    return gain(best), float(np.sqrt(cost(best) * size))


def starting_gain(plant: GeneralizedPlant, gamma: float) -> tuple[np.ndarray, np.ndarray]:
    """Gain that reaches a level, as close to the H2 limit as seven trials find, and its least covariance.

    On the segment from the H2 gain to `limit_gain`, whose far end reaches every level above gamma_min.
    """
    first, last = h2_gain(plant)[0], limit_gain(plant)
    try:
        return first, least_covariance(plant, first, gamma)
    except ComputationError:
        low, high, start = 0.0, 1.0, None
    for _ in range(7):
        middle = 0.5 * (low + high)
        K = first + middle * (last - first)
        try:
            start, high = (K, least_covariance(plant, K, gamma)), middle
        except ComputationError:
            low = middle
    return start or (last, least_covariance(plant, last, gamma))
