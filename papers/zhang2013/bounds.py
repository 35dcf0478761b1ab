"""What Theorem 1 of zhang2013 gives for gains at hand: the least gamma, and the largest d_M."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from gainsay.errors import ComputationError
from gainsay.lmi import Infimum, Program, Solved, Variable, block_diagonal, infimum, matrix, scalar, solve, symmetric
from papers.zhang2013.plant import Spacecraft
from papers.zhang2013.theorem1 import PARTS, Delayed, Functional, theorem1, without_slack

Form = Callable[..., object]


@dataclass(frozen=True)
class Structured:
    """The unknowns of Theorem 1 under (25): block diagonal, with P3 = diag(lambda1 P21, lambda2 P22)."""

    lambda1: float
    lambda2: float
    parts: dict[str, tuple[Variable, Variable]] = field(init=False)

    def __post_init__(self) -> None:
        names = {"P1": ("P11", "P12"), "Q1": ("Q11", "Q12"), "Q2": ("Q21", "Q22"), "R": ("R1", "R2")}
        pairs = {name: (symmetric(x, 2), symmetric(e, 1)) for name, (x, e) in names.items()}
        object.__setattr__(self, "parts", pairs)
        P21, P22 = matrix("P21", 2, 2), matrix("P22", 1, 1)
        for name, pair in pairs.items():
            object.__setattr__(self, name, block_diagonal(*pair))
        object.__setattr__(self, "P2", block_diagonal(P21, P22))
        object.__setattr__(self, "P3", block_diagonal(self.lambda1 * P21, self.lambda2 * P22))

    @property
    def positive(self) -> tuple:
        """Every diagonal block of P1, Q1, Q2, R positive definite."""
        return tuple((v > 0).named(f"{v.name} > 0") for pair in self.parts.values() for v in pair)


def gamma_program(loop: Delayed, v: object, form: Form = theorem1) -> Program:
    """Least gamma^2 of (9a), (9b) for one loop; unknown "gamma2" beside those of `v`."""
    gamma_squared = scalar("gamma2")
    held = [form(loop, v, gamma_squared, part) < 0 for part in PARTS]
    return Program(minimise=gamma_squared, subject_to=[*held, *v.positive], label="(9) least gamma")


def least_gamma(loop: Delayed, v: object | None = None, form: Form = without_slack) -> Infimum:
    """Enclose the least gamma^2 for which the inequalities hold.

    Parameters
    ----------
    loop : Delayed
    v : Functional or Structured, optional
        Unknowns; the full ones where left out.
    form : callable
        `theorem1`, or `without_slack`, which has the same infimum and is better conditioned.

    Raises
    ------
    ComputationError
        If the solver gave no checked enclosure.
    """
    found = infimum(gamma_program(loop, v or Functional(len(loop.A)), form))
    if not isinstance(found, Infimum):
        raise ComputationError("(9)", f"least gamma at d_M = {loop.d_M:.9g} s: {type(found).__name__}", found.attempts)
    return found


def lifted(loop: Delayed, values: dict) -> dict:
    """Unknowns of (9) from those of `without_slack`: P2 = P1 and P3 = d_M R."""
    return {**values, "P2": values["P1"], "P3": loop.d_M * values["R"]}


_STEPS = (1e-7, 1e-6, 3e-6, 1e-5, 3e-5, 1e-4, 3e-4, 1e-3)
_WIDTH = 1e-7


def first_refuted(refuted: Callable[[float], bool], proved: float, limit: float) -> float:
    """Return the first delay, s, in growing relative steps above `proved`, that is refuted; `limit` where none is.

    Parameters
    ----------
    refuted : callable
        Delay in s -> whether checked multipliers show that the condition has no solution there.
    proved, limit : float
        s; the condition holds at `proved` and cannot hold beyond `limit`.
    """
    for step in _STEPS:
        delay = proved * (1 + step)
        if delay >= limit:
            break
        try:
            if refuted(delay):
                return delay
        except ComputationError:  # no enclosure here: nothing is refuted
            continue
    return limit


def largest_delay(
    loop: Delayed, gamma: float, limit: float, v: object | None = None, form: Form = without_slack
) -> tuple[float, float]:
    """Largest d_M at which the inequalities hold for gamma; they hold for every smaller one.

    With S = R/d_M fixed, d_M stands in (9) only in the term d_M^2 S, which grows with it: the set of feasible d_M is an
    interval that starts at zero.

    Parameters
    ----------
    loop : Delayed
    gamma : float
    limit : float
        A delay at which no gamma can do (such as the exact margin), s.
    v, form : optional
        As in `least_gamma`.

    Returns
    -------
    feasible, infeasible : float
        s; the largest delay at which a point was found and checked, and a delay at which the enclosure of the least
        gamma lies above gamma (the limit where there is none).
    """
    v = v or Functional(len(loop.A))

    def holds(d_M: float) -> bool:
        at = replace(loop, d_M=d_M)
        held = [form(at, v, gamma**2, part) < 0 for part in PARTS]
        found = solve(Program(subject_to=[*held, *v.positive], label="(9) for a gamma"))
        if isinstance(found, Solved):
            return True
        try:
            return least_gamma(at, v, form).upper < gamma**2
        except ComputationError:
            return False

    low, high = 0.0, limit
    while high - low > _WIDTH * limit:
        middle = (low + high) / 2
        low, high = (middle, high) if holds(middle) else (low, middle)
    return low, first_refuted(lambda d: least_gamma(replace(loop, d_M=d), v, form).lower > gamma**2, low, limit)


def point_at(loop: Delayed, gamma_squared: float) -> dict:
    """Return a point of `without_slack` for a given gamma^2, with as much margin as the solver finds.

    Raises
    ------
    ComputationError
        If it finds none.
    """
    v = Functional(len(loop.A))
    held = [without_slack(loop, v, gamma_squared, part) < 0 for part in PARTS]
    for margin in (1e-4, 1e-6, 1e-8):
        found = solve(Program(subject_to=[*held, *v.positive], label="(9)", margin=margin))
        if isinstance(found, Solved):
            return found.values
    raise ComputationError("(9)", f"no point at gamma^2 = {gamma_squared:g}", found.attempts)


def flexible_point(
    craft: Spacecraft, K: np.ndarray, L: np.ndarray, mode: str, d_M: float, mu: float
) -> tuple[dict, str]:
    """Return a point of (9) for the flexible loop from w1 to w2 - w2hat, and the gamma^2 it is for, as text.

    gamma is 1.2 times the least one, which leaves room for rounding the point.
    """
    loop = craft.flexible_loop(K, L, mode)
    given = Delayed(loop.A, loop.A1, loop.B, loop.C[:1] - loop.C[1:], np.zeros((1, 1)), d_M, mu)
    gamma_squared = f"{1.44 * least_gamma(given).value:.6g}"
    return lifted(given, point_at(given, float(gamma_squared))), gamma_squared
