"""Exact multipliers from a solver's: their ranges snapped to short rationals, their equations solved in rationals.

Where the points of a program lie on a face of its cones, a solver stalls, and its multipliers are known to some digits
only. Gauss-Newton steps in factors ``Z = V V'`` of a guessed rank bring back the others, however singular the program.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from flint import fmpq, fmpq_mat

from gainsay.exact.definite import positive_definite
from gainsay.exact.linear import Unsolvable, complete
from gainsay.exact.rational import fraction_of, rational_matrix, to_fmpq
from gainsay.lmi import scaling
from gainsay.lmi.affine import Definite, Entrywise, Equal
from gainsay.lmi.rounding import power_of_two

__all__ = ["Face", "exact_faces", "exact_multipliers", "nearest_doubles"]

# what is tried in rationals: unknown entries of multipliers, and coordinates
_MOST_ENTRIES = 400
# least relative eigenvalues kept of a multiplier, tried in turn
_CUTS = (1e-3, 1e-5, 1e-2, 1e-4, 1e-1, 1e-6)
# denominators of what a range is snapped to, and how near it has to be; of multipliers known to all digits, and to some
_SNAPS = ((3000, 1e-10), (24, 1e-4))
# Gauss-Newton steps, the size at which they end, the first whose rate counts, the slowest rate, singular values of none
_STEPS, _ENOUGH, _FIRST, _SLOW, _SINGULAR = 100, 1e-15, 6, 0.95, 1e-9


@dataclass(frozen=True)
class Face:
    """Exact multipliers ``Z_j = U_j M_j U_j'`` with rational U_j and M_j > 0 (entries z_i > 0 for a list).

    Attributes
    ----------
    frames : list
        Per constraint: fmpq_mat U_j, a list of indices, or None for an equality or a constraint without weight.
    cores : list
        Per constraint: fmpq_mat M_j, or a list of rationals (of all entries, for an equality).
    value : fmpq
        Sum of <constant part, Z_j>.
    """

    frames: list
    cores: list
    value: fmpq


def exact_faces(
    scaled: scaling.Scaled, constraints: Sequence, multipliers: Sequence[np.ndarray], target: int | None
) -> Iterator[Face]:
    """Exact solutions of ``0 = sum <coefficients, Z_j>`` near given multipliers, one a rank that these may have.

    Parameters
    ----------
    scaled : Scaled
    constraints : sequence of constraints
    multipliers : sequence of ndarray
        Near the wanted ones.
    target : int or None
        Value that the sum of <constant part, Z_j> is to have (0), or None for any.
    """
    right = np.append(np.zeros(len(scaled.cost)), np.nan if target is None else target)
    inside = [m for c, m in zip(constraints, multipliers, strict=True) if not isinstance(c, Equal)]
    yield from _near(scaled, constraints, multipliers, right, _largest(inside))


def exact_multipliers(
    scaled: scaling.Scaled, constraints: Sequence, multipliers: Sequence[np.ndarray]
) -> Iterator[tuple[float, Face]]:
    """Exact solutions of ``cost = sum <coefficients, Z_j>``, each a power of two and what it multiplies.

    They need no room inside their cones, which multipliers of an infimum that is not attained do not have.
    """
    unit = float(power_of_two(_largest(multipliers)))
    right = np.append(scaled.cost / unit, np.nan)
    for face in _near(scaled, constraints, [m / unit for m in multipliers], right, 1.0):
        yield unit, face


def _largest(multipliers: Sequence[np.ndarray]) -> float:
    return float(max((np.abs(m).max(initial=0.0) for m in multipliers), default=0.0)) or 1.0


def _near(
    scaled: scaling.Scaled, constraints: Sequence, multipliers: Sequence[np.ndarray], right: np.ndarray, top: float
) -> Iterator[Face]:
    """Exact multipliers whose equations, one a coordinate and one of the value, have the right sides: nan for any.

    Cuts are relative to the size `top`.
    """
    if len(scaled.cost) > _MOST_ENTRIES:
        return
    tried, homogeneous = set(), not np.nan_to_num(right).any()
    for cut in _CUTS:
        factors = [_factor(c, m, cut * top) for c, m in zip(constraints, multipliers, strict=True)]
        ranks = tuple(f.shape[-1] if f.ndim == 2 else int(np.count_nonzero(f)) for f in factors)
        weight = any(r for c, r in zip(constraints, ranks, strict=True) if not isinstance(c, Equal))
        if ranks in tried or (homogeneous and not weight):
            continue
        tried.add(ranks)
        if sum(r * (r + 1) // 2 if f.ndim == 2 else r for f, r in zip(factors, ranks, strict=True)) > _MOST_ENTRIES:
            continue
        factors = _polished(scaled, constraints, factors, right)
        for snap in _SNAPS:
            face = _snapped_face(scaled, constraints, factors, snap, right)
            if face is not None:
                yield face
                break


def _factor(constraint: object, z: np.ndarray, cut: float) -> np.ndarray:
    """V of a matrix ``V V'``; entries of a list, those below the cut zero; all of an equality."""
    if isinstance(constraint, Definite):
        values, vectors = np.linalg.eigh((z + z.T) / 2)
        large = values > cut
        return np.asarray(vectors[:, large] * np.sqrt(values[large]))
    return z if isinstance(constraint, Equal) else np.where(z > cut, z, 0.0)


def _polished(
    scaled: scaling.Scaled, constraints: Sequence, factors: list[np.ndarray], right: np.ndarray
) -> list[np.ndarray]:
    """Factors at which the equations hold to all digits, where Gauss-Newton steps lead there.

    The equations of a face within a face are singular: there the steps shrink by a constant factor only.
    """
    longest = np.inf
    with np.errstate(over="ignore", invalid="ignore"):  # steps that run away end in no exact solution
        for number in range(_STEPS):
            stated, rest = _linearised(scaled, constraints, factors, right)
            units = 1 / np.maximum(np.linalg.norm(stated, axis=1), 1e-300)
            try:
                step = np.linalg.lstsq(stated * units[:, None], -rest * units, rcond=_SINGULAR)[0]
            except np.linalg.LinAlgError:
                break
            if not np.isfinite(step).all():
                break
            factors = _moved(factors, step)
            before, longest = longest, float(np.abs(step).max(initial=0.0))
            if longest < _ENOUGH or (number >= _FIRST and longest > _SLOW * before):
                break
    return factors


def _linearised(
    scaled: scaling.Scaled, constraints: Sequence, factors: Sequence[np.ndarray], right: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Slopes and residuals of the equations, and where they are homogeneous of the trace, which is to stay."""
    slopes, rest = [], -np.nan_to_num(right)
    for constraint, tensor, constant, f in zip(constraints, scaled.tensors, scaled.constants, factors, strict=True):
        whole = np.concatenate([tensor, constant[..., None]], axis=-1)
        if isinstance(constraint, Definite):
            half = np.einsum("ijk,jr->irk", whole, f)
            rest += np.einsum("irk,ir->k", half, f)
            slope, weight = 2 * half.reshape(f.size, len(rest)), 2 * f
        else:
            rest += f @ whole
            kept = np.ones_like(f) if isinstance(constraint, Equal) else np.where(f > 0, 1.0, 0.0)
            slope, weight = whole * kept[:, None], np.zeros_like(f) if isinstance(constraint, Equal) else kept
        slopes.append(np.column_stack([slope, weight.ravel()]))
    asked = np.append(np.isfinite(right), not np.nan_to_num(right).any())
    return np.vstack(slopes).T[asked], np.append(rest, 0.0)[asked]


def _moved(factors: Sequence[np.ndarray], step: np.ndarray) -> list[np.ndarray]:
    ends = np.cumsum([f.size for f in factors])
    return [f + part.reshape(f.shape) for f, part in zip(factors, np.split(step, ends[:-1]), strict=True)]


def _snapped_face(
    scaled: scaling.Scaled,
    constraints: Sequence,
    factors: list[np.ndarray],
    snap: tuple[int, float],
    right: np.ndarray,
) -> Face | None:
    frames: list = []
    values: list[fmpq] = []
    scales: list[float] = []
    equations: list[dict[int, fmpq]] = [{} for _ in range(len(scaled.cost) + 1)]
    shapes: list[int] = []
    for constraint, tensor, constant, f in zip(constraints, scaled.tensors, scaled.constants, factors, strict=True):
        if isinstance(constraint, Definite):
            frame = _frame(f, snap)
            frames.append(frame)
            r = f.shape[1]
            shapes.append(r)
            if frame is None:
                continue
            back = np.linalg.pinv(nearest_doubles(frame)) @ f
            core = back @ back.T
            parts = [_congruent(frame, tensor[:, :, k]) for k in range(len(scaled.cost))]
            parts.append(_congruent(frame, constant))
            for a in range(r):
                for b in range(a + 1):
                    index = len(values)
                    values.append(to_fmpq(float(core[a, b])))
                    scales.append(float(np.sqrt(abs(core[a, a] * core[b, b]))) or 1e-300)
                    for equation, part in zip(equations, parts, strict=True):
                        if part is not None and part[a, b] != 0:
                            equation[index] = part[a, b] * (1 if a == b else 2)
            continue
        keep = range(len(f)) if isinstance(constraint, Equal) else [int(i) for i in np.flatnonzero(f > 0)]
        frames.append(None if isinstance(constraint, Equal) else list(keep))
        shapes.append(len(keep))
        for i in keep:
            index = len(values)
            values.append(to_fmpq(float(f[i])))
            scales.append(max(abs(float(f[i])), 1e-6))
            for k in np.flatnonzero(tensor[i]):
                equations[k][index] = to_fmpq(float(tensor[i, k]))
            if constant[i]:
                equations[-1][index] = to_fmpq(float(constant[i]))
    if not values:
        return None
    stated = [(e, to_fmpq(float(v))) for e, v in zip(equations, right, strict=True) if np.isfinite(v) and (e or v)]
    try:
        solved = complete([(dict(e), r) for e, r in stated], values, scales)
    except Unsolvable:
        return None
    total = sum((solved[i] * c for i, c in equations[-1].items()), fmpq(0))
    cores: list = []
    place = 0
    for constraint, frame, r in zip(constraints, frames, shapes, strict=True):
        if isinstance(constraint, Definite):
            if frame is None:
                cores.append(None)
                continue
            core = fmpq_mat(r, r)
            for a in range(r):
                for b in range(a + 1):
                    core[a, b] = core[b, a] = solved[place]
                    place += 1
            if not positive_definite(core):
                return None
            cores.append(core)
        else:
            entries = solved[place : place + r]
            place += r
            if isinstance(constraint, Entrywise) and any(v <= 0 for v in entries):
                return None
            cores.append(entries)
    return Face(frames, cores, total)


def _frame(factor: np.ndarray, snap: tuple[int, float]) -> fmpq_mat | None:
    """Range of a factor, its basis in echelon form snapped to short rationals; None for no range."""
    if factor.shape[1] == 0:
        return None
    if factor.shape[1] == len(factor):
        return fmpq_mat([[int(i == j) for j in range(len(factor))] for i in range(len(factor))])
    rows = np.linalg.qr(factor)[0].T
    pivots: list[int] = []
    for r in range(len(rows)):
        left = np.abs(rows[r:]).max(axis=0)
        left[pivots] = 0
        pivot = int(np.argmax(left > 0.5 * left.max()))
        lead = r + int(np.argmax(np.abs(rows[r:, pivot])))
        rows[[r, lead]] = rows[[lead, r]]
        rows[r] /= rows[r, pivot]
        for other in range(len(rows)):
            if other != r:
                rows[other] -= rows[other, pivot] * rows[r]
        pivots.append(pivot)
    return fmpq_mat([[to_fmpq(_snapped(v, snap)) for v in row] for row in rows.T])


def _snapped(value: float, snap: tuple[int, float]) -> Fraction:
    """The short rational near a value, up to a power of two, which a scale may have brought in."""
    most, near = snap
    mantissa, exponent = np.frexp(value)
    if abs(value) < near:
        return Fraction(0)
    short = Fraction(float(mantissa)).limit_denominator(most)
    if abs(float(short) - mantissa) < near:
        return short * Fraction(2) ** int(exponent)
    return Fraction(float(value))


def nearest_doubles(matrix: fmpq_mat) -> np.ndarray:
    """Entries of a rational matrix, each rounded once."""
    return np.array([[float(fraction_of(v)) for v in row] for row in matrix.tolist()])


def _congruent(frame: fmpq_mat, block: np.ndarray) -> fmpq_mat | None:
    if not block.any():
        return None
    return frame.transpose() * rational_matrix(block.tolist()) * frame
