"""Rays: directions along which a program keeps holding while its objective falls, proved."""

from typing import Any

import numpy as np

from gainsay.lmi import backends, duality, points, scaling
from gainsay.lmi.affine import Affine, Definite, Entrywise, Equal
from gainsay.lmi.program import Program


def ray(program: Program, scale: scaling.Scaling, attempts: list) -> dict[str, Any] | None:
    """Direction d with every linear part >= 0 (= 0 for equalities) and an objective that falls, both proved."""
    coordinates = scaling.exact(program, scale)
    if coordinates is None:
        return None
    scale, scaled = coordinates
    # the linear parts along d, and an objective of -1
    zeros = tuple(np.zeros_like(c) for c in scaled.constants)
    falls = Equal("fall", Affine(np.ones((1, 1)), {}))
    closed = [_closed(c) for c in program.constraints]
    cone = scaling.Scaled(np.zeros(program.size), (*zeros, np.ones(1)), (*scaled.tensors, scaled.cost[None, :]))
    own = scaling.Scaled(scaled.cost, zeros, scaled.tensors)
    for setting in backends.CLARABEL:
        level = duality.level(cone, (*closed, falls), setting)
        attempts.append({**level.record, "aim": "ray", "level": level.value})
        if level.x is None:
            continue
        size = np.abs(level.x).max(initial=0.0)
        for cut in (0.0, 1e-8, 1e-6, 1e-4) if size else ():
            x = np.where(np.abs(level.x) > cut * size, level.x, 0.0)
            proved = points.prove(own, closed, x)
            # an exact direction is near: its part in the equalities is bounded, its inequalities are proved
            if proved is not None and proved.high < 0:
                return program.values(proved.x * scale.unknowns)
    return None


def _closed(constraint: Any) -> Any:
    if isinstance(constraint, Definite):
        return Definite(constraint.label, constraint.expression, False, constraint.rows)
    if isinstance(constraint, Entrywise):
        return constraint
    return Equal(constraint.label, constraint.expression)
