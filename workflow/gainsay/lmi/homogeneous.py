"""The part of a program without constants: where it has no solution, the program has none.

Refutations of a strict inequality that is homogeneous in the unknowns are lost to a solver beside large constants of
other rows; on their own they are well scaled.
"""

from dataclasses import dataclass, replace

import numpy as np

from gainsay.lmi.affine import Affine, Definite, Entrywise, Equal
from gainsay.lmi.outcomes import Farkas
from gainsay.lmi.points import is_strict
from gainsay.lmi.program import Program


@dataclass(frozen=True)
class Part:
    """A program implied by another: principal parts and entries, named by the rows kept of each constraint."""

    program: Program
    rows: dict[str, np.ndarray]
    sizes: dict[str, tuple[int, ...]]

    def lifted(self, proof: Farkas) -> Farkas:
        """Multipliers of the part as those of the whole, zero elsewhere."""
        whole = {}
        for label, shape in self.sizes.items():
            whole[label] = np.zeros(shape)
            kept = self.rows.get(label)
            if kept is not None:
                place = np.ix_(kept, kept) if len(shape) == 2 else kept
                whole[label][place] = proof.multipliers[label]
        return replace(proof, multipliers=whole, reason=f"{proof.reason}, of the rows without constants")


def homogeneous_part(program: Program) -> Part | None:
    """Principal parts and entries whose constants are zero; None where that is all, or nothing strict."""
    constraints: list = []
    rows: dict[str, np.ndarray] = {}
    dropped = False
    for row in program.rows:
        constraint = row.constraint
        kept = _without_constants(row.constant)
        dropped |= len(kept) < row.size
        if len(kept) == 0 or not (row.tensor[kept][:, kept] if row.is_matrix else row.tensor[kept]).any():
            continue
        rows[constraint.label] = kept
        if isinstance(constraint, Definite):
            part = _picked(program, row.tensor[np.ix_(kept, kept)])
            constraints.append(Definite(constraint.label, part, constraint.strict, _sizes(constraint, kept)))
        else:
            part = _picked(program, row.tensor[kept][:, None])
            constraints.append((Equal if isinstance(constraint, Equal) else Entrywise)(constraint.label, part))
    if not dropped or not any(is_strict(c) for c in constraints):
        return None
    smaller = replace(program, minimise=None, subject_to=constraints, scale=type(program.scale)())
    sizes: dict[str, tuple[int, ...]] = {
        r.constraint.label: (r.size, r.size) if r.is_matrix else (r.size,) for r in program.rows
    }
    return Part(smaller, rows, sizes)


def _without_constants(constant: np.ndarray) -> np.ndarray:
    if constant.ndim == 1:
        return np.flatnonzero(constant == 0)
    kept = [i for i in range(len(constant)) if constant[i, i] == 0]
    while True:
        linked = np.count_nonzero(constant[np.ix_(kept, kept)], axis=1)
        if not linked.any():
            return np.array(kept, dtype=int)
        kept.pop(int(np.argmax(linked)))


def _sizes(constraint: Definite, kept: np.ndarray) -> tuple[tuple[str, int], ...]:
    total, sizes = 0, []
    for name, size in constraint.rows:
        count = int(((kept >= total) & (kept < total + size)).sum())
        total += size
        if count:
            sizes.append((name, count))
    return tuple(sizes)


def _picked(program: Program, tensor: np.ndarray) -> Affine:
    terms = {v: tensor[..., place] for v, place in program.places.items() if tensor[..., place].any()}
    return Affine(np.zeros(tensor.shape[:2]), terms)
