"""Proof that a point satisfies a program: float bounds first, exact rationals where a closed cone touches the point."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from flint import fmpq, fmpq_mat

from gainsay.exact.definite import positive_semidefinite, rational_positive_definite
from gainsay.exact.rational import to_fmpq
from gainsay.lmi.affine import Definite, Entrywise, Equal
from gainsay.lmi.outcomes import Solved
from gainsay.lmi.program import Program
from gainsay.lmi.rounding import RightInverse, gamma, norm, power_of_two, proved_positive, residual
from gainsay.lmi.scaling import Scaled, Scaling
from gainsay.lmi.scaling import exact as exact_scaling

# exact rationals are tried for blocks of so many coefficients at most, and only for points that miss by this little
_MOST_EXACT = 40_000
_NEAR = 1e-7
_TINY = 1e-300


@dataclass(frozen=True)
class Proved:
    """Coordinates beside an exact solution that is proved to exist within `distance`, and bounds on its cost."""

    x: np.ndarray
    distance: float
    low: float
    high: float


def independent_rows(rows: np.ndarray, right: np.ndarray) -> np.ndarray | None:
    """Indices of rows of ``rows x + right = 0`` that say all, exactly; None where they contradict each other."""
    _, first = np.unique(np.column_stack([rows, right]), axis=0, return_index=True)
    kept = np.sort(first)
    kept = kept[np.abs(np.column_stack([rows, right])[kept]).max(axis=1, initial=0.0) > 0]
    units = power_of_two(1 / np.abs(rows[kept]).max(axis=1, initial=_TINY))
    if RightInverse.of(rows[kept] * units[:, None]) is not None:
        return kept
    whole = fmpq_mat([[to_fmpq(x) for x in (*rows[i], right[i])] for i in kept])
    reduced, rank = whole.transpose().rref()  # its pivot columns are independent rows of the whole
    pivots = [next(j for j in range(len(kept)) if reduced[i, j] != 0) for i in range(rank)]
    _, left = fmpq_mat([[to_fmpq(x) for x in rows[i]] for i in kept]).rref()
    return None if left < rank else kept[pivots]


def contradiction(rows: np.ndarray, right: np.ndarray) -> np.ndarray | None:
    """Weights of equalities ``rows x + right = 0`` whose sum is -1 whatever x, exact before they are rounded."""
    if rows.size > _MOST_EXACT or independent_rows(rows, right) is not None:
        return None
    stated = np.vstack([rows.T, right[None, :]])
    goal = np.zeros(len(stated))
    goal[-1] = -1.0
    whole, rank = fmpq_mat([[to_fmpq(float(v)) for v in line] for line in np.column_stack([stated, goal])]).rref()
    weights = np.zeros(len(rows))
    for i in range(rank):
        pivot = next(j for j in range(whole.ncols()) if whole[i, j] != 0)
        if pivot == len(rows):
            return None
        value = whole[i, len(rows)]
        weights[pivot] = int(value.p) / int(value.q)
    return weights


def equations(scaled: Scaled, constraints: Sequence) -> tuple[np.ndarray, np.ndarray]:
    """Coefficients and constants of all equalities, stacked."""
    size = len(scaled.cost)
    parts = [
        (t, c) for t, c, of in zip(scaled.tensors, scaled.constants, constraints, strict=True) if isinstance(of, Equal)
    ]
    if not parts:
        return np.zeros((0, size)), np.zeros(0)
    return np.vstack([t for t, _ in parts]), np.concatenate([c for _, c in parts])


def prove(scaled: Scaled, constraints: Sequence, x: np.ndarray) -> Proved | None:
    """Prove that an exact solution of the equalities near x satisfies every inequality; None where it is not proved.

    Parameters
    ----------
    scaled : Scaled
        The program, in coordinates scaled by powers of two, so that its coefficients are those given.
    constraints : sequence of constraints
    x : ndarray
        Coordinates; moved onto the equalities to rounding.
    """
    distance = 0.0
    rows, right = equations(scaled, constraints)
    if len(rows):
        kept = independent_rows(rows, right)
        if kept is None:
            return None
        rows, right = rows[kept], right[kept]
        units = power_of_two(1 / np.abs(rows).max(axis=1, initial=_TINY))
        rows, right = rows * units[:, None], right * units
        inverse = RightInverse.of(rows)
        if inverse is None:
            return None
        for _ in range(3):
            x = x - inverse.matrix @ residual(rows, right, x)
        distance = inverse.reach(norm(residual(rows, right, x)))
        if not np.isfinite(distance):
            return None
    if not np.isfinite(x).all():
        return None
    for tensor, constant, constraint in zip(scaled.tensors, scaled.constants, constraints, strict=True):
        if not isinstance(constraint, Equal) and not holds(tensor, constant, constraint, x, distance):
            return None
    cost = float(scaled.cost @ x)
    spread = gamma(len(x)) * float(np.abs(scaled.cost) @ np.abs(x)) + distance * norm(scaled.cost)
    return Proved(x, distance, cost - spread, cost + spread)


def holds(tensor: np.ndarray, constant: np.ndarray, constraint: Any, x: np.ndarray, distance: float = 0.0) -> bool:
    """Whether one inequality is proved for all coordinates within `distance` of x."""
    value = constant + tensor @ x
    terms = int(np.count_nonzero(tensor, axis=-1).max(initial=0))
    error = gamma(terms + 1) * (np.abs(constant) + np.abs(tensor) @ np.abs(x)) + _TINY
    if distance:
        error = error + distance * np.sqrt((tensor**2).sum(axis=-1)) * (1 + gamma(len(x)))
    if isinstance(constraint, Entrywise):
        sure = value - error >= 0
        return bool(sure.all()) or (
            not distance and all(_entry(tensor[i], constant[i], x) >= 0 for i in np.flatnonzero(~sure))
        )
    if proved_positive(value, error):
        return True
    if distance or np.count_nonzero(tensor) > _MOST_EXACT:
        return False
    size = np.abs(value).max(initial=0.0)
    if np.linalg.eigvalsh(value)[0] < -_NEAR * size:
        return False
    exact = exact_block(tensor, constant, [to_fmpq(float(v)) for v in x])
    return rational_positive_definite(exact) if constraint.strict else positive_semidefinite(exact)


def _entry(coefficients: np.ndarray, constant: float, x: np.ndarray) -> fmpq:
    return sum(
        (to_fmpq(float(coefficients[k])) * to_fmpq(float(x[k])) for k in np.flatnonzero(coefficients)),
        to_fmpq(float(constant)),
    )


def exact_block(tensor: np.ndarray, constant: np.ndarray, x: Sequence[fmpq]) -> fmpq_mat:
    """Value of a matrix inequality in rationals."""
    size = len(constant)
    rows = [[to_fmpq(float(v)) for v in line] for line in constant]
    for i, j, k in zip(*np.nonzero(tensor), strict=True):
        rows[i][j] += to_fmpq(float(tensor[i, j, k])) * x[k]
    return fmpq_mat(size, size, [v for line in rows for v in line])


def is_strict(constraint: Any) -> bool:
    """Whether a constraint excludes the boundary of its cone."""
    return isinstance(constraint, Definite) and constraint.strict


def proved_point(program: Program, scale: Scaling, x: np.ndarray, gap: float) -> Solved | None:
    """The point near coordinates x, if it is proved to satisfy the program."""
    coordinates = exact_scaling(program, scale)
    if coordinates is None:
        return None
    exact, scaled = coordinates
    proved = prove(scaled, program.constraints, x / exact.unknowns)
    if proved is None:
        return None
    values = program.values(proved.x * exact.unknowns)
    check = program.check(values)
    return Solved(values, _above(program, exact, proved), check, gap, ())


def _above(program: Program, scale: Scaling, proved: Proved) -> float:
    """Upper bound on the objective at a proved point."""
    constant = float(program.objective.constant[0, 0])
    if not program.cost.any():
        return constant
    high = scale.cost * proved.high + constant
    return high + 4e-16 * (abs(scale.cost * proved.high) + abs(constant)) if constant else high
