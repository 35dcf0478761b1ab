"""What Theorem 1 of zhang2013 gives for gains at hand: the least gamma, and the largest d_M."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.optimize import brentq

from gainsay.errors import ComputationError
from gainsay.lmi import Infimum, Program, Solved, Variable, block_diagonal, infimum, matrix, scalar, solve, symmetric
from papers.zhang2013.plant import Spacecraft
from papers.zhang2013.theorem1 import PARTS, Delayed, Functional, theorem1, without_slack

Form = Callable[..., object]
_SPREAD = 4e-4  # relative half width of the neighbourhood in which the largest delay is averaged


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


def largest_delay(
    loop: Delayed, gamma: float, limit: float, v: object | None = None, form: Form = without_slack
) -> tuple[float, float, float]:
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
    value, feasible, infeasible : float
        s; at `feasible` a checked point has a smaller gamma, at `infeasible` the enclosure lies above gamma or the
        solver found no point.
    """
    feasible, infeasible, weights = 0.0, limit, []

    def excess(d_M: float) -> float:
        nonlocal feasible, infeasible
        found = least_gamma(replace(loop, d_M=d_M), v, form)
        if found.upper < gamma**2:
            feasible = max(feasible, d_M)
        if found.lower > gamma**2:
            infeasible = min(infeasible, d_M)
        weights.append(1 / (found.upper - max(found.lower, 0.0) + 1e-6))
        return 1 / np.sqrt(found.value) - 1 / gamma

    low, high = 0.0, limit
    while True:  # bracket: the enclosure exists on both sides of the wanted delay, but not up to the limit
        middle = (low + high) / 2
        if high - low < 1e-6:
            return low, feasible, high
        try:
            positive = excess(middle) > 0
        except ComputationError:
            high = middle
            continue
        if positive:
            low = middle
        else:
            break
    root = float(brentq(excess, low, middle, xtol=1e-5))
    # 1/gamma is smooth in d_M, but some of the solver's values are good to 1e-3 only here, and their enclosures say
    # which: a parabola through eleven values, each weighted by the width of its enclosure, settles it.
    spread = _SPREAD * np.linspace(-1, 1, 11)
    values = [excess(root * (1 + e)) for e in spread]
    fit = np.polynomial.Polynomial.fit(spread, values, 2, w=np.array(weights[-len(spread) :]))
    roots = fit.roots()
    nearest = float(np.real(roots[np.argmin(np.abs(roots))]))
    if abs(nearest) > _SPREAD:
        raise ComputationError("(9)", f"largest d_M near {root:.9g} s: its neighbours do not confirm it")
    return root * (1 + nearest), feasible, infeasible


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
