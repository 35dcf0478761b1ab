"""LMI bounds on a constant delay: the Bessel-Legendre hierarchy.

References
----------
A. Seuret, F. Gouaisbaut, Hierarchy of LMI conditions for the stability analysis of time-delay systems, Systems &
Control Letters 81 (2015) 1-7, theorem 5. Degree 0 is Jensen's inequality, degree 1 Wirtinger's.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from gainsay.errors import ComputationError, InputError
from gainsay.lmi import (
    Affine,
    Definite,
    Infimum,
    Program,
    block_diagonal,
    equal,
    find_point,
    infimum,
    scalar,
    sym,
    symmetric,
    trace,
)


@dataclass(frozen=True)
class DelayCondition:
    """Matrix inequalities that prove x' = A x + Ad x(t - h) stable; unknowns P, S, R.

    Attributes
    ----------
    derivative : Affine, shape ((2 + N) n, (2 + N) n)
        Negative definite: the functional decreases, in (x, x(t - h), 1/h int L_0 x, ..., 1/h int L_{N-1} x).
    functional : Affine, shape ((1 + N) n, (1 + N) n)
        Positive definite: the functional is positive.
    weights : tuple of Affine
        S and R, positive definite.
    """

    derivative: Affine
    functional: Affine
    weights: tuple[Affine, ...]

    @property
    def blocks(self) -> tuple[Affine, ...]:
        """Every matrix that is to be positive definite."""
        return (-self.derivative, self.functional, *self.weights)


def legendre_slopes(degree: int, k: int) -> np.ndarray:
    """Coefficients gamma^i_k of int L_k(u) x'(t + u) du = x(t) - (-1)^k x(t - h) + sum_i gamma^i_k (1/h) int L_i x.

    Returns
    -------
    ndarray, shape (degree,)
        -(2 i + 1)(1 - (-1)^(k + i)) for i < k, else 0.
    """
    i = np.arange(degree)
    return np.where(i < k, -(2 * i + 1) * (1 - (-1.0) ** (k + i)), 0.0)


def bessel_legendre(A: np.ndarray, Bd: np.ndarray, Cd: np.ndarray, delay: float, degree: int) -> DelayCondition:
    """Condition for x' = A x + Bd v(t - h), v = Cd x, with Legendre polynomials up to a degree under v'.

    With Bd = Ad and Cd = I this is the theorem as published. With fewer channels the integrals, S and R are of v alone:
    a smaller condition, of which every solution is one of the published condition in the limit of small extra terms.

    Parameters
    ----------
    A, Bd, Cd : ndarray
        Shapes (n, n), (n, r), (r, n).
    delay : float
        h, s, positive.
    degree : int
        N >= 0.
    """
    (n, r), h, N = Bd.shape, delay, degree
    if not delay > 0 or degree < 0:
        raise InputError("", field="delay, degree", value=(delay, degree), expected="delay > 0 s, degree >= 0")
    P, S, R = symmetric("P", n + N * r), symmetric("S", r), symmetric("R", r)
    eye = np.eye(r)
    slope = np.hstack([A, Bd, np.zeros((n, N * r))])
    channel = Cd @ slope  # v'
    moments = [np.hstack([Cd, -((-1.0) ** k) * eye, *(g * eye for g in legendre_slopes(N, k))]) for k in range(N + 1)]
    state = np.zeros((n + N * r, n + r + N * r))
    state[:n, :n] = np.eye(n)
    state[n:, n + r :] = h * np.eye(N * r)
    rate = np.vstack([slope, *moments[:N]])
    tail = [np.zeros((N * r, N * r))] if N else []
    derivative = sym(state.T @ P @ rate) + h**2 * (channel.T @ R @ channel)
    derivative = derivative + block_diagonal(Cd.T @ S @ Cd, -S, *tail)
    for k, moment in enumerate(moments):
        derivative = derivative - (2 * k + 1) * (moment.T @ R @ moment)
    functional = P + (1 / h) * block_diagonal(np.zeros((n, n)), *((2 * k + 1) * S for k in range(N)))
    return DelayCondition(derivative, functional, (S, R))


def level(condition: DelayCondition) -> Infimum:
    """Largest t with every block >= t I while all traces add to one: positive exactly if the condition is feasible.

    Returns
    -------
    Infimum
        Of -t.

    Raises
    ------
    ComputationError
        If the solver gave no checked enclosure.
    """
    t = scalar("t")
    total = sum((trace(block) for block in condition.blocks[1:]), trace(condition.blocks[0]))
    held: list = [
        Definite(f"block {i}", block - t * np.eye(block.shape[0])) for i, block in enumerate(condition.blocks)
    ]
    found = infimum(Program(minimise=-t, subject_to=[*held, equal(total, 1.0, "traces")], label="delay condition"))
    if not isinstance(found, Infimum):
        raise ComputationError("delay condition", f"{type(found).__name__.lower()}", found.attempts)
    return found


def proved_delay(
    blocks: Callable[[float], Sequence[Affine]], limit: float, relative: float = 1e-4, low: float = 0.0
) -> tuple[float, float]:
    """Largest delay at which a checked point of a condition is found, by bisection below a limit.

    Parameters
    ----------
    blocks : callable
        Delay in s -> every matrix that is to be positive definite.
    limit : float
        Delay at which the condition cannot hold, s.
    relative : float
        Width of the final bracket.
    low : float
        Delay at which the condition is known to hold, s.

    Returns
    -------
    proved, tried : float
        s; the condition is checked at `proved` (`low` where it is nowhere above), and no point was found at `tried`.
    """
    high = limit
    while high - low > relative * limit:
        middle = (low + high) / 2
        held = [Definite(f"block {i}", block) for i, block in enumerate(blocks(middle))]
        if find_point(Program(subject_to=held, label="delay condition")) is not None:
            low = middle
        else:
            high = middle
    return low, high
