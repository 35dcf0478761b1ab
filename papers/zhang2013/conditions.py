"""What Theorem 1 of zhang2013 gives for gains at hand: the least gamma, and the largest d_M."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from flint import fmpq
from scipy.optimize import brentq

from gainsay.errors import ComputationError
from gainsay.lmi import Affine, BlockMatrix, Definite, Infimum, Program, Solved, find_point, solve, sym, symmetric
from gainsay.statements import Stated
from gainsay.systems.delay import DelaySystem
from gainsay.systems.delay_bounds import DelayCondition, level, proved_delay
from gainsay.systems.delay_spectrum import gain_stays_below, hinf_norm, spectral_abscissa
from gainsay.tables import Case
from papers.zhang2013.plant import Spacecraft
from papers.zhang2013.statements import PARTS, flexible_loop, least_gamma_program, reduced_theorem_1

Loop = dict[str, str]
#: program of (9) for definitions d_M and g as given
Form = Callable[..., Stated]


def least_gamma(stated: Stated) -> Infimum:
    """Enclose the least gamma^2 of a program of (9) in which g is the unknown gamma2.

    Raises
    ------
    ComputationError
        If the solver gave no checked enclosure.
    """
    return least_gamma_program(stated).infimum().need("(9) least gamma")


def lifted(values: dict[str, Any], d_M: float) -> dict[str, Any]:
    """Unknowns of (9) from those without slack: P2 = P1 and P3 = d_M R."""
    return {**values, "P2": values["P1"], "P3": d_M * values["R"]}


def channel_blocks(A: np.ndarray, Bd: np.ndarray, Cd: np.ndarray, d_M: float, mu: float) -> tuple[Affine, ...]:
    """Stability part of (9) for x' = A x + Bd v(t - d), v = Cd x, with Q1, Q2, R of the delayed signal v alone.

    (9) without slack at Q = Cd' q Cd and R = Cd' r Cd, to which small positive definite terms can be added: a delay
    proved by these blocks is proved by Theorem 1, of which they are a cheaper and at most more conservative form.

    Returns
    -------
    tuple of Affine
        Every matrix that is to be positive definite.
    """
    n, r = Bd.shape
    P1, Q1, Q2, R = symmetric("P1", n), symmetric("Q1", r), symmetric("Q2", r), symmetric("R", r)
    blocks = []
    for part, (c, o) in PARTS.items():
        F = BlockMatrix(f"(9{part}) of the delayed signal", "x", "v_d", "v_M", "R")
        F["x", "x"] = sym(P1 @ A) + Cd.T @ (Q1 + Q2 - (c / d_M) * R) @ Cd
        F["x", "v_d"] = P1 @ Bd + (c / d_M) * (Cd.T @ R)
        F["v_d", "v_d"] = -(1 - mu) * Q2 - (4 / d_M) * R
        F["v_d", "v_M"] = (o / d_M) * R
        F["v_M", "v_M"] = -Q1 - (o / d_M) * R
        F["x", "R"] = d_M * ((Cd @ A).T @ R)
        F["v_d", "R"] = d_M * ((Cd @ Bd).T @ R)
        F["R", "R"] = -d_M * R
        blocks.append(-F.assembled)
    return (*blocks, P1, Q1, Q2, R)


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


def largest_delay(case: Case, form: Form, gamma: float, limit: float) -> tuple[float, float]:
    """Largest d_M at which the inequalities hold for gamma; they hold for every smaller one.

    With S = R/d_M fixed, d_M stands in (9) only in the term d_M^2 S, which grows with it: the set of feasible d_M is an
    interval that starts at zero.

    Parameters
    ----------
    case : Case
    form : callable
        Definitions ``d_M`` (s) and ``g`` as keywords -> the program.
    gamma : float
    limit : float
        A delay at which no gamma can do (such as the exact margin), s.

    Returns
    -------
    feasible, infeasible : float
        s; the largest delay at which a point was found and checked, and a delay at which the enclosure of the least
        gamma lies above gamma (the limit where there is none).
    """

    def least(d_M: float) -> Infimum:
        return least_gamma(form(case, d_M=repr(d_M), g="gamma2"))

    def room(d_M: float) -> float:
        """1/gamma^2 less the one wanted: it falls to zero almost linearly, where gamma^2 itself grows without bound."""
        program = least_gamma_program(form(case, d_M=repr(d_M), g="gamma2")).program()
        point = find_point(program)
        return (1 / point.objective if point is not None else 0.0) - gamma**-2

    def holds(d_M: float) -> bool:
        return isinstance(form(case, d_M=repr(d_M), g=repr(gamma**2)).solve(), Solved)

    root = float(brentq(room, limit / 2, limit, xtol=1e-6 * limit))
    for step in _STEPS:
        if step >= _LEAST and holds(root * (1 - step)):
            refuted = first_refuted(lambda d: least(d).lower > gamma**2, root, limit, _LEAST)
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


def enclosed_norm(loop: DelaySystem, delay: fmpq) -> dict[str, Any]:
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


def point_at(stated: Stated) -> dict[str, Any]:
    """Return a point of a program of (9), with as much margin as the solver finds.

    Raises
    ------
    ComputationError
        If it finds none.
    """
    for margin in (1e-4, 1e-6, 1e-8):
        outcome = stated.changed(margin=margin).solve()
        if isinstance(outcome, Solved):
            break
    return outcome.need(stated.label).values


def flexible_point(case: Case, K: str, L: str, mode: str) -> tuple[dict[str, Any], str]:
    """Return a point of (9) for the flexible loop from w1 to w2 - w2hat, and the gamma^2 it is for, as text.

    gamma^2 is the next power of ten above four times that of the exact norm at d_M, below which no point can be.

    Parameters
    ----------
    case : Case
    K, L : str
        Formulas of the gains.
    mode : {"paper", "all"}
    """
    loop, d_M = flexible_loop(K, L, mode), case.number("d_M")
    floats = reduced_theorem_1(case, loop, 7, 1).floats()
    delayed = Spacecraft.of(case).flexible_loop(floats.constant(K), floats.constant(L), mode)
    error = floats.constant("C_z")
    norm = hinf_norm(DelaySystem(delayed.A, delayed.Bd, delayed.Cd, delayed.B, error), d_M).value
    gamma_squared = f"{10.0 ** math.ceil(math.log10(4 * norm**2)):g}"
    return lifted(point_at(reduced_theorem_1(case, loop, 7, 1, g=gamma_squared)), d_M), gamma_squared


@dataclass(frozen=True)
class Standing:
    """How a pair of gains stands on the flexible plant.

    Attributes
    ----------
    margin_paper, margin_all : float
        Exact delay margins in modes "paper" and "all", s.
    abscissa : float
        Largest spectral abscissa over both modes and constant delays 0 and d_M, 1/s.
    """

    margin_paper: float
    margin_all: float
    abscissa: float


def standing(craft: Spacecraft, K: np.ndarray, L: np.ndarray, d_M: float) -> Standing:
    """Delay margins and slowest decay of a pair of gains on the flexible plant."""
    loops = {mode: craft.flexible_loop(K, L, mode) for mode in ("paper", "all")}
    margins = {mode: loop.quasi_polynomial.margin().delay for mode, loop in loops.items()}
    worst = max(spectral_abscissa(loop, delay) for loop in loops.values() for delay in (0.0, d_M))
    return Standing(margins["paper"], margins["all"], worst)
