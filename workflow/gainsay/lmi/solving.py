"""Solve a program and believe nothing: a typed result from what is proved, never from a status."""

from dataclasses import replace

import numpy as np

from gainsay.errors import InputError
from gainsay.lmi import backends, duality, facial, instability, large, points, scaling
from gainsay.lmi.affine import Equal, Values
from gainsay.lmi.constant import without_solver
from gainsay.lmi.homogeneous import homogeneous_part
from gainsay.lmi.kernels import on_kernel
from gainsay.lmi.nearby import closer
from gainsay.lmi.outcomes import Farkas, Infeasible, Infimum, Outcome, Solved, Unbounded, Undecided
from gainsay.lmi.points import proved_point
from gainsay.lmi.program import Program
from gainsay.lmi.rays import ray

# least margin of phase one that counts as the presence of strict points
_PRESENT = 1e-9
# reductions to a face before a program is left undecided
_MOST_FACES = 6


def solve(program: Program, near: Values | None = None, rounds: int = 4) -> Outcome:
    """Solve a program.

    The first scaling comes from typical sizes and coefficients; each round rescales from the point found, until the
    objective settles. Only what is proved counts, for points and for refutations.

    Parameters
    ----------
    program : Program
    near : mapping, optional
        Values of all unknowns of about the sizes expected, such as the solution of a neighbouring program.
    rounds : int, optional
        Scalings tried with each setting of the solver, at least one.

    Returns
    -------
    Solved or Infeasible or Unbounded or Undecided

    Raises
    ------
    InputError
        If there are no rounds, or `near` lacks an unknown.
    """
    if rounds < 1:
        raise InputError("solve", field="rounds", value=rounds, expected="at least 1")
    return _solve(program, near, rounds, _MOST_FACES)[0]


def _solve(program: Program, near: Values | None, rounds: int, faces: int) -> tuple[Outcome, Program]:
    """Outcome, and the program of the same points on which it was found."""
    decided = without_solver(program)
    if decided is not None:
        return decided, program
    attempts: list[dict] = []
    first = scaling.first(program) if near is None else scaling.from_point(program, program.coordinates(near))
    inside = None
    if large.is_large(program):
        answer = large.answer(program, first, attempts)
        if answer is not None:
            return answer, program
    for setting in backends.SETTINGS:
        best = _rounds(program, first, setting, rounds, attempts)
        if best is not None:
            return best, program
        if setting != "clarabel":
            continue
        proof = _contradiction(program) or instability.refutation(program)
        if proof is not None:
            return Infeasible(proof, tuple(attempts)), program
        if "DualInfeasible" in attempts[-1]["status"]:
            endless = _endless(program, first, attempts)
            if endless is not None:
                return endless, program
        found = duality.level(scaling.apply(program, first), program.constraints)
        attempts.append({**found.record, "aim": "level", "level": found.value})
        if found.x is None or not found.value > _PRESENT:
            proof = _refutation(program, first, found, attempts)
            if proof is not None:
                return Infeasible(proof, tuple(attempts)), program
            point = None if found.x is None else closer(program, first, found.x * first.unknowns, attempts)
            if point is not None:
                return point, program
            on_face = _on_face(program, first, found, rounds, faces, attempts)
            if on_face is not None:
                return on_face
            smaller = on_kernel(program)
            if smaller is not None:
                outcome = _solve(smaller.program, None, 2, 0)[0]
                attempts += outcome.attempts
                if isinstance(outcome, Infeasible):
                    return Infeasible(smaller.lifted(outcome.farkas), tuple(attempts)), program
        else:
            inside = found.x * first.unknowns
            first = scaling.from_point(program, inside)
    # with less room than the margin asked for
    point = None if inside is None else closer(program, first, inside, attempts)
    return (point, program) if point is not None else (Undecided(program.label, tuple(attempts)), program)


def _refutation(program: Program, scale: scaling.Scaling, found: duality.Level, attempts: list) -> Farkas | None:
    """Proof that a program has no point, of the whole or of its homogeneous part."""
    proof = duality.refutation(program, scale, found, attempts)
    part = homogeneous_part(program) if proof is None else None
    if part is None:
        return proof
    own = scaling.first(part.program)
    found = duality.level(scaling.apply(part.program, own), part.program.constraints)
    attempts.append({**found.record, "aim": "level, homogeneous part", "level": found.value})
    if found.value > _PRESENT:
        return None
    proof = duality.refutation(part.program, own, found, attempts) or instability.refutation(part.program)
    return None if proof is None else part.lifted(proof)


def _contradiction(program: Program) -> Farkas | None:
    """Proof by equalities that contradict each other, without the inequalities."""
    equalities = [row for row in program.rows if isinstance(row.constraint, Equal)]
    if not equalities:
        return None
    rows, right = np.vstack([row.tensor for row in equalities]), np.concatenate([row.constant for row in equalities])
    weights = points.contradiction(rows, right)
    if weights is None:
        return None
    multipliers, place = {}, 0
    for row in program.rows:
        label, shape = row.constraint.label, (row.size, row.size) if row.is_matrix else (row.size,)
        multipliers[label] = np.zeros(shape)
        if isinstance(row.constraint, Equal):
            multipliers[label] = weights[place : place + row.size]
            place += row.size
    return Farkas(multipliers, -1.0, 0.0, "equalities that contradict each other")


def _on_face(
    program: Program, scale: scaling.Scaling, found: duality.Level, rounds: int, faces: int, attempts: list
) -> tuple[Outcome, Program] | None:
    """Refute by rational multipliers, or go on with the program on the face that they expose."""
    if not found.multipliers or faces == 0:
        return None
    coordinates = scaling.exact(program, scale)
    if coordinates is None:
        return None
    exact, scaled = coordinates
    multipliers = scale.multipliers_in(exact, found.multipliers)
    for target in (0, None) if abs(found.value) < 1e-5 else (None,):
        face = facial.exact_face(scaled, program.constraints, multipliers, target)
        if face is None:
            continue
        proof = facial.refuted(program, exact, face)
        if proof is not None:
            return Infeasible(proof, tuple(attempts)), program
        smaller = facial.reduced(program, exact, face)
        if smaller is None:
            continue
        outcome, last = _solve(smaller, None, rounds, faces - 1)
        tried = (*attempts, *outcome.attempts)
        if isinstance(outcome, Infeasible | Undecided):
            reason = "weakly infeasible" if isinstance(outcome, Infeasible) else outcome.reason
            return Undecided(program.label, tried, reason), program
        return _filled(program, replace(outcome, attempts=tried)), last
    return None


def _filled(program: Program, outcome: Outcome) -> Outcome:
    """The outcome on a face told of the whole program: unknowns that the face leaves out are zero."""
    point = outcome.solved if isinstance(outcome, Unbounded) else outcome
    assert isinstance(point, Solved)
    rest = {v.name: v.matrix(np.zeros(v.size)) for v in program.variables}
    values = {**rest, **{name: value for name, value in point.values.items() if name in rest}}
    told = replace(point, values=values, check=program.check(values))
    if isinstance(outcome, Unbounded):
        return replace(outcome, solved=told, ray={**rest, **outcome.ray})
    return told


def _rounds(program: Program, scale: scaling.Scaling, setting: str, rounds: int, attempts: list) -> Solved | None:
    best: Solved | None = None
    refusals = 0
    for number in range(rounds):
        scaled = scaling.apply(program, scale)
        raw = backends.run(scaled, program.constraints, program.margin, setting)
        record = {**raw.record, "scaling": number}
        attempts.append(record)
        if raw.x is None:
            break
        with np.errstate(over="ignore"):  # of a point that runs away; what is not finite is not proved
            x = raw.x * scale.unknowns
        gap = abs(raw.primal - raw.dual) / max(abs(raw.primal), 1e-12)
        solved = proved_point(program, scale, x, gap)
        record["gap"] = gap
        settled = False
        # a later point has the margin asked for, in its own scaling; an open gap marks one that the solver gave up on
        if solved is not None and "DualInfeasible" not in record["status"]:
            record |= {"objective": solved.objective, "margin": solved.check.worst}
            if best is None or gap < max(1e-6, best.gap):
                settled = best is not None and abs(solved.objective - best.objective) <= 1e-6 * abs(best.objective)
                best = solved
        if best is not None and (settled or not program.cost.any()):
            break
        if "DualInfeasible" in record["status"] or not np.isfinite(x).all():
            break
        refusals = refusals + 1 if record["status"] == "PrimalInfeasible" else 0
        if refusals == 2:
            break
        scale = scaling.from_point(program, x)
    return None if best is None else replace(best, attempts=tuple(attempts))


def _endless(program: Program, scale: scaling.Scaling, attempts: list) -> Outcome | None:
    """A proved point with a proved ray along which the objective falls."""
    free = replace(program, minimise=None)
    inside = _solve(free, None, 2, 0)[0]
    attempts += inside.attempts
    if isinstance(inside, Infeasible):
        return Infeasible(inside.farkas, tuple(attempts))
    if not isinstance(inside, Solved):
        return None
    inside = _told(program, inside)
    direction = ray(program, scale, attempts)
    if direction is None:
        return None
    objective = float(program.objective.value(inside.values)[0, 0])
    return Unbounded(direction, replace(inside, objective=objective), tuple(attempts))


def infimum(
    program: Program, margins: tuple[float, ...] | None = None, near: Values | None = None
) -> Infimum | Infeasible | Unbounded | Undecided:
    """Enclose the infimum of a program between a proved point and proved multipliers.

    Parameters
    ----------
    program : Program
    margins : tuple of float, optional
        Margins tried, from narrow to wide, for the point and for the multipliers, until one passes its check.
        Ask for one where a point or multipliers are to be rounded: a large program has none of its own accord.
    near : mapping, optional
        As in `solve`.

    Raises
    ------
    InputError
        If no margin is given.
    """
    if margins == ():
        raise InputError("infimum", field="margins", value=margins, expected="at least one")
    solved, last = _solve(program, near, 4, _MOST_FACES)
    if not isinstance(solved, Solved):
        return solved
    if last is not program:
        found = _enclosed(last, solved, margins)
        if not isinstance(found, Infimum):
            return found
        # multipliers of the program on a face are none of the program
        return replace(found, solved=_told(program, found.solved), multipliers={})
    return _enclosed(program, solved, margins)


def find_point(program: Program, near: Values | None = None) -> Solved | None:
    """A proved point of a program where the solver gives one at once, and no proof where it does not.

    For a search over many programs whose ends alone are decided by `solve`: there, what refutes a program costs a
    hundred times what finds a point of it.

    Parameters
    ----------
    program : Program
    near : mapping, optional
        As in `solve`.

    Returns
    -------
    Solved or None
        None says nothing of the program.
    """
    decided = without_solver(program)
    if decided is not None:
        return decided if isinstance(decided, Solved) else None
    first = scaling.first(program) if near is None else scaling.from_point(program, program.coordinates(near))
    return _rounds(program, first, "clarabel", 4, [])


def _told(program: Program, point: Solved) -> Solved:
    told = _filled(program, point)
    assert isinstance(told, Solved)
    return told


def _enclosed(program: Program, solved: Solved, asked: tuple[float, ...] | None) -> Infimum | Undecided:
    attempts = list(solved.attempts)
    if not program.cost.any() or not program.constraints:
        value = float(program.objective.constant[0, 0])
        return Infimum(value, value, value, solved.values, replace(solved, objective=value), {}, tuple(attempts))
    scale = scaling.from_point(program, program.coordinates(solved.values))
    flat = backends.run(scaling.apply(program, scale), program.constraints, 0.0)
    attempts.append({**flat.record, "aim": "infimum", "objective": flat.primal * scale.cost})
    if flat.x is None:
        return Undecided(program.label, tuple(attempts), "a point, and no optimum")
    margins = _MARGINS if asked is None else asked
    if asked is None and large.is_large(program):
        found = large.enclosed(program, scale, solved, flat, attempts)
        if found is not None:
            return found
    best = _upper(program, scale, margins, solved, attempts)
    lower, proof = -np.inf, {}
    sharp, balanced = _sharpened(program, scale, flat, attempts)
    for dual_scale in (scale, balanced):
        bound, multipliers = _lower(program, dual_scale, margins, attempts)
        if bound > lower:
            lower, proof = bound, multipliers
        if best.objective - lower < 1e-7 * abs(best.objective):
            break
    if not best.objective - lower < 1e-6 * max(abs(best.objective), scale.cost):
        bound, multipliers = duality.lower_bound(program, scale, flat.multipliers, _CUTS)
        if bound > lower:
            lower, proof = bound, multipliers
    upper, values = best.objective, program.values(sharp)
    value = float(program.objective.value(values)[0, 0])
    if not lower <= value <= upper:
        value = (lower + upper) / 2
    size = max(abs(lower), abs(upper), scale.cost)
    if not (np.isfinite(lower) and upper - lower <= _WIDEST * size):
        value = float("nan")
    best = replace(best, attempts=tuple(attempts))
    return Infimum(value, lower, upper, values, best, proof, tuple(attempts))


_MARGINS = (1e-9, 1e-8, 1e-7)
# least relative eigenvalues kept of multipliers at an optimum that has no interior ones
_CUTS = (1e-6, 1e-4, 1e-8)
# widest enclosure, relative to the size of the objective, within which a value is given
_WIDEST = 0.1


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
