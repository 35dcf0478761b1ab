"""Solve a program and believe nothing: a typed result from what is proved, never from a status."""

from dataclasses import replace

import numpy as np

from gainsay.errors import InputError
from gainsay.lmi import backends, duality, facial, instability, points, scaling
from gainsay.lmi.affine import Equal, Values
from gainsay.lmi.constant import without_solver
from gainsay.lmi.exposing import exact_faces
from gainsay.lmi.homogeneous import homogeneous_part
from gainsay.lmi.kernels import on_kernels
from gainsay.lmi.nearby import closer
from gainsay.lmi.outcomes import Farkas, Infeasible, Outcome, Solved, Unbounded, Undecided
from gainsay.lmi.points import proved_point
from gainsay.lmi.program import Program
from gainsay.lmi.rays import ray

# least margin of phase one that counts as the presence of strict points
_PRESENT = 1e-9
# reductions to a face before a program is left undecided
MOST_FACES = 6
# coefficients from which a run of the solver takes longer than any proof: the first point proved is taken
_LARGE = 200_000
# least relative eigenvalues kept of multipliers that the solver gives with an infeasible program
_CUTS = (0.0, 1e-8, 1e-6, 1e-5, 1e-4, 1e-3)
_WEAKLY = "weakly infeasible: no point exists, by exact multipliers in turn, and no others were found"


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
    if not isinstance(rounds, int) or rounds < 1:
        raise InputError("solve", field="rounds", value=rounds, expected="at least 1")
    return decide(program, near, rounds, MOST_FACES)[0]


def decide(
    program: Program, near: Values | None, rounds: int, faces: int, settle: bool = True
) -> tuple[Outcome, Program]:
    """Outcome, and the program of the same points on which it was found.

    Parameters
    ----------
    program : Program
    near : mapping or None
        As in `solve`.
    rounds : int
        As in `solve`.
    faces : int
        Most reductions to a face.
    settle : bool, optional
        Whether to scale anew until the objective settles, or to take the first point proved.
    """
    if not isinstance(program, Program):
        raise InputError("solve", value=type(program).__name__, expected="a Program")
    decided = without_solver(program)
    if decided is not None:
        return decided, program
    attempts: list[dict] = []
    first = scaling.beginning(program, near)
    inside = None
    settle = settle and sum(row.tensor.size for row in program.rows) < _LARGE
    for setting in backends.SETTINGS:
        best = runs(program, first, setting, rounds, attempts, settle)
        if best is not None:
            return _beyond_rounding(program, best), program
        if setting != "clarabel":
            continue
        proof = _contradiction(program) or instability.refutation(program)
        if proof is not None:
            return Infeasible(proof, tuple(attempts)), program
        if "DualInfeasible" in attempts[-1]["status"]:
            endless = _endless(program, first, attempts)
            if endless is not None:
                return endless, program
        level = _level(program, first, "level", attempts)
        if level.x is None or not level.value > _PRESENT:
            proof = _refutation(program, first, level, attempts)
            if proof is not None:
                return Infeasible(proof, tuple(attempts)), program
            point = None if level.x is None else closer(program, first, level.x * first.unknowns, attempts)
            if point is not None:
                return _beyond_rounding(program, point), program
            on_face = _on_face(program, first, level, rounds, faces, attempts)
            if on_face is not None:
                return on_face
            proof = _on_kernels(program, attempts)
            if proof is not None:
                return Infeasible(proof, tuple(attempts)), program
            rounds = 1
        else:
            inside = level.x * first.unknowns
            first = scaling.from_point(program, inside)
    # with less room than the margin asked for
    point = None if inside is None else closer(program, first, inside, attempts)
    return (point, program) if point is not None else (Undecided(program.label, tuple(attempts)), program)


def _beyond_rounding(program: Program, outcome: Solved | Infeasible) -> Solved | Infeasible:
    """The outcome; a point that holds by less than rounding is none of an unstable matrix whose sums were rounded."""
    proof = instability.refutation(program) if isinstance(outcome, Solved) and not outcome.check.holds else None
    return outcome if proof is None else Infeasible(proof, outcome.attempts)


def _refutation(program: Program, scale: scaling.Scaling, level: duality.Level, attempts: list) -> Farkas | None:
    """Proof that a program has no point, of the whole or of its homogeneous part."""
    proof = duality.refutation(program, scale, level, attempts)
    part = homogeneous_part(program) if proof is None else None
    if part is None:
        return proof
    own = scaling.first(part.program)
    level = _level(part.program, own, "level, homogeneous part", attempts)
    if level.value > _PRESENT:
        return None
    proof = duality.refutation(part.program, own, level, attempts) or instability.refutation(part.program)
    return None if proof is None else part.lifted(proof)


def _level(program: Program, scale: scaling.Scaling, aim: str, attempts: list) -> duality.Level:
    level = duality.level(scaling.apply(program, scale), program.constraints)
    attempts.append({**level.record, "aim": aim, "level": level.value})
    return level


def _on_kernels(program: Program, attempts: list) -> Farkas | None:
    """Refute what a program says on the kernels of its semidefinite coefficients, on all of them if it can be.

    What is said on more kernels is less, and easier to refute while it is false: halving finds where it is both.
    """
    seen = on_kernels(program)
    fewest, most = 0, len(seen) - 1
    number = most
    while fewest <= number <= most:
        smaller = seen[number].program
        decided = without_solver(smaller)
        proof, present = decided.farkas if isinstance(decided, Infeasible) else None, isinstance(decided, Solved)
        if decided is None:
            proof = instability.refutation(smaller)
        if decided is None and proof is None:
            scale = scaling.first(smaller)
            best = _level(smaller, scale, "level, on kernels", attempts)
            present = best.value > _PRESENT
            proof = None if present else _refutation(smaller, scale, best, attempts)
        if proof is not None:
            for step in reversed(seen[: number + 1]):
                proof = step.lifted(proof)
            return proof
        fewest, most = (fewest, number - 1) if present else (number + 1, most)
        number = (fewest + most) // 2
    return None


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
    program: Program, scale: scaling.Scaling, level: duality.Level, rounds: int, faces: int, attempts: list
) -> tuple[Outcome, Program] | None:
    """Refute by rational multipliers, or go on with the program on the face that they expose."""
    if not level.multipliers or faces == 0:
        return None
    coordinates = scaling.exact(program, scale)
    if coordinates is None:
        return None
    exact, scaled = coordinates
    multipliers = scale.multipliers_in(exact, level.multipliers)
    for target in (0, None):
        for face in exact_faces(scaled, program.constraints, multipliers, target):
            confining = facial.told(program, exact, face)
            if facial.refutes(program, face):
                return Infeasible(confining, tuple(attempts)), program
            smaller = facial.reduced(program, exact, face)
            if smaller is None:
                continue
            outcome, last = decide(smaller, None, rounds, faces - 1)
            tried = (*attempts, *outcome.attempts)
            if isinstance(outcome, Undecided):
                chain = (confining, *outcome.faces) if outcome.faces else ()
                return Undecided(program.label, tried, outcome.reason, chain), program
            if isinstance(outcome, Infeasible):
                return Undecided(program.label, tried, _WEAKLY, (confining, outcome.farkas)), program
            return filled(program, replace(outcome, attempts=tried)), last
    return None


def filled(program: Program, outcome: Outcome) -> Outcome:
    """The outcome on a face told of the whole program: unknowns that the face leaves out are zero."""
    point = outcome.solved if isinstance(outcome, Unbounded) else outcome
    assert isinstance(point, Solved)
    rest = {v.name: v.matrix(np.zeros(v.size)) for v in program.variables}
    values = {**rest, **{name: value for name, value in point.values.items() if name in rest}}
    full = replace(point, values=values, check=program.check(values))
    if isinstance(outcome, Unbounded):
        return replace(outcome, solved=full, ray={**rest, **outcome.ray})
    return full


def filled_point(program: Program, point: Solved) -> Solved:
    """A point on a face as one of the whole program."""
    full = filled(program, point)
    assert isinstance(full, Solved)
    return full


def runs(
    program: Program,
    scale: scaling.Scaling,
    setting: str,
    rounds: int,
    attempts: list,
    settle: bool,
    refute: bool = True,
) -> Solved | Infeasible | None:
    """The best point proved of some runs, each scaled from the one before, or a refutation by a run's multipliers.

    Parameters
    ----------
    program : Program
    scale : Scaling
        Of the first run.
    setting : str
        Of the solver.
    rounds : int
        Most runs.
    attempts : list
        Filled with a record of each.
    settle : bool
        Whether to go on from a point until the objective settles.
    refute : bool, optional
        Whether to prove the multipliers of a run that says that there is no point.
    """
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
        if best is not None and (settled or not settle or not program.cost.any()):
            break
        if "DualInfeasible" in record["status"] or not np.isfinite(x).all():
            break
        if refute and best is None and "PrimalInfeasible" in record["status"]:
            proof = duality.refuted_by(program, scale, raw.multipliers, _CUTS)
            if proof is not None:
                return Infeasible(proof, tuple(attempts))
        refusals = refusals + 1 if record["status"] == "PrimalInfeasible" else 0
        if refusals == 2:
            break
        scale = scaling.from_point(program, x)
    return None if best is None else replace(best, attempts=tuple(attempts))


def _endless(program: Program, scale: scaling.Scaling, attempts: list) -> Outcome | None:
    """A proved point with a proved ray along which the objective falls."""
    free = replace(program, minimise=None)
    inside = decide(free, None, 2, 0)[0]
    attempts += inside.attempts
    if isinstance(inside, Infeasible):
        return Infeasible(inside.farkas, tuple(attempts))
    if not isinstance(inside, Solved):
        return None
    inside = filled_point(program, inside)
    direction = ray(program, scale, attempts)
    if direction is None:
        return None
    objective = float(program.objective.value(inside.values)[0, 0])
    return Unbounded(direction, replace(inside, objective=objective), tuple(attempts))


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
    first = scaling.beginning(program, near)
    outcome = runs(program, first, "clarabel", 4, [], settle=True, refute=False)
    return outcome if isinstance(outcome, Solved) else None
