"""A program decided by its largest common margin: points and multipliers with room to be rounded."""

import numpy as np

from gainsay.lmi import duality, scaling
from gainsay.lmi.affine import Definite, Entrywise, Equal, Variable, scalar
from gainsay.lmi.outcomes import Farkas, Infeasible, Outcome, Solved, Undecided
from gainsay.lmi.program import Program
from gainsay.lmi.solving import solve

__all__ = ["MARGIN", "by_margin", "raised"]

#: name of the margin among the unknowns, and of its cap among the constraints
MARGIN = "common margin"
_REASON = "the largest common margin is below zero"


def by_margin(program: Program, room: float = 1e-7) -> Outcome:
    """Decide whether a program has a point by the largest t, at most one, with F_j >= t I for every inequality.

    Unlike those of `solve`, a point lies as far inside as can be in the program's own units, and multipliers keep
    room inside their cones, in all rows: both survive being rounded to short decimals.

    Parameters
    ----------
    program : Program
        Its objective is not looked at.
    room : float
        Least relative eigenvalue asked of multipliers.

    Returns
    -------
    Solved or Infeasible or Undecided
    """
    margin_program = raised(program)
    outcome = solve(margin_program, rounds=2)  # its sign and a scaling are wanted, not its digits
    if not isinstance(outcome, Solved):
        return Undecided(program.label, outcome.attempts, "no largest common margin")
    if outcome.objective < 0:
        values = {name: value for name, value in outcome.values.items() if name != MARGIN}
        check = program.check(values)
        return Solved(values, check.objective, check, outcome.gap, outcome.attempts)
    scale = scaling.from_point(margin_program, margin_program.coordinates(outcome.values))
    multipliers, raw = duality.pushed_inside(margin_program, scale, room)
    attempts = (*outcome.attempts, {**raw.record, "aim": "multipliers with room", "asked": room})
    if multipliers is None or not all(np.isfinite(m).all() for m in multipliers):
        return Undecided(program.label, attempts)
    bound, proved = duality.lower_bound(margin_program, scale, multipliers)
    if not bound > 0:
        return Undecided(program.label, attempts)
    refuting = {label: z for label, z in proved.items() if label != MARGIN}
    return Infeasible(Farkas(refuting, -bound, 0.0, _REASON), attempts)


def raised(program: Program) -> Program:
    """All inequalities raised by one margin of at most 1, which is maximised: the unknown and its cap bear one name.

    It has a point wherever the equations have one.
    """
    t = scalar(MARGIN)
    cap = (1 - t > 0).named(MARGIN)
    return Program(-t, [*(_raised(c, t) for c in program.constraints), cap], label=program.label)


def _raised(constraint: Definite | Entrywise | Equal, t: Variable) -> Definite | Entrywise | Equal:
    if isinstance(constraint, Equal):
        return constraint
    if isinstance(constraint, Entrywise):
        return Entrywise(constraint.label, constraint.expression - t * np.ones(constraint.expression.shape))
    size = constraint.expression.shape[0]
    return (constraint.expression - t * np.eye(size) > 0).named(constraint.label)
