"""LMI bounds on constant delays: the Bessel-Legendre hierarchy.

References
----------
A. Seuret, F. Gouaisbaut, Hierarchy of LMI conditions for the stability analysis of time-delay systems, Systems &
Control Letters 81 (2015) 1-7, theorem 5. Degree 0 is Jensen's inequality, degree 1 Wirtinger's.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from gainsay.errors import ComputationError, InputError
from gainsay.exact.floats import real_array
from gainsay.lmi import (
    Affine,
    Definite,
    Infimum,
    Program,
    affine,
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
    """Matrix inequalities that prove x' = A x + Bd v(t - h), v = Cd x, stable; unknowns P, and S, R of every delay.

    Attributes
    ----------
    derivative : Affine, shape (n + (1 + N) r, n + (1 + N) r)
        Negative definite: the functional decreases, in (x, v(t - h), 1/h int L_0 v, ..., 1/h int L_{N-1} v), the last
        ones once a delay.
    functional : Affine, shape (n + N r, n + N r)
        Positive definite: the functional is positive.
    weights : tuple of Affine
        S and R of every delay, positive definite.
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


def bessel_legendre(A: np.ndarray, Bd: np.ndarray, Cd: np.ndarray, delay: ArrayLike, degree: int) -> DelayCondition:
    """Condition for x' = A x + sum_i Bd[:, i] v_i(t - h_i), v = Cd x, with Legendre polynomials under v'.

    With one delay, Bd = Ad and Cd = I this is the theorem as published. With fewer channels the integrals, S and R are
    of v alone: a smaller condition, of which every solution is one of the published condition in the limit of small
    extra terms. Signals of another delay bring integrals, S and R of their own, and P is of them all.

    Parameters
    ----------
    A, Bd, Cd : ndarray
        Shapes (n, n), (n, r), (r, n).
    delay : float or array_like, shape (r,)
        h, s, positive: one for all delayed signals, or one a signal.
    degree : int
        N >= 0.
    """
    if degree < 0:
        raise InputError("", field="degree", value=degree, expected="at least 0")
    x, lines = _delay_lines(Bd, Cd, delay, degree)
    slope = A @ x + sum(line.Bd @ line.late for line in lines)
    moments = [line.moments(x, degree) for line in lines]
    state = np.vstack([x, *(line.delay * line.integrals for line in lines)])
    rate = np.vstack([slope, *(moment for line_moments in moments for moment in line_moments[:degree])])
    P = symmetric("P", len(state))
    derivative, masses, weights = sym(state.T @ P @ rate), [affine(np.zeros(A.shape))], []
    for k, (line, line_moments) in enumerate(zip(lines, moments, strict=True), 1):
        h, v, size = line.delay, line.Cd @ x, len(line.Cd)
        S, R = (symmetric(f"{name}{k if len(lines) > 1 else ''}", size) for name in "SR")
        channel = line.Cd @ slope  # v'
        derivative = derivative + h**2 * (channel.T @ R @ channel) + v.T @ S @ v - line.late.T @ S @ line.late
        for j, moment in enumerate(line_moments):
            derivative = derivative - (2 * j + 1) * (moment.T @ R @ moment)
        masses += [((2 * j + 1) / h) * S for j in range(degree)]
        weights += [S, R]
    return DelayCondition(derivative, P + block_diagonal(*masses), tuple(weights))


@dataclass(frozen=True, eq=False)
class _Line:
    """The signals v = Cd x of one delay h, and where v(t - h) and their integrals stand in the condition's vector."""

    Bd: np.ndarray
    Cd: np.ndarray
    delay: float
    late: np.ndarray
    integrals: np.ndarray

    def moments(self, x: np.ndarray, degree: int) -> list[np.ndarray]:
        """Integrals of L_0 v', ..., L_N v' over the past."""
        parts = np.split(self.integrals, degree) if degree else []
        return [
            self.Cd @ x - (-1.0) ** k * self.late + sum(map(np.multiply, legendre_slopes(degree, k), parts))
            for k in range(degree + 1)
        ]


def _delay_lines(Bd: np.ndarray, Cd: np.ndarray, delay: ArrayLike, degree: int) -> tuple[np.ndarray, list[_Line]]:
    """Rows of the identity that pick x from (x, v(t - h), integrals of it, those of the next delay, ...), and these."""
    n, r = Bd.shape
    given = real_array(delay, "delay")
    if given.shape not in ((), (r,)) or not (given > 0).all():
        raise InputError("", field="delay", value=given.tolist(), expected=f"a time above 0 s, or {r}: one a signal")
    delays = np.broadcast_to(given, (r,))
    groups = [(h, delays == h) for h in np.unique(delays)]
    sizes = [size for _, chosen in groups for size in (chosen.sum(), degree * chosen.sum())]
    x, *rest = np.split(np.eye(n + sum(sizes)), np.cumsum([n, *sizes[:-1]]))
    places = zip(groups, rest[::2], rest[1::2], strict=True)
    return x, [_Line(Bd[:, chosen], Cd[chosen], float(h), late, past) for (h, chosen), late, past in places]


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
    optimum = infimum(Program(minimise=-t, subject_to=[*held, equal(total, 1.0, "traces")], label="delay condition"))
    if not isinstance(optimum, Infimum):
        raise ComputationError("delay condition", f"{type(optimum).__name__.lower()}", optimum.attempts)
    return optimum


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
