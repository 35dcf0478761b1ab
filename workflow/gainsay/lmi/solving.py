"""Solve a program and believe nothing: a typed result from recomputed blocks, never from a status."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from gainsay.errors import ComputationError
from gainsay.lmi import backends, duality, scaling
from gainsay.lmi.affine import Values
from gainsay.lmi.program import Check, Program

# least margin of phase one that counts as the presence of strict points
_PRESENT = 1e-9


@dataclass(frozen=True)
class Solved:
    """A point at which every block, recomputed in numpy, is strictly definite.

    Attributes
    ----------
    values : dict
        Name of each unknown to its matrix, or number.
    objective : float
        Objective there (an upper bound on the infimum; see `infimum`).
    check : Check
        Margins and blocks.
    gap : float
        Difference of the solver's primal and dual objective, relative; for the record, not a bound.
    attempts : tuple of dict
        What was tried: solver, scaling, status, margin, iterations, seconds.
    """

    values: dict[str, Any]
    objective: float
    check: Check
    gap: float
    attempts: tuple[dict, ...]

    def __getitem__(self, name: str) -> Any:
        return self.values[name]

    @property
    def margins(self) -> dict[str, float]:
        """Margin of each constraint."""
        return self.check.margins


@dataclass(frozen=True)
class Infeasible:
    """No point: a Farkas candidate was found and checked in numpy."""

    farkas: duality.Farkas
    attempts: tuple[dict, ...]


@dataclass(frozen=True)
class Failed:
    """Neither a point nor a candidate: says nothing about the program."""

    label: str
    attempts: tuple[dict, ...]

    @property
    def error(self) -> ComputationError:
        """The error to raise where a solution is needed."""
        return ComputationError(self.label, f"no result after {len(self.attempts)} attempts", self.attempts)


@dataclass(frozen=True)
class Infimum:
    """Enclosure of an infimum: a checked point above, checked multipliers below.

    Attributes
    ----------
    value : float
        The bounds followed to margin zero; the middle of the enclosure where that lies outside it.
    lower, upper : float
        From multipliers and from a strict point; floating point, correct to rounding.
    values : dict
        Point of the solver without margin (on the boundary: limits of what strict points approach).
    solved : Solved
        The strict point behind `upper`.
    multipliers : dict
        The multipliers behind `lower`, by label of the constraint; empty where none passed their check.
    attempts : tuple of dict
    """

    value: float
    lower: float
    upper: float
    values: dict[str, Any]
    solved: Solved
    multipliers: dict[str, np.ndarray]
    attempts: tuple[dict, ...]

    @property
    def width(self) -> float:
        """Relative width of the enclosure."""
        return (self.upper - self.lower) / max(abs(self.value), 1e-300)


def solve(program: Program, near: Values | None = None, rounds: int = 4) -> Solved | Infeasible | Failed:
    """Solve a program.

    The first scaling comes from typical sizes and coefficients; each round rescales from the point found, until the
    objective settles. Only a point whose blocks hold when recomputed counts.

    Parameters
    ----------
    program : Program
    near : mapping, optional
        Values of all unknowns of about the sizes expected, such as the solution of a neighbouring program.
    rounds : int, optional
        Rescalings a setting.

    Returns
    -------
    Solved or Infeasible or Failed
    """
    attempts: list[dict] = []
    first = scaling.first(program) if near is None else scaling.from_point(program, program.coordinates(near))
    for setting in backends.SETTINGS:
        best = _rounds(program, first, setting, rounds, attempts)
        if best is not None:
            return best
        if setting != "clarabel":
            continue
        level, candidate, (x, record) = duality.farkas(program, first)
        attempts.append({**record, "aim": "level", "level": level})
        if candidate is not None and not level > _PRESENT:
            attempts[-1] |= {"residual": candidate.residual, "least": candidate.least, "value": candidate.value}
            if candidate.holds:
                return Infeasible(candidate, tuple(attempts))
        if x is not None and level > _PRESENT:
            first = scaling.from_point(program, x * first.unknowns)
    return Failed(program.label, tuple(attempts))


def _rounds(program: Program, scale: scaling.Scaling, setting: str, rounds: int, attempts: list) -> Solved | None:
    best: Solved | None = None
    for number in range(rounds):
        raw = backends.run(scaling.apply(program, scale), program.constraints, program.margin, setting)
        record = {**raw.record, "scaling": number}
        attempts.append(record)
        if raw.x is None:
            break
        x = raw.x * scale.unknowns
        check = program.check(program.values(x))
        gap = abs(raw.primal - raw.dual) / max(abs(raw.primal), 1e-12)
        record |= {"objective": check.objective, "margin": check.worst, "gap": gap}
        settled = False
        # a later point has the margin asked for, in its own scaling; an open gap marks one that the solver gave up on
        if check.holds and (best is None or gap < max(1e-6, best.gap)):
            settled = best is not None and abs(check.objective - best.objective) <= 1e-6 * abs(best.objective)
            best = Solved(program.values(x), check.objective, check, gap, ())
        if best is not None and (settled or not program.cost.any()):
            break
        scale = scaling.from_point(program, x)
    return None if best is None else Solved(best.values, best.objective, best.check, best.gap, tuple(attempts))


def _limit(margins: tuple[float, ...], bounds: list[float]) -> float:
    """Follow a bound, which is linear in a small margin, to margin zero."""
    (m1, m2), (b1, b2) = margins[-2:], bounds[-2:]
    return b2 - m2 * (b1 - b2) / (m1 - m2) if np.isfinite([b1, b2]).all() else np.nan


def infimum(
    program: Program, margins: tuple[float, ...] = (1e-7, 1e-8, 1e-9), near: Values | None = None
) -> Infimum | Infeasible | Failed:
    """Enclose the infimum of a program between a strict point and strict multipliers.

    Parameters
    ----------
    program : Program
    margins : tuple of float, optional
        Margins tried, from wide to narrow, for the points and for the multipliers; what fails its check is not used.
    near : mapping, optional
        As in `solve`.
    """
    solved = solve(program, near)
    if not isinstance(solved, Solved):
        return solved
    attempts = list(solved.attempts)
    scale = scaling.from_point(program, program.coordinates(solved.values))
    flat = backends.run(scaling.apply(program, scale), program.constraints, 0.0)
    attempts.append({**flat.record, "aim": "infimum", "objective": flat.primal * scale.cost})
    if flat.x is None:
        return Failed(program.label, tuple(attempts))
    uppers, best = _uppers(program, scale, margins, solved, attempts)
    lowers, proof = [-np.inf] * len(margins), {}
    sharp, balanced = _sharpened(program, scale, flat, attempts)
    for dual_scale in (scale, balanced):
        found, multipliers = _lowers(program, dual_scale, margins, attempts)
        if max(found) > max(lowers):
            lowers, proof = found, multipliers
        if best.objective - max(lowers) < 1e-7 * abs(best.objective):
            break
    lower = max(lowers)
    ends = [_limit(margins, side) for side in (lowers, uppers)]
    value = float(np.mean([end for end in ends if np.isfinite(end)] or [best.objective]))
    if not lower <= value <= best.objective:
        value = (lower + best.objective) / 2 if np.isfinite(lower) else best.objective
    best = Solved(best.values, best.objective, best.check, best.gap, tuple(attempts))
    return Infimum(value, lower, best.objective, program.values(sharp), best, proof, tuple(attempts))


def _sharpened(program: Program, scale: scaling.Scaling, flat: backends.Raw, attempts: list) -> tuple:
    """Point at the infimum from balanced scalings, which resolve directions of little weight; smallest gap wins."""
    x, gap = flat.x * scale.unknowns, abs(flat.primal - flat.dual)
    balanced = scale = scaling.balanced(program, scale, x, flat.multipliers)
    for _ in range(2):
        raw = backends.run(scaling.apply(program, scale), program.constraints, 0.0)
        attempts.append({**raw.record, "aim": "infimum, balanced", "objective": raw.primal * scale.cost})
        if raw.x is None or not abs(raw.primal - raw.dual) < max(2 * gap, 1e-10 * abs(raw.primal)):
            break
        x, gap = raw.x * scale.unknowns, abs(raw.primal - raw.dual)
        scale = scaling.balanced(program, scale, x, raw.multipliers)
    return x, balanced


def _uppers(program: Program, scale: scaling.Scaling, margins: tuple, best: Solved, attempts: list) -> tuple:
    scaled, uppers = scaling.apply(program, scale), []
    for margin in margins:
        raw = backends.run(scaled, program.constraints, margin)
        record = {**raw.record, "aim": "upper", "asked": margin}
        uppers.append(np.nan)
        if raw.x is not None:
            values = program.values(raw.x * scale.unknowns)
            check = program.check(values)
            record |= {"objective": check.objective, "margin": check.worst}
            if check.holds:
                uppers[-1] = check.objective
                if check.objective < best.objective:
                    best = Solved(values, check.objective, check, abs(raw.primal - raw.dual), ())
        attempts.append(record)
    return uppers, best


def _lowers(program: Program, scale: scaling.Scaling, margins: tuple, attempts: list) -> tuple[list[float], dict]:
    lowers, proof = [], {}
    for margin in margins:
        multipliers, raw = duality.pushed_inside(program, scale, margin)
        bound, corrected = -np.inf, {}
        if multipliers is not None:
            bound, corrected = duality.lower_bound(program, scale, multipliers)
        if bound > max(lowers, default=-np.inf):
            proof = corrected
        lowers.append(bound)
        attempts.append({**raw.record, "aim": "lower", "asked": margin, "objective": bound})
    return lowers, proof
