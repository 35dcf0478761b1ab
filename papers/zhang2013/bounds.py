"""What Theorem 1 of zhang2013 gives for gains at hand: the least gamma, and the largest d_M."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from flint import fmpq
from scipy.optimize import brentq

from gainsay.errors import ComputationError
from gainsay.lmi import (
    Affine,
    Definite,
    Infimum,
    Program,
    Solved,
    Variable,
    block_diagonal,
    infimum,
    matrix,
    scalar,
    solve,
    symmetric,
)
from gainsay.systems.delay import DelaySystem
from gainsay.systems.delay_bounds import DelayCondition, level, proved_delay
from gainsay.systems.delay_spectrum import gain_stays_below, hinf_norm
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
    # Where no multipliers are proved the checked point still stands: it is the value, and the bound from above.
    return found if np.isfinite(found.value) else replace(found, value=found.upper)


def lifted(loop: Delayed, values: dict) -> dict:
    """Unknowns of (9) from those of `without_slack`: P2 = P1 and P3 = d_M R."""
    return {**values, "P2": values["P1"], "P3": loop.d_M * values["R"]}


_STEPS = (1e-6, 3e-6, 1e-5, 3e-5, 1e-4, 3e-4, 1e-3, 3e-3)


def first_refuted(refuted: Callable[[float], bool], near: float, limit: float, least: float = 0.0) -> float:
    """Return the first delay, s, in growing relative steps above `near`, that is refuted; `limit` where none is.

    Parameters
    ----------
    refuted : callable
        Delay in s -> whether checked multipliers show that the condition has no solution there.
    near, limit : float
        s; the condition holds up to about `near` and cannot hold beyond `limit`.
    least : float
        Least step taken.
    """
    for step in _STEPS:
        delay = near * (1 + step)
        if step < least:
            continue
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

    def room(d_M: float) -> float:
        """1/gamma^2 less the one wanted: it falls to zero almost linearly, where gamma^2 itself grows without bound."""
        try:
            return 1 / least_gamma(replace(loop, d_M=d_M), v, form).value - gamma**-2
        except ComputationError:
            return -(gamma**-2)

    def holds(d_M: float) -> bool:
        at = replace(loop, d_M=d_M)
        held = [form(at, v, gamma**2, part) < 0 for part in PARTS]
        return isinstance(solve(Program(subject_to=[*held, *v.positive], label="(9) for a gamma")), Solved)

    root = float(brentq(room, limit / 2, limit, xtol=1e-6 * limit))
    for step in _STEPS:
        if step >= _LEAST and holds(root * (1 - step)):
            refuted = first_refuted(
                lambda d: least_gamma(replace(loop, d_M=d), v, form).lower > gamma**2, root, limit, _LEAST
            )
            return root * (1 - step), refuted
    raise ComputationError("(9) for a gamma", f"no checked point a little below d_M = {root:.9g} s")


_LEAST = 1e-4
"""Least relative distance from the root at which a point or multipliers are asked for: nearer, both are noise."""


def turning_delay(
    condition: Callable[[float], DelayCondition], low: float, limit: float, relative: float
) -> tuple[float, float]:
    """Delays, s, between which a condition turns: a point of it is checked at the first, multipliers at the second.

    Parameters
    ----------
    condition : callable
        Delay in s -> the condition.
    low, limit : float
        s; it holds at `low` (0: not known of any), and cannot hold at `limit`.
    relative : float
        Width of the bisection, relative to the limit.
    """
    proved, _ = proved_delay(lambda h: condition(h).blocks, limit, relative, low)
    return proved, first_refuted(lambda h: level(condition(h)).lower > 0, proved, limit, relative)


def delay_below(blocks: Callable[[float], Sequence[Affine]], limit: float) -> float:
    """Largest of the delays 2e-4, 1e-3 and 1e-2 of itself below a limit at which a point of a condition is checked, s.

    Raises
    ------
    ComputationError
        If there is none.
    """
    for room in (2e-4, 1e-3, 1e-2):
        delay = limit * (1 - room)
        held = [Definite(f"block {i}", block) for i, block in enumerate(blocks(delay))]
        if isinstance(solve(Program(subject_to=held, label="delay condition")), Solved):
            return delay
    raise ComputationError("delay condition", f"no checked point a little below {limit:.9g} s")


NORM_ROOM = 1e-7
"""Relative room between a norm and the level proved above it."""


def enclosed_norm(loop: DelaySystem, delay: fmpq) -> dict[str, object]:
    """Value, lower, upper and method of the norm of a loop under a constant delay; `results.quantity` takes them.

    Raises
    ------
    ComputationError
        If the gain is not proved to stay below the level.
    """
    peak = hinf_norm(loop, float(delay.p) / float(delay.q))
    level = peak.value * (1 + NORM_ROOM)
    if not gain_stays_below(loop, delay, fmpq(round(level * 10**15), 10**15)):
        raise ComputationError("norm", f"the gain exceeds {level!r}")
    return {
        "value": peak.value,
        "lower": peak.value * (1 - 1e-13),
        "upper": level,
        "method": f"level sets and exact response, peak at {peak.frequency:.7g} rad/s; upper: balls over "
        "all frequencies",
    }


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

    gamma^2 is the next power of ten above four times that of the exact norm at d_M, below which no point can be.
    """
    loop = craft.flexible_loop(K, L, mode)
    error = loop.C[:1] - loop.C[1:]
    given = Delayed(loop.A, loop.A1, loop.B, error, np.zeros((1, 1)), d_M, mu)
    norm = hinf_norm(DelaySystem(loop.A, loop.Bd, loop.Cd, loop.B, error), d_M).value
    gamma_squared = 10.0 ** math.ceil(math.log10(4 * norm**2))
    return lifted(given, point_at(given, gamma_squared)), f"{gamma_squared:g}"
