"""Facial reduction: multipliers of value zero confine the points of a program to a face, exactly.

Where ``sum <Z_j, F_j(x)>`` is zero for every x and Z_j >= 0, every point has ``F_j(x) Z_j = 0``. The program with these
equations, and each block without the range of Z_j, has the same points. All of it in rationals, and only where
the smaller program has coefficients that are doubles again.

Reference: J. M. Borwein, H. Wolkowicz, "Regularizing the abstract convex program", J. Math. Anal. Appl. 83 (1981).
"""

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction

import numpy as np
from flint import fmpq, fmpq_mat

from gainsay.exact.definite import positive_definite
from gainsay.exact.linear import Unsolvable, complete
from gainsay.exact.rational import fraction_of, to_fmpq
from gainsay.lmi import scaling
from gainsay.lmi.affine import Affine, Definite, Entrywise, Equal
from gainsay.lmi.duality import unscaled
from gainsay.lmi.outcomes import Farkas
from gainsay.lmi.points import is_strict
from gainsay.lmi.program import Program, Row

# what is tried in rationals: unknown entries of multipliers, and coordinates
_MOST_ENTRIES = 400
_DENOMINATOR = 24
_SNAP = 1e-4


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

    def __init__(self, frames: list, cores: list, value: fmpq) -> None:
        self.frames, self.cores, self.value = frames, cores, value


def exact_face(
    scaled: scaling.Scaled, constraints: Sequence, multipliers: Sequence[np.ndarray], target: int | None
) -> Face | None:
    """Snap the ranges of multipliers to short rationals and solve their equations exactly.

    Parameters
    ----------
    scaled : Scaled
    constraints : sequence of constraints
    multipliers : sequence of ndarray
        Near the wanted ones.
    target : int or None
        Value that the sum of <constant part, Z_j> is to have (0), or None for any.
    """
    top = max(
        (
            float(np.abs(m).max(initial=0.0))
            for c, m in zip(constraints, multipliers, strict=True)
            if not isinstance(c, Equal)
        ),
        default=0.0,
    )
    if not top > 0 or len(scaled.cost) > _MOST_ENTRIES:
        return None
    for cut in (1e-3, 1e-5):
        found = _on_cut(scaled, constraints, [m / top for m in multipliers], cut, target)
        if found is not None:
            return found
    return None


def _on_cut(scaled: scaling.Scaled, constraints: Sequence, z: list, cut: float, target: int | None) -> Face | None:
    frames: list = []
    values: list[fmpq] = []
    scales: list[float] = []
    equations: list[dict[int, fmpq]] = [{} for _ in range(len(scaled.cost) + 1)]
    shapes: list[int] = []
    for constraint, tensor, constant, m in zip(constraints, scaled.tensors, scaled.constants, z, strict=True):
        start = len(values)
        if isinstance(constraint, Definite):
            frame = _frame((m + m.T) / 2, cut)
            frames.append(frame)
            if frame is None:
                shapes.append(0)
                continue
            floats = np.array([[int(v.p) / int(v.q) for v in row] for row in frame.tolist()])
            back = np.linalg.pinv(floats)
            core = back @ m @ back.T
            r = core.shape[0]
            shapes.append(r)
            if start + r * (r + 1) // 2 > _MOST_ENTRIES:
                return None
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
        keep = range(len(m)) if isinstance(constraint, Equal) else [int(i) for i in np.flatnonzero(m > cut)]
        frames.append(None if isinstance(constraint, Equal) else list(keep))
        shapes.append(len(keep))
        for i in keep:
            index = len(values)
            values.append(to_fmpq(float(m[i])))
            scales.append(max(abs(float(m[i])), 1e-6))
            for k in np.flatnonzero(tensor[i]):
                equations[k][index] = to_fmpq(float(tensor[i, k]))
            if constant[i]:
                equations[-1][index] = to_fmpq(float(constant[i]))
    if not values or len(values) > _MOST_ENTRIES:
        return None
    stated = [(e, fmpq(0)) for e in equations[: -1 if target is None else None] if e]
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


def _frame(z: np.ndarray, cut: float) -> fmpq_mat | None:
    """Range of a multiplier above a cut, its basis in echelon form snapped to short rationals; None for no range."""
    values, vectors = np.linalg.eigh(z)
    basis = vectors[:, values > cut]
    if basis.shape[1] == 0:
        return None
    if basis.shape[1] == len(z):
        return fmpq_mat([[int(i == j) for j in range(len(z))] for i in range(len(z))])
    rows = basis.T.copy()
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
    return fmpq_mat([[to_fmpq(_snapped(v)) for v in row] for row in rows.T])


def _snapped(value: float) -> Fraction:
    near = Fraction(float(value)).limit_denominator(_DENOMINATOR)
    return near if abs(float(near) - value) < _SNAP * max(1.0, abs(value)) else Fraction(float(value))


def _congruent(frame: fmpq_mat, block: np.ndarray) -> fmpq_mat | None:
    if not block.any():
        return None
    exact = fmpq_mat([[to_fmpq(float(v)) for v in row] for row in block])
    return frame.transpose() * exact * frame


def refuted(program: Program, scale: scaling.Scaling, face: Face) -> Farkas | None:
    """Refutation from exact multipliers, where they exclude the program as stated."""
    weight = any(is_strict(c) and f is not None for c, f in zip(program.constraints, face.frames, strict=True))
    if not (face.value < 0 or (face.value == 0 and weight)):
        return None
    z = []
    for constraint, row, frame, core in zip(program.constraints, program.rows, face.frames, face.cores, strict=True):
        if isinstance(constraint, Definite):
            m = np.zeros((row.size, row.size)) if frame is None else _floats(frame * core * frame.transpose())
        elif isinstance(constraint, Equal):
            m = np.array([float(fraction_of(v)) for v in core])
        else:
            m = np.zeros(row.size)
            m[frame] = [float(fraction_of(v)) for v in core]
        z.append(m)
    value = float(fraction_of(face.value))
    return Farkas(unscaled(program.constraints, scale, z), value, 0.0, "rational multipliers")


def _floats(matrix: fmpq_mat) -> np.ndarray:
    return np.array([[float(fraction_of(v)) for v in row] for row in matrix.tolist()])


def reduced(program: Program, scale: scaling.Scaling, face: Face) -> Program | None:
    """The program on the face that multipliers of value zero expose; None where its coefficients are no doubles."""
    if face.value != 0:
        return None
    constraints: list = []
    for row, d, frame in zip(program.rows, scale.rows, face.frames, strict=True):
        constraint = row.constraint
        if frame is None or isinstance(constraint, Equal) or (isinstance(frame, list) and not frame):
            constraints.append(constraint)
        elif isinstance(constraint, Entrywise):
            rest = [i for i in range(row.size) if i not in frame]
            constraints.append(Equal(f"{constraint.label} on the face", _part(program, row, frame)))
            if rest:
                constraints.append(Entrywise(constraint.label, _part(program, row, rest)))
        else:
            made = _smaller(program, row, d, frame)
            if made is None:
                return None
            constraints += made
    return replace(program, subject_to=constraints, label=f"{program.label} on a face")


def _part(program: Program, row: Row, kept: Sequence[int]) -> Affine:
    flat = row.constraint.expression
    if flat.shape[1] == 1 or flat.shape[0] == 1:
        return flat[kept, :] if flat.shape[1] == 1 else flat[:, kept]
    terms = {v: row.tensor[kept][:, None, place] for v, place in program.places.items()}
    return Affine(row.constant[kept][:, None], terms)


def _smaller(program: Program, row: Row, d: np.ndarray, frame: fmpq_mat) -> list | None:
    """``F U = 0`` and the block W' F W, W a complement of the range of U, both in unscaled coordinates."""
    size, rank = frame.nrows(), frame.ncols()
    # Z in the coordinates of the program is D Z D, D of powers of two
    whole = [[to_fmpq(float(d[i])) * frame[i, a] for a in range(rank)] for i in range(size)]
    scales = [max(abs(row_[a]) for row_ in whole) for a in range(rank)]
    whole = [[whole[i][a] / scales[a] for a in range(rank)] for i in range(size)]
    pivots, echelon = _pivots(fmpq_mat(whole))
    rest = [i for i in range(size) if i not in pivots]
    outer = np.zeros((size, rank))
    for i in range(size):
        for a in range(rank):
            outer[i, a] = float(fraction_of(echelon[i, a]))
            if to_fmpq(outer[i, a]) != echelon[i, a]:
                return None
    inner = np.zeros((size, len(rest)))
    inner[rest, range(len(rest))] = 1.0  # unit vectors complete the range
    constraint = row.constraint
    assert isinstance(constraint, Definite), "frames are of matrix inequalities"
    made: list = []
    equal = exact_product(program, row, np.eye(size), outer)
    if equal is None:
        return None
    made.append(Equal(f"{constraint.label} on the face", equal))
    if rest:
        block = exact_product(program, row, inner, inner)
        assert block is not None  # unit vectors pick entries
        made.append(Definite(constraint.label, block, constraint.strict, (("", len(rest)),)))
    return made


def _pivots(matrix: fmpq_mat) -> tuple[list[int], fmpq_mat]:
    """Basis of the same range with an identity in the rows returned."""
    echelon, rank = matrix.transpose().rref()
    pivots = [next(j for j in range(matrix.nrows()) if echelon[i, j] != 0) for i in range(rank)]
    return pivots, echelon.transpose()


def exact_product(program: Program, row: Row, left: np.ndarray, right: np.ndarray) -> Affine | None:
    """``left' F right`` with coefficients that are doubles, or None where one is not."""

    def exactly(block: np.ndarray) -> np.ndarray | None:
        if not block.any():
            return np.zeros((left.shape[1], right.shape[1]))
        picked = all(np.count_nonzero(c) == 1 and c.max() == 1 for c in (*left.T, *right.T))
        product = left.T @ block @ right
        if picked:
            return product
        exact = [fmpq_mat([[to_fmpq(float(v)) for v in line] for line in m]) for m in (left.T, block, right)]
        true = (exact[0] * exact[1] * exact[2]).tolist()
        same = all(to_fmpq(float(product[i, j])) == true[i][j] for i in range(len(true)) for j in range(len(true[0])))
        return product if same else None

    constant = exactly(row.constant)
    if constant is None:
        return None
    terms = {}
    for variable, place in program.places.items():
        slices = []
        for k in range(place.start, place.stop):
            part = exactly(row.tensor[:, :, k])
            if part is None:
                return None
            slices.append(part)
        if any(s.any() for s in slices):
            terms[variable] = np.stack(slices, axis=-1)
    return Affine(constant, terms)
