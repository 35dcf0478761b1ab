"""Multipliers with room inside their cones: what rounding to exact ones needs, and extreme ones do not have."""

from collections.abc import Mapping

import numpy as np

from gainsay.lmi.affine import Affine, Definite, Entrywise, Equal, Variable, affine, scalar
from gainsay.lmi.blocks import equal
from gainsay.lmi.outcomes import Solved
from gainsay.lmi.program import Program, Row
from gainsay.lmi.solving import solve

__all__ = ["interior_multipliers"]

# diagonal entries below this share of the largest one count as rows that carry no weight
_NOTHING = 1e-13


def interior_multipliers(program: Program, multipliers: Mapping[str, np.ndarray]) -> dict[str, np.ndarray] | None:
    """Multipliers of the same rows under which every unknown cancels, as far inside their cones as can be.

    Parameters
    ----------
    program : Program
        Refuted by the given ones; its objective is not looked at.
    multipliers : mapping of label to ndarray
        Those of `Farkas`. Rows in which they have no weight get none.

    Returns
    -------
    dict of label to ndarray, or None
        None where none with a margin were found. Floats, proved nothing: the checker of certificates decides.
    """
    given = {label: np.asarray(value, dtype=float) for label, value in multipliers.items()}
    return _inside(program, given, True) or _inside(program, given, False)


def _inside(program: Program, given: Mapping[str, np.ndarray], weighted: bool) -> dict[str, np.ndarray] | None:
    """Multipliers over the rows in which the given ones have weight, or over all rows."""
    known = [(row, given[row.constraint.label], 1 / row.extent(np.ones(program.size))) for row in program.rows]
    heaviest = max(float((_weights(row, z) / typical).max(initial=0.0)) for row, z, typical in known)
    parts = [
        _Part(f"Z{i}", row, z, None if weighted else 1e-3 * heaviest * typical)
        for i, (row, z, typical) in enumerate(known)
    ]
    parts = [part for part in parts if part.variable is not None]
    if not any(isinstance(part.row.constraint, Definite | Entrywise) for part in parts):
        return None
    level = scalar("level")
    cancelled = sum(part.against(part.row.tensor) for part in parts)
    value = sum((part.against(part.row.constant[..., None]) for part in parts), affine(0))
    before = sum(float(np.sum(part.given * part.row.constant)) for part in parts)
    size = sum(part.weight() for part in parts if part.is_cone)
    held = [part.inside(level) for part in parts if part.is_cone]
    constraints = [*held, equal(cancelled, 0, "unknowns cancel"), equal(size, _count(parts), "size")]
    if value.terms and any(np.abs(c).max() > 0 for c in value.terms.values()):
        constraints.append((-value > -0.5 * min(before, 0.0)).named("value"))
    outcome = solve(Program(-level, constraints, label=f"multipliers of {program.label}", margin=1e-9))
    if not isinstance(outcome, Solved) or not outcome["level"] > 0:
        return None
    rest = {row.constraint.label: np.zeros_like(given[row.constraint.label]) for row in program.rows}
    return {**rest, **{part.row.constraint.label: part.filled(outcome[part.name]) for part in parts}}


def _weights(row: Row, given: np.ndarray) -> np.ndarray:
    return np.diagonal(given) if row.is_matrix else np.abs(given)


class _Part:
    """The multiplier of one constraint: an unknown over the rows in which the given one has weight, or over all."""

    def __init__(self, name: str, row: Row, given: np.ndarray, least: np.ndarray | None) -> None:
        self.name, self.row, self.given = name, row, given
        self.is_cone = not isinstance(row.constraint, Equal)
        weights = _weights(row, given)
        self.kept = np.arange(len(weights))
        if self.is_cone and least is None:
            self.kept = np.flatnonzero(weights > _NOTHING * weights.max(initial=0.0))
        self.sizes = weights[self.kept] if least is None else np.maximum(weights, least)
        kind, columns = ("symmetric", len(self.kept)) if row.is_matrix else ("full", 1)
        self.variable = Variable(name, kind, len(self.kept), columns) if len(self.kept) else None

    def against(self, tensor: np.ndarray) -> Affine:
        """Inner products of the multiplier with each of k matrices or lists, shape (k, 1)."""
        assert self.variable is not None
        if self.row.is_matrix:
            part = tensor[np.ix_(self.kept, self.kept)]
            rows, columns = np.array(self.variable.index).T
            coefficients = np.where(rows == columns, 1.0, 2.0)[:, None] * part[rows, columns]
        else:
            coefficients = tensor[self.kept]
        return Affine(np.zeros((tensor.shape[-1], 1)), {self.variable: coefficients.T[:, None, :]})

    def weight(self) -> Affine:
        """Trace relative to the sizes of the given multiplier."""
        inverse = np.diag(1 / self.sizes) if self.row.is_matrix else 1 / self.sizes
        return self.against(self._spread(inverse)[..., None])

    def _spread(self, values: np.ndarray) -> np.ndarray:
        whole = np.zeros(self.given.shape)
        whole[np.ix_(self.kept, self.kept) if self.row.is_matrix else self.kept] = values
        return whole

    def inside(self, level: Variable) -> Definite:
        """At least `level` times the sizes of the given multiplier."""
        assert self.variable is not None
        if self.row.is_matrix:
            return (self.variable > level * np.diag(self.sizes)).named(self.row.constraint.label)
        entries = affine(np.zeros((len(self.kept), len(self.kept))))
        for i, size in enumerate(self.sizes):
            unit = np.zeros((len(self.kept), 1))
            unit[i] = 1.0
            entries = entries + unit @ (self.variable[i : i + 1, :] - level * size) @ unit.T
        return (entries > 0).named(self.row.constraint.label)

    def filled(self, value: np.ndarray) -> np.ndarray:
        """The multiplier of all rows."""
        matrix = np.atleast_2d(np.asarray(value, dtype=float))
        return self._spread(matrix if self.row.is_matrix else matrix.ravel())


def _count(parts: list[_Part]) -> float:
    return float(sum(len(part.kept) for part in parts if part.is_cone))
