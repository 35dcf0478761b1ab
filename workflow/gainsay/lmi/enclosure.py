"""Infima enclosed between a proved point and proved multipliers."""

from dataclasses import replace

import numpy as np

from gainsay.errors import InputError
from gainsay.exact.floats import real_number
from gainsay.lmi import backends, centring, duality, facial, scaling
from gainsay.lmi.affine import Values
from gainsay.lmi.exposing import exact_faces
from gainsay.lmi.outcomes import Infeasible, Infimum, Solved, Unbounded, Undecided
from gainsay.lmi.points import proved_point
from gainsay.lmi.program import Program
from gainsay.lmi.solving import MOST_FACES, decide, filled_point, runs

_MARGINS = (1e-9, 1e-8, 1e-7)
# parts of the way from the optimum to a point inside, tried in turn for a point near the optimum
_WAY = (1e-5, 1e-4, 1e-3, 1e-2)
# mu at which the central path has gone far enough, relative to the size of the objective
_LEAST = 1e-12
# least relative eigenvalues kept of multipliers at an optimum that has no interior ones
_CUTS = (1e-6, 1e-4, 1e-8)
# the same of the first multipliers at an optimum, whatever they are
_FIRST_CUTS = (0.0, 1e-8, 1e-6, 1e-5, 1e-4, 1e-3)
# width of an enclosure, relative to the size of the objective, that is narrow enough
_NARROW = 1e-7
# common margin, of scaled blocks, above which no points are looked for on a face
_ROOM = 1e-5
# widest enclosure, relative to the size of the objective, within which a value is given
_WIDEST = 0.1


def infimum(
    program: Program, margins: tuple[float, ...] | None = None, near: Values | None = None
) -> Infimum | Infeasible | Unbounded | Undecided:
    """Enclose the infimum of a program between a proved point and proved multipliers.

    Parameters
    ----------
    program : Program
    margins : tuple of float, optional
        Margins tried, from narrow to wide, for the point and for the multipliers, until one passes its check.
        Ask for one where a point or multipliers are to be rounded: of their own accord they may have none.
    near : mapping, optional
        As in `solve`.

    Raises
    ------
    InputError
        If there is no margin, or one that is not between 0 and 1.
    """
    if margins is not None and not (margins and all(0 < real_number(m, "margins") < 1 for m in margins)):
        raise InputError("infimum", field="margins", value=margins, expected="at least one, each between 0 and 1")
    solved, last = decide(program, near, 4, MOST_FACES, settle=margins is not None)
    if not isinstance(solved, Solved):
        return solved
    on_face = _enclosed(last, solved, margins)
    if margins is None and isinstance(on_face, Infimum) and np.isnan(on_face.value):
        on_face = _enclosed_on_face(last, on_face)
    return on_face if last is program or not isinstance(on_face, Infimum) else _of_whole(program, on_face)


def _of_whole(program: Program, found: Infimum) -> Infimum:
    """An enclosure on a face as one of the whole program, of which multipliers on the face are none."""
    return replace(found, solved=filled_point(program, found.solved), multipliers={})


def _enclosed_on_face(program: Program, found: Infimum) -> Infimum:
    """The enclosure on a face that holds all points, where there is one: no multipliers of the whole close the gap."""
    scale = scaling.first(program)
    level = duality.level(scaling.apply(program, scale), program.constraints)
    coordinates = scaling.exact(program, scale)
    if coordinates is None or not level.multipliers or level.value > _ROOM:
        return found
    exact, scaled = coordinates
    for face in exact_faces(scaled, program.constraints, scale.multipliers_in(exact, level.multipliers), 0):
        smaller = facial.reduced(program, exact, face)
        inner = None if smaller is None else infimum(smaller)
        if isinstance(inner, Infimum) and np.isfinite(inner.value):
            tried = (*found.attempts, {**level.record, "aim": "level", "level": level.value}, *inner.attempts)
            return replace(_of_whole(program, inner), attempts=tried)
    return found


def _enclosed(program: Program, solved: Solved, asked: tuple[float, ...] | None) -> Infimum | Undecided:
    attempts = list(solved.attempts)
    if not program.cost.any() or not program.constraints:
        value = float(program.objective.constant[0, 0])
        return Infimum(value, value, value, solved.values, replace(solved, objective=value), {}, tuple(attempts))
    scale = scaling.from_point(program, program.coordinates(solved.values))
    flat = backends.run(scaling.apply(program, scale), program.constraints, 0.0)
    attempts.append({**flat.record, "aim": "infimum", "objective": flat.primal * scale.cost})
    best, lower = solved, -np.inf
    proof: dict[str, np.ndarray] = {}
    if asked is None:
        best, lower, proof = _at_once(program, scale, solved, flat)
        if flat.x is not None and best.objective - lower < _NARROW * max(abs(best.objective), scale.cost):
            return _told(program, flat.x * scale.unknowns, best, lower, proof, scale.cost, attempts)
        settled = runs(program, scale, "clarabel", 3, attempts, settle=True)
        if isinstance(settled, Solved):
            best = min(best, settled, key=lambda point: point.objective)
            scale = scaling.from_point(program, program.coordinates(settled.values))
            flat = backends.run(scaling.apply(program, scale), program.constraints, 0.0)
            attempts.append({**flat.record, "aim": "infimum, settled", "objective": flat.primal * scale.cost})
    if flat.x is None:
        return Undecided(program.label, tuple(attempts), "a point, and no optimum")
    margins = asked or _MARGINS
    best = _upper(program, scale, margins, best, attempts)
    sharp, balanced = _sharpened(program, scale, flat, attempts)
    for dual_scale in (scale, balanced):
        bound, multipliers = _lower(program, dual_scale, margins, attempts)
        if bound > lower:
            lower, proof = bound, multipliers
        if best.objective - lower < 1e-7 * abs(best.objective):
            break
    # multipliers with a margin that was asked for are not given up for a sharper bound from the edge of the cones
    kept = asked is not None and np.isfinite(lower)
    if not kept and not best.objective - lower < 1e-6 * max(abs(best.objective), scale.cost):
        bound, multipliers = duality.lower_bound(program, scale, flat.multipliers, _CUTS)
        if bound > lower:
            lower, proof = bound, multipliers
    if asked is None and not best.objective - lower < 1e-6 * max(abs(best.objective), scale.cost):
        best, lower, proof = _along_the_path(program, scale, solved, best, lower, proof, attempts)
    if asked is None and not np.isfinite(lower):
        lower, proof = facial.exact_bound(program, scale, flat.multipliers)
        attempts.append({"solver": "rationals", "status": "bound" if proof else "none", "aim": "infimum"})
    return _told(program, sharp, best, lower, proof, scale.cost, attempts)


def _along_the_path(
    program: Program, scale: scaling.Scaling, inside: Solved, best: Solved, lower: float, proof: dict, attempts: list
) -> tuple[Solved, float, dict]:
    """The best of what is known and of what is proved on the central path, the furthest first."""
    scaled = scaling.apply(program, scale)
    if not centring.is_small(scaled):
        return best, lower, proof
    start = program.coordinates(inside.values) / scale.unknowns
    path = list(centring.central_path(scaled, program.constraints, start, _LEAST))
    attempts.append({"solver": "central path", "status": f"{len(path)} points", "aim": "infimum"})
    for _, x, _ in reversed(path):
        point = proved_point(program, scale, x * scale.unknowns, best.gap)
        if point is not None:
            best = min(best, point, key=lambda one: one.objective)
            break
    for _, _, multipliers in reversed(path):
        bound, dual = duality.lower_bound(program, scale, multipliers)
        if np.isfinite(bound):
            return (best, bound, dual) if bound > lower else (best, lower, proof)
    return best, lower, proof


def _told(
    program: Program, optimum: np.ndarray, best: Solved, lower: float, proof: dict, cost: float, attempts: list
) -> Infimum:
    """The enclosure, with the objective at the solver's optimum for a value where it lies inside."""
    upper, values = best.objective, program.values(optimum)
    value = float(program.objective.value(values)[0, 0])
    if not lower <= value <= upper:
        value = (lower + upper) / 2
    size = max(abs(lower), abs(upper), cost)
    if not (np.isfinite(lower) and upper - lower <= _WIDEST * size):
        value = float("nan")
    best = replace(best, attempts=tuple(attempts))
    return Infimum(value, lower, upper, values, best, proof, tuple(attempts))


def _at_once(
    program: Program, scale: scaling.Scaling, inside: Solved, flat: backends.Raw
) -> tuple[Solved, float, dict]:
    """A point near the solver's optimum `flat` on the way from a point inside, and a bound by its multipliers."""
    if flat.x is None or not all(np.isfinite(m).all() for m in flat.multipliers):
        return inside, -np.inf, {}
    lower, multipliers = duality.lower_bound(program, scale, flat.multipliers, _FIRST_CUTS)
    optimum, start = flat.x * scale.unknowns, program.coordinates(inside.values)
    for part in _WAY:
        point = proved_point(program, scale, optimum + part * (start - optimum), inside.gap)
        if point is not None and point.objective < inside.objective:
            return point, lower, multipliers
    return inside, lower, multipliers


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


def _upper(program: Program, scale: scaling.Scaling, margins: tuple, best: Solved, attempts: list) -> Solved:
    """A point as near to the infimum as a margin lets it be."""
    scaled = scaling.apply(program, scale)
    for margin in sorted(margins):
        raw = backends.run(scaled, program.constraints, margin)
        record = {**raw.record, "aim": "upper", "asked": margin}
        attempts.append(record)
        if raw.x is None:
            continue
        point = proved_point(program, scale, raw.x * scale.unknowns, abs(raw.primal - raw.dual))
        if point is not None:
            record |= {"objective": point.objective, "margin": point.check.worst}
            return point if point.objective < best.objective else best
    return best


def _lower(program: Program, scale: scaling.Scaling, margins: tuple, attempts: list) -> tuple[float, dict]:
    """A bound from multipliers as near to the optimum as a margin lets them be; minus infinity where none is proved."""
    for margin in sorted(margins):
        multipliers, raw = duality.pushed_inside(program, scale, margin)
        bound: float = -np.inf
        corrected: dict[str, np.ndarray] = {}
        if multipliers is not None and all(np.isfinite(m).all() for m in multipliers):
            bound, corrected = duality.lower_bound(program, scale, multipliers)
        attempts.append({**raw.record, "aim": "lower", "asked": margin, "objective": bound})
        if np.isfinite(bound):
            return bound, corrected
    return -np.inf, {}
