"""A program seen from a point: with little room there, its constants are small and scale to size one."""

from dataclasses import replace

import numpy as np

from gainsay.lmi import duality, scaling
from gainsay.lmi.affine import Affine, Definite, Entrywise, Equal
from gainsay.lmi.outcomes import Solved
from gainsay.lmi.points import proved_point
from gainsay.lmi.program import Program
from gainsay.lmi.rounding import residual

# coefficients of a block that is summed without cancellation
_MOST = 200_000
# times that a program is looked at from nearer
_CLOSER = 3


def seen_from(program: Program, x: np.ndarray) -> Program | None:
    """The same constraints in the coordinates' distance from x; None where that is too much work.

    Each constant is the block at x, rounded once: what a solver loses beside large constants is then in its reach. The
    program is a hint for points, since its constants are rounded.
    """
    if not np.isfinite(x).all() or any(row.tensor.size > _MOST for row in program.rows):
        return None
    constraints: list = []
    for row in program.rows:
        flat = residual(row.tensor.reshape(-1, program.size), row.constant.ravel(), x)
        if not np.isfinite(flat).all():
            return None
        label = row.constraint.label
        if isinstance(row.constraint, Definite):
            terms = {v: row.tensor[:, :, place] for v, place in program.places.items()}
            moved = Affine(flat.reshape(row.constant.shape), terms)
            constraints.append(Definite(label, moved, row.constraint.strict, row.constraint.rows))
        else:
            terms = {v: row.tensor[:, None, place] for v, place in program.places.items()}
            kind = Equal if isinstance(row.constraint, Equal) else Entrywise
            constraints.append(kind(label, Affine(flat[:, None], terms)))
    return replace(program, minimise=None, subject_to=constraints, scale=type(program.scale)())


def closer(program: Program, scale: scaling.Scaling, x: np.ndarray, attempts: list) -> Solved | None:
    """A proved point of a program with little room, seen from near its points: that room is then of size one."""
    for number in range(_CLOSER + 1):
        point = proved_point(program, scale, x, float("nan"))
        if point is not None:
            return replace(point, attempts=tuple(attempts))
        moved = None if number == _CLOSER else seen_from(program, x)
        if moved is None:
            return None
        own = scaling.first(moved)
        level = duality.level(scaling.apply(moved, own), moved.constraints)
        attempts.append({**level.record, "aim": "level, from nearby", "level": level.value})
        if level.x is None:
            return None
        with np.errstate(over="ignore"):
            x = x + level.x * own.unknowns
    return None
