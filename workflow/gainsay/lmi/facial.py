"""Facial reduction: multipliers of value zero confine the points of a program to a face, exactly.

Where ``sum <Z_j, F_j(x)>`` is zero for every x and Z_j >= 0, every point has ``F_j(x) Z_j = 0``. The program with these
equations, and each block without the range of Z_j, has the same points. All of it in rationals, and only where
the smaller program has coefficients that are doubles again.

Reference: J. M. Borwein, H. Wolkowicz, "Regularizing the abstract convex program", J. Math. Anal. Appl. 83 (1981).
"""

from collections.abc import Sequence
from dataclasses import replace
from math import lcm

import numpy as np
from flint import fmpq_mat

from gainsay.exact.rational import fraction_of, to_fmpq
from gainsay.lmi import scaling
from gainsay.lmi.affine import Affine, Definite, Entrywise, Equal
from gainsay.lmi.duality import unscaled
from gainsay.lmi.exposing import Face, exact_multipliers, nearest_doubles
from gainsay.lmi.outcomes import Farkas
from gainsay.lmi.points import is_strict
from gainsay.lmi.program import Program, Row


def refutes(program: Program, face: Face) -> bool:
    """Whether exact multipliers exclude the program as stated."""
    weight = any(is_strict(c) and f is not None for c, f in zip(program.constraints, face.frames, strict=True))
    return bool(face.value < 0 or (face.value == 0 and weight))


def told(program: Program, scale: scaling.Scaling, face: Face) -> Farkas:
    """Exact multipliers in floats, by label of the constraints."""
    value = float(fraction_of(face.value))
    return Farkas(unscaled(program.constraints, scale, _multipliers(program, face)), value, 0.0, "rational multipliers")


def exact_bound(
    program: Program, scale: scaling.Scaling, multipliers: Sequence[np.ndarray]
) -> tuple[float, dict[str, np.ndarray]]:
    """Lower bound on the infimum from exact multipliers near given ones of a scaling, as `duality.lower_bound`."""
    coordinates = scaling.exact(program, scale)
    if coordinates is None or not all(np.isfinite(m).all() for m in multipliers):
        return -np.inf, {}
    exact, scaled = coordinates
    for unit, face in exact_multipliers(scaled, program.constraints, scale.multipliers_in(exact, multipliers)):
        # powers of two: what they multiply is rounded once, and so is the sum
        weight = to_fmpq(unit) * to_fmpq(float(exact.cost))
        bound = to_fmpq(float(program.objective.constant[0, 0])) - weight * face.value
        rounded = float(fraction_of(bound))
        if to_fmpq(rounded) > bound:
            rounded = float(np.nextafter(rounded, -np.inf))
        parts = unscaled(program.constraints, exact, [unit * exact.cost * z for z in _multipliers(program, face)])
        return rounded, parts
    return -np.inf, {}


def _multipliers(program: Program, face: Face) -> list[np.ndarray]:
    """Exact multipliers in floats, one a constraint."""
    z = []
    for constraint, row, frame, core in zip(program.constraints, program.rows, face.frames, face.cores, strict=True):
        if isinstance(constraint, Definite):
            m = np.zeros((row.size, row.size)) if frame is None else nearest_doubles(frame * core * frame.transpose())
        elif isinstance(constraint, Equal):
            m = np.array([float(fraction_of(v)) for v in core])
        else:
            m = np.zeros(row.size)
            m[frame] = [float(fraction_of(v)) for v in core]
        z.append(m)
    return z


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
    for a in range(rank):
        unit = lcm(*(int(echelon[i, a].q) for i in range(size)))
        for i in range(size):
            outer[i, a] = float(fraction_of(echelon[i, a] * unit))
            if to_fmpq(outer[i, a]) != echelon[i, a] * unit:
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
