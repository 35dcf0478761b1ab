"""Candidates for a proof, at the price of a few runs of a solver: a point, or multipliers that may refute.

Nothing is proved here. Where thousands of programs are to be decided and a checker decides over each anyway, the proofs
that `solve` and `infimum` make for themselves would be made twice.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from gainsay.errors import InputError
from gainsay.lmi import duality, scaling
from gainsay.lmi.affine import Definite
from gainsay.lmi.common_margin import MARGIN, raised
from gainsay.lmi.outcomes import Solved
from gainsay.lmi.program import Program
from gainsay.lmi.solving import solve

__all__ = ["Candidate", "candidates"]

# least eigenvalues asked of multipliers, tried in turn: enough to survive rounding, little enough to refute still
_PUSHES = (1e-7, 1e-6, 1e-5, 1e-4)


@dataclass(frozen=True)
class Candidate:
    """What may decide a program.

    Attributes
    ----------
    level : float
        Largest level that all matrix inequalities reach together, as far as the solver says; positive: a point.
    values : mapping of str to ndarray or float
        A point by name of the unknowns; empty where multipliers are meant.
    multipliers : mapping of str to ndarray
        Multipliers by label of the constraints; empty where a point is meant.
    """

    level: float
    values: Mapping[str, object]
    multipliers: Mapping[str, np.ndarray]


def candidates(program: Program) -> Iterator[Candidate]:
    """Yield what may decide whether a program of matrix inequalities has a point, the likeliest first.

    Parameters
    ----------
    program : Program
        Of matrix inequalities alone; its objective is not looked at.

    Raises
    ------
    InputError
        If a constraint is an equation or entrywise.
    """
    for constraint in program.constraints:
        if not isinstance(constraint, Definite):
            raise InputError("candidates", field=program.label, value=constraint.label, expected="matrix inequalities")
    margin_program = raised(program)
    outcome = solve(margin_program)
    if not isinstance(outcome, Solved):
        return
    level = -outcome.objective
    if level > 0:
        yield Candidate(level, {name: value for name, value in outcome.values.items() if name != MARGIN}, {})
        return
    scale = scaling.from_point(margin_program, margin_program.coordinates(outcome.values))
    for push in _PUSHES:
        multipliers, _ = duality.pushed_inside(margin_program, scale, push)
        if multipliers is not None and all(np.isfinite(m).all() for m in multipliers):
            parts = duality.unscaled(margin_program.constraints, scale, multipliers)
            yield Candidate(level, {}, {name: value for name, value in parts.items() if name != MARGIN})
