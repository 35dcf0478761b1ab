"""Refutation of a Lyapunov or Stein inequality by a matrix of the wrong inertia: its multipliers have no exact form."""

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from math import isqrt
from typing import Any

import numpy as np
from flint import fmpq_mpoly

from gainsay.errors import CertificateError
from gainsay.exact.ball import precision
from gainsay.exact.matrix import BALL, Matrix
from gainsay.exact.rational import fraction_of
from gainsay.lmi.instability import candidates
from gainsay.proof import Certificate, build
from gainsay.proof.duality import constraints
from gainsay.proof.scope import Scope, positions
from gainsay.statements.program import Stated

__all__ = ["wrong_inertia"]

#: an entry that is linear in one unknown: the place of each of its entries with the coefficient
_Entry = dict[tuple[int, int], Fraction]
_Rows = list[list[Fraction]]


def wrong_inertia(stated: Stated, **parts: Any) -> Certificate:
    """Certificate of kind ``wrong_inertia`` that a program has no point.

    Parameters
    ----------
    stated : Stated
        With constraints that say P > 0 and A'P + P A < 0 or B'P B - c P < 0 for a symmetric unknown P, as wholes or as
        principal parts; Stein's with c = 1 also as the block matrix [[P, B'P], [P B, P]] > 0.
    **parts
        As for `gainsay.proof.build.certificate`.

    Raises
    ------
    CertificateError
        If there are none, or their matrix is not proved unstable.
    """
    reason = "no Lyapunov or Stein inequality of an unstable matrix"
    for fields, witness in _proposals(stated, parts):
        try:
            return build.certificate(
                "wrong_inertia", **{**parts, "fields": {**parts["fields"], **fields}}, witness=witness
            )
        except CertificateError as error:
            reason = str(error)
    raise CertificateError(reason)


def _proposals(stated: Stated, parts: Mapping[str, Any]) -> Iterator[tuple[dict[str, str], dict[str, Any]]]:
    """Fields and witnesses to try."""
    frame = build.frame("wrong_inertia", stated.case, parts)
    with precision(frame.precision):
        scope = Scope(frame, stated.case)
        scope.bind_indeterminates()
        scope.define()
        listed = {name: scope.constraint(text) for name, text in constraints(scope)}
    forms = {
        name: -form if relation in ("<", "<=") else form
        for name, (form, relation) in listed.items()
        if relation != "==" and form.ring != BALL and form.shape[0] == form.shape[1]
    }
    for unknown, ((size, _), structure) in scope.unknown_shapes().items():
        if structure != "symmetric":
            continue
        places = {f"{unknown}_{i}_{j}": (i, j) for i, j in positions((size, size), structure)}
        pieces = [
            (name, start, part)
            for name, form in forms.items()
            for start in range(form.shape[0] - size + 1)
            if (part := _part(form, (start, start), size, places)) is not None
        ]
        positive = [(name, start) for name, start, part in pieces if _is_unknown(part)]
        for name, start in positive:
            keeps = {"unknown": unknown, "positive": name}
            U = _selected(forms[name].shape[0], start, size)
            for label, A, B, T in _inequalities(forms, pieces, positive, size, places):
                for S in _of_wrong_inertia(A, B):
                    z = np.linalg.eigh(S)[1][:, :1]
                    witness = {"drift": A, "inertia": S, "direction": z, "inequality": T, "positive": U}
                    yield {**keeps, "inequality": label}, witness if B is None else {**witness, "jump": B}


def _part(
    form: Matrix, corner: tuple[int, int], size: int, places: Mapping[str, tuple[int, int]]
) -> list[list[_Entry]] | None:
    """Linear part of a square part of a form, None where it holds other unknowns or powers."""
    rows: list[list[_Entry]] = []
    for i in range(corner[0], corner[0] + size):
        line = []
        for j in range(corner[1], corner[1] + size):
            entry = _linear(form.entry(i, j), places)
            if entry is None:
                return None
            line.append(entry)
        rows.append(line)
    return rows if any(any(line) for line in rows) else None


def _linear(entry: Any, places: Mapping[str, tuple[int, int]]) -> _Entry | None:
    if not isinstance(entry, fmpq_mpoly):
        return {}
    names, coefficients = entry.context().names(), {}
    for exponents, coefficient in entry.to_dict().items():
        used = [(names[k], int(power)) for k, power in enumerate(exponents) if power]
        if used and (len(used) > 1 or used[0][1] > 1 or used[0][0] not in places):
            return None
        if used:
            coefficients[places[used[0][0]]] = fraction_of(coefficient)
    return coefficients


def _is_unknown(part: list[list[_Entry]]) -> bool:
    """Whether the part is the unknown plus a constant."""
    return all(entry == {(min(i, j), max(i, j)): 1} for i, line in enumerate(part) for j, entry in enumerate(line))


def _inequalities(
    forms: Mapping[str, Matrix],
    pieces: Sequence[tuple[str, int, list[list[_Entry]]]],
    positive: Sequence[tuple[str, int]],
    size: int,
    places: Mapping[str, tuple[int, int]],
) -> Iterator[tuple[str, _Rows, _Rows | None, _Rows]]:
    """Label, A, B and congruence of what may be an inequality L(P) <= 0; the checker says whether it is."""
    half = _scaled_unit(Fraction(-1, 2), size)
    for label, start, part in pieces:
        rows = forms[label].shape[0]
        if (label, start) not in positive:
            yield label, _read_lyapunov(part, size), None, _selected(rows, start, size)
            for c in dict.fromkeys((Fraction(1), _read_radius(part, size))):
                B = _read_stein(part, size, c) if c else None
                if B is not None:
                    yield label, _scaled_unit(-c / 2, size), B, _selected(rows, start, size)
        elif (label, start + size) in positive:
            corner = _part(forms[label], (start, start + size), size, places)
            if corner is None:
                continue
            before, behind = _unit_rows(rows, start, size), _unit_rows(rows, start + size, size)
            # corner M P: the congruence with (I, -M') gives P - M P M'; corner P M: that with (-M, I)
            left = [[corner[i][j].get((j, j), Fraction(0)) for j in range(size)] for i in range(size)]
            right = [[corner[i][j].get((i, i), Fraction(0)) for j in range(size)] for i in range(size)]
            yield label, half, _transposed(left), _stacked(rows, before, behind, _transposed(left))
            yield label, half, right, _stacked(rows, behind, before, right)


def _scaled_unit(value: Fraction, size: int) -> _Rows:
    return [[value if i == j else Fraction(0) for j in range(size)] for i in range(size)]


def _transposed(rows: _Rows) -> _Rows:
    return [list(line) for line in zip(*rows, strict=True)]


def _unit_rows(rows: int, start: int, size: int) -> dict[int, int]:
    return {start + k: k for k in range(size)}


def _selected(rows: int, start: int, size: int) -> _Rows:
    """Columns of the unit matrix."""
    return [[Fraction(int(i - start == j)) for j in range(size)] for i in range(rows)]


def _stacked(rows: int, unit: Mapping[int, int], minus: Mapping[int, int], M: _Rows) -> _Rows:
    """A unit matrix in some rows and -M in others."""
    size = len(M)
    matrix = [[Fraction(0)] * size for _ in range(rows)]
    for row, k in unit.items():
        matrix[row][k] = Fraction(1)
    for row, k in minus.items():
        matrix[row] = [-x for x in M[k]]
    return matrix


def _read_lyapunov(part: list[list[_Entry]], size: int) -> _Rows:
    """Return A of a part -(A'P + P A), from the coefficients of the diagonal of P."""
    return [[-part[i][k].get((k, k), Fraction(0)) / (2 if i == k else 1) for i in range(size)] for k in range(size)]


def _read_radius(part: list[list[_Entry]], size: int) -> Fraction:
    """Return c of a part c P - B'P B whose B has a row with two entries; zero where it has none."""
    for k in range(size):
        for i in range(size):
            square = -part[i][i].get((k, k), Fraction(0))
            if i != k and square > 0:
                return part[k][k].get((k, k), Fraction(0)) + part[i][k].get((k, k), Fraction(0)) ** 2 / square
    return Fraction(0)


def _read_stein(part: list[list[_Entry]], size: int, c: Fraction) -> _Rows | None:
    """Return B of a part c P - B'P B: each row from its square, up to signs that the products of rows settle."""
    rows: _Rows = []
    for k in range(size):
        outer = [
            [(c if i == j == k else 0) - part[i][j].get((k, k), Fraction(0)) for j in range(size)] for i in range(size)
        ]
        lead = max(range(size), key=lambda i: outer[i][i])
        root = _root(outer[lead][lead])
        if root is None:
            return None
        rows.append([x / root if root else Fraction(0) for x in outer[lead]])
    for k in range(1, size):
        for earlier in range(k):
            both = [
                (i, j, rows[earlier][i] * rows[k][j] + rows[k][i] * rows[earlier][j])
                for i in range(size)
                for j in range(size)
            ]
            i, j, own = next((pair for pair in both if pair[2]), (0, 0, Fraction(0)))
            if own:
                # the coefficient of P[earlier, k] in entry (i, j) is that of c P less both products
                cross = (c if {i, j} == {earlier, k} else Fraction(0)) - part[i][j].get((earlier, k), Fraction(0))
                rows[k] = [-x for x in rows[k]] if cross == -own else rows[k]
                break
    return rows


def _root(value: Fraction) -> Fraction | None:
    """Square root of the square of a rational."""
    if value < 0:
        return None
    root = Fraction(isqrt(value.numerator), isqrt(value.denominator))
    return root if root**2 == value else None


def _of_wrong_inertia(A: _Rows, B: _Rows | None) -> Iterator[np.ndarray]:
    """Symmetric matrices that are not positive and for which L may be negative."""
    if B is None:
        yield from candidates(np.array(A, dtype=float), "Lyapunov")
    else:  # L(X) = B'X B - c X, A = -c/2 I
        yield from candidates(np.array(B, dtype=float) / np.sqrt(float(-2 * A[0][0])), "Stein")
