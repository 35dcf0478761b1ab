"""Scaling of a program: sizes of the unknowns, and a congruence of the rows of every block.

In SI units the blocks of an orbital problem spread over ten orders of magnitude, and every solver then returns nonsense
with a good status. A cone of semidefinite matrices is scaled by its solver with a single number, so the congruence
has to be part of the program.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from gainsay.errors import InputError
from gainsay.exact.floats import real_array, real_number
from gainsay.lmi.affine import Values, Variable
from gainsay.lmi.program import Program
from gainsay.lmi.rounding import power_of_two

# a coefficient of a proof and its inverse are below this: products of two are far from the ends of double precision
_FARTHEST = 2.0**450
# scaled size at which a coefficient is taken for the rounding of zero
_ROUNDING = 1e-11


@dataclass(frozen=True)
class Scaling:
    """Coordinates x = `unknowns` * x'; block j times `rows[j]` from both sides; objective divided by `cost`."""

    unknowns: np.ndarray
    rows: tuple[np.ndarray, ...]
    cost: float

    @property
    def binary(self) -> "Scaling":
        """The scaling by powers of two nearby."""
        rows = tuple(power_of_two(d) for d in self.rows)
        return Scaling(power_of_two(self.unknowns), rows, float(power_of_two(np.float64(self.cost))))

    def multipliers_in(self, other: "Scaling", multipliers: Sequence[np.ndarray]) -> list[np.ndarray]:
        """Multipliers of this scaling in the coordinates of another."""
        factor, moved = self.cost / other.cost, []
        for d, to, z in zip(self.rows, other.rows, multipliers, strict=True):
            ratio = d / to
            moved.append(factor * z * (np.outer(ratio, ratio) if z.ndim == 2 else ratio**2))
        return moved


@dataclass(frozen=True)
class Scaled:
    """A scaled program in coordinates: constants and tensors of every constraint, and the objective."""

    cost: np.ndarray
    constants: tuple[np.ndarray, ...]
    tensors: tuple[np.ndarray, ...]


def apply(program: Program, scaling: Scaling) -> Scaled:
    """Write the program in scaled coordinates."""
    constants, tensors = [], []
    for row, d in zip(program.rows, scaling.rows, strict=True):
        weight = np.outer(d, d) if row.is_matrix else d**2
        constants.append(row.constant * weight)
        tensors.append(row.tensor * weight[..., None] * scaling.unknowns)
    return Scaled(program.cost * scaling.unknowns / scaling.cost, tuple(constants), tuple(tensors))


def exact(program: Program, scaling: Scaling) -> tuple[Scaling, Scaled] | None:
    """Scaling by powers of two near a scaling, and the program scaled by it: with exactly the coefficients given.

    None where a coefficient leaves the range within which sums and products of doubles are rounded relative to their
    size, or where it was lost: nothing can be proved in such coordinates.
    """
    scaling = scaling.binary
    scaled = apply(program, scaling)
    given = (program.cost, *(row.constant for row in program.rows), *(row.tensor for row in program.rows))
    for part, before in zip((scaled.cost, *scaled.constants, *scaled.tensors), given, strict=True):
        size = np.abs(part[before != 0])
        if not (size > 1 / _FARTHEST).all() or not (size < _FARTHEST).all():
            return None
    return scaling, scaled


def beginning(program: Program, near: Values | None) -> Scaling:
    """The first scaling of a search for a point: from values of about the sizes expected, where they are given.

    Raises
    ------
    InputError
        If a value is missing or no finite number.
    """
    if near is None:
        return first(program)
    x = program.coordinates(near)
    if not np.isfinite(x).all():
        raise InputError("near", field=program.label, value="nan or inf", expected="finite values of all unknowns")
    return from_point(program, x)


def first(program: Program) -> Scaling:
    """Scaling from the stated typical sizes, and for the rest from the coefficients alone.

    The logarithms of the row and unknown scales are fitted so that all coefficients come near one (least squares).
    """
    known = {v: _stated(v, program.scale.typical[v.name]) for v in program.variables if v.name in program.scale.typical}
    return _fit(program, known, None)


def from_point(program: Program, x: np.ndarray) -> Scaling:
    """Scaling from the sizes of a point, even of one that is slightly outside."""
    known = {}
    for variable, place in program.places.items():
        value = np.atleast_2d(variable.matrix(x[place]))
        if variable.kind == "symmetric":
            sizes = np.sqrt(np.abs(np.diagonal(value)))
        elif variable.kind == "full":
            continue
        else:
            sizes = np.abs(np.diagonal(value))
        sizes = np.maximum(sizes, 1e-9 * sizes.max(initial=0.0))
        if sizes.min(initial=1.0) > 0:
            known[variable] = np.log(sizes)
    extents = [row.extent(x) for row in program.rows]
    return _fit(program, known, [-np.log(extent) / 2 for extent in extents], abs(program.cost @ x))


def balanced(program: Program, scale: Scaling, x: np.ndarray, multipliers: Sequence[np.ndarray]) -> Scaling:
    """Scaling in which blocks and multipliers have diagonals of one size, as interior multipliers need it.

    Parameters
    ----------
    program : Program
    scale : Scaling
        Scaling to which the multipliers belong.
    x : ndarray
        Coordinates of the optimum, unscaled.
    multipliers : sequence of ndarray
        Multipliers at the optimum.
    """
    rows = []
    for row, d, multiplier in zip(program.rows, scale.rows, multipliers, strict=True):
        block = row.extent(x) * d**2
        weight = np.abs(np.diagonal(multiplier) if row.is_matrix else multiplier)
        rows.append(d * (np.clip(weight, 1e-14, None) / block) ** 0.25)
    return Scaling(scale.unknowns, tuple(rows), scale.cost)


def _parameters(variable: Variable) -> np.ndarray:
    """Map from the scale logarithms of rows (and columns) to those of the coordinates."""
    rows, columns = variable.shape
    i, j = np.array(variable.index).T
    k = np.arange(variable.size)
    if variable.kind == "full":
        design = np.zeros((variable.size, rows + columns))
        design[k, i] = 1
        design[k, rows + j] = 1
    else:
        design = np.zeros((variable.size, rows))
        design[k, i] += 1
        if variable.kind == "symmetric":
            np.add.at(design, (k, j), 1)
    return design


def _stated(variable: Variable, typical: Any) -> np.ndarray:
    rows, columns = variable.shape
    field = f"typical size of {variable.name}"
    if variable.kind == "full":
        pair = (
            typical if isinstance(typical, tuple) else (np.ones(rows) * real_number(typical, field), np.ones(columns))
        )
        sizes = np.concatenate([np.atleast_1d(real_array(part, field)) for part in pair])
        expected = rows + columns
    else:
        sizes = real_array(typical, field)
        if sizes.ndim == 0 and sizes > 0:
            sizes = np.full(rows, np.sqrt(sizes) if variable.kind == "symmetric" else sizes)
        expected = rows
    if sizes.shape != (expected,) or not (sizes > 0).all():
        raise InputError("typical size", field=variable.name, value=typical, expected=f"{expected} positive numbers")
    return np.log(sizes)


def _fit(program: Program, known: dict, known_rows: list | None, objective: float = 0.0) -> Scaling:
    """Scaling in which coefficients come near one, but for those that it leaves at the size of rounding.

    A coefficient of 1e-17 that should be zero asks for a scale that nothing else in the program asks for.
    """
    fitted = _fitted(program, program.rows, known, known_rows, objective)
    if known_rows is not None and len(known) == len(program.variables):
        return fitted
    scaled = apply(program, fitted)
    rows = [
        replace(row, constant=_cleared(row.constant, constant), tensor=_cleared(row.tensor, tensor))
        for row, constant, tensor in zip(program.rows, scaled.constants, scaled.tensors, strict=True)
    ]
    if all((new.tensor == row.tensor).all() for new, row in zip(rows, program.rows, strict=True)):
        return fitted
    return _fitted(program, rows, known, known_rows, objective)


def _cleared(given: np.ndarray, scaled: np.ndarray) -> np.ndarray:
    return np.where(np.abs(scaled) > _ROUNDING, given, 0.0)


def _fitted(program: Program, given: Sequence[Any], known: dict, known_rows: list | None, objective: float) -> Scaling:
    designs = {v: _parameters(v) for v in program.variables}
    starts, total = {}, 0
    for variable, design in designs.items():
        starts[variable] = total
        total += design.shape[1]
    parameter = np.zeros((program.size, total))
    for variable, place in program.places.items():
        parameter[place, starts[variable] : starts[variable] + designs[variable].shape[1]] = designs[variable]
    row_starts, unknowns = [], total
    for row in program.rows:
        row_starts.append(unknowns)
        unknowns += row.size

    fixed = np.full(unknowns, np.nan)
    for variable, logs in known.items():
        fixed[starts[variable] : starts[variable] + len(logs)] = logs
    if known_rows is not None:
        fixed[total:] = np.concatenate(known_rows)
    normal, right = np.zeros((unknowns, unknowns)), np.zeros(unknowns)
    for row, start in zip(given, row_starts, strict=True):
        own, logs = _equations(row, start, parameter, unknowns)
        normal += own
        right -= logs
    free = np.isnan(fixed)
    solution = np.where(free, 0.0, fixed)
    if free.any():
        rest = right[free] - normal[np.ix_(free, ~free)] @ fixed[~free]
        solution[free] = np.linalg.lstsq(normal[np.ix_(free, free)], rest, rcond=1e-9)[0]
    scales = np.exp(np.clip(parameter @ solution[:total], -300, 300))
    rows = tuple(
        np.exp(np.clip(solution[start : start + row.size], -340, 340))
        for row, start in zip(program.rows, row_starts, strict=True)
    )
    cost = objective if objective > 0 else np.abs(program.cost * scales).max(initial=0.0)
    return Scaling(scales, rows, float(cost) or 1.0)


def _equations(row: Any, start: int, parameter: np.ndarray, unknowns: int) -> tuple[np.ndarray, np.ndarray]:
    """Normal equations of one row: for every nonzero coefficient, log|coefficient| + its scales = 0.

    A coefficient has the scales of its two rows (twice its own, in a list) and, but for constants, of its unknown. The
    equations are only counted, never written out: a large program has millions.
    """
    if row.is_matrix:
        i, j = np.nonzero(np.triu(np.abs(row.constant) + np.abs(row.tensor).max(axis=2, initial=0.0)))
        constants, tensor = row.constant[i, j], row.tensor[i, j]
    else:
        i = j = np.arange(row.size)
        constants, tensor = row.constant, row.tensor
    place = np.zeros((len(i), row.size))
    np.add.at(place, (np.arange(len(i)), i), 1)
    np.add.at(place, (np.arange(len(i)), j), 1)
    present, own = (tensor != 0).astype(float), (constants != 0).astype(float)
    logs = np.log(np.abs(tensor), where=tensor != 0, out=np.zeros_like(tensor))
    constant_logs = np.log(np.abs(constants), where=constants != 0, out=np.zeros_like(constants))
    total, rows = parameter.shape[1], slice(start, start + row.size)
    normal, right = np.zeros((unknowns, unknowns)), np.zeros(unknowns)
    normal[:total, :total] = parameter.T @ (present.sum(axis=0)[:, None] * parameter)
    normal[:total, rows] = parameter.T @ (present.T @ place)
    normal[rows, :total] = normal[:total, rows].T
    normal[rows, rows] = place.T @ ((present.sum(axis=1) + own)[:, None] * place)
    right[:total] = parameter.T @ logs.sum(axis=0)
    right[rows] = place.T @ (logs.sum(axis=1) + constant_logs)
    return normal, right
