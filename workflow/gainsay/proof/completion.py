"""From floats to exact witnesses: rounding, and completion to an exact solution of the equations that must hold."""

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any

from flint import fmpq, fmpq_mpoly

from gainsay.errors import CertificateError
from gainsay.exact.ball import precision
from gainsay.exact.linear import Unsolvable, complete
from gainsay.exact.matrix import BALL, Matrix
from gainsay.exact.rational import float_rows, shorten, to_fmpq, to_text
from gainsay.proof.certificate import Certificate
from gainsay.proof.duality import constraints, greatest_over_boxes, inner, unknown_boxes
from gainsay.proof.scope import Scope, has_structure, positions

__all__ = ["cancelling", "has_floats", "listed", "on_equations", "rounded", "texts"]


def listed(values: Any) -> list[list[Any]]:
    """Nested lists of an array, a matrix, a vector (a column) or a number."""
    if isinstance(values, Matrix):
        return values.rows()
    plain = values.tolist() if hasattr(values, "tolist") else values
    if isinstance(plain, str | int | float | Fraction | fmpq):
        return [[plain]]
    rows = [list(row) if isinstance(row, Sequence) and not isinstance(row, str) else [row] for row in plain]
    return [[x.item() if hasattr(x, "item") else x for x in row] for row in rows]


def has_floats(rows: list[list[Any]]) -> bool:
    """Whether any entry is a float, and so to be rounded."""
    return any(isinstance(x, float) for row in rows for x in row)


def rounded(rows: list[list[Any]], digits: int, structure: str = "full") -> list[list[fmpq]]:
    """Rows with floats rounded to so many significant digits, of exactly that structure; exact entries stay."""
    if not has_floats(rows):
        return [[to_fmpq(x) for x in row] for row in rows]
    floats = float_rows([[float(x) for x in row] for row in rows])
    if structure in ("symmetric", "skew"):
        sign = 1 if structure == "symmetric" else -1
        floats = [[(floats[i][j] + sign * floats[j][i]) / 2 for j in range(len(floats))] for i in range(len(floats))]
    if structure == "diagonal":
        floats = [[x if i == j else 0.0 for j, x in enumerate(row)] for i, row in enumerate(floats)]
    return [[to_fmpq(shorten(x, digits)) for x in row] for row in floats]


def texts(rows: Any) -> list[list[str]]:
    """Exact texts of the entries."""
    return [[to_text(x) for x in row] for row in rows]


def on_equations(frame: Certificate, tables: Any, near: Mapping[str, list[list[fmpq]]]) -> dict[str, Any]:
    """Values of the unknowns near the given ones that satisfy every equation among the constraints."""
    equal = [(name, text) for name, text in constraints(Scope(frame, tables)) if "==" in text]
    if not equal:
        return dict(near)
    with precision(frame.precision):
        scope = Scope(frame, tables)
        scope.bind_indeterminates()
        scope.define()
        forms = [scope.constraint(text)[0] for _, text in equal]
    shapes = scope.unknown_shapes()
    places = {f"{n}_{i}_{j}": (n, i, j) for n, (shape, kind) in shapes.items() for i, j in positions(shape, kind)}
    names = list(places)
    index = {name: k for k, name in enumerate(names)}
    equations = []
    for form in forms:
        for entry in (x for row in form.rows() for x in row):
            if isinstance(entry, fmpq_mpoly):
                parts, right = _affine(entry, frame.id)
                equations.append(({index[n]: c for n, c in parts.items()}, -right))
    values = [near[n][i][j] for n, i, j in places.values()]
    scales = [max(abs(_approximate(v)), 1e-300) for v in values]
    try:
        solved = complete(equations, values, scales)
    except Unsolvable as error:
        raise CertificateError(f"{frame.id}: {error}") from error
    result = {n: [list(row) for row in rows] for n, rows in near.items()}
    for (n, i, j), value in zip(places.values(), solved, strict=True):
        result[n][i][j] = value
        if shapes[n][1] in ("symmetric", "skew") and i != j:
            result[n][j][i] = value if shapes[n][1] == "symmetric" else -value
    for n, rows in result.items():
        assert has_structure(Matrix.of(rows), shapes[n][1])
    return result


def _approximate(value: fmpq) -> float:
    return int(value.p) / int(value.q)


def _affine(entry: fmpq_mpoly, owner: str) -> tuple[dict[str, fmpq], fmpq]:
    variables = entry.context().names()
    parts: dict[str, fmpq] = {}
    constant = fmpq(0)
    for exponents, coefficient in entry.to_dict().items():
        used = [variables[k] for k, power in enumerate(exponents) for _ in range(int(power))]
        if not used:
            constant = coefficient
        elif len(used) == 1:
            parts[used[0]] = coefficient
        else:
            raise CertificateError(f"{owner}: an equation is not affine in the unknowns ({'*'.join(used)})")
    return parts, constant


def _terms(entry: Any) -> dict[tuple[tuple[str, int], ...], fmpq]:
    """Monomials of a polynomial or a rational with their coefficients."""
    if isinstance(entry, fmpq):
        return {(): entry} if entry != 0 else {}
    variables = entry.context().names()
    return {
        tuple((variables[k], int(p)) for k, p in enumerate(exponents) if p): coefficient
        for exponents, coefficient in entry.to_dict().items()
    }


def cancelling(
    frame: Certificate, tables: Any, raw: Mapping[str, list[list[Any]]], digits: int, objective: str = ""
) -> tuple[dict[str, Any], Fraction]:
    """Rounded multipliers completed so that no unknown outside the boxes is left in the weighted sum.

    Returns
    -------
    tuple of (multipliers, largest value over the boxes of the weighted sum minus the objective's part)
    """
    with precision(frame.precision):
        scope = Scope(frame, tables)
        scope.bind_indeterminates()
        scope.define()
        boxes = unknown_boxes(scope)
        forms: dict[str, tuple[Matrix, str]] = {}
        for name, text in constraints(scope):
            if name in raw:
                form, relation = scope.constraint(text)
                if form.ring == BALL:
                    raise scope.fail(f"constraint {name!r} is not exact: multipliers need rational data")
                form = -form if relation in ("<", "<=") else form
                if name in frame.fields.get("congruences", {}):
                    factor = scope.evaluate(frame.fields["congruences"][name])
                    form = factor.T @ form @ factor
                forms[name] = (form, relation)
        for name in raw:
            if name not in forms:
                raise scope.fail(f"multiplier {name!r} of no constraint")
        slack = Matrix.number(0)
        if objective:
            value = scope.evaluate(frame.fields[objective])
            slack = value if objective == "minimise" else -value
        places: list[tuple[str, int, int]] = []
        values: list[fmpq] = []
        scales: list[float] = []
        equations: dict[tuple, tuple[dict[int, fmpq], fmpq]] = {}

        def boxed(monomial: tuple[tuple[str, int], ...]) -> bool:
            return len(monomial) == 1 and monomial[0][1] == 1 and monomial[0][0] in boxes

        for monomial, coefficient in _terms(slack.entry(0, 0)).items():
            if monomial and not boxed(monomial):
                equations[monomial] = ({}, coefficient)
        near: dict[str, list[list[fmpq]]] = {}
        for name, (form, relation) in forms.items():
            structure = "full" if relation == "==" or form.shape[0] != form.shape[1] else "symmetric"
            rows = near[name] = rounded(raw[name], digits, structure)
            if Matrix.of(rows).shape != form.shape:
                raise scope.fail(f"multiplier {name!r} has shape {Matrix.of(rows).shape}, expected {form.shape}")
            entries = form.rows()
            for i, j in positions(form.shape, structure):
                index = len(places)
                places.append((name, i, j))
                values.append(rows[i][j])
                size = abs(_approximate(rows[i][j]))
                if structure == "symmetric":
                    size = abs(_approximate(rows[i][i]) * _approximate(rows[j][j])) ** 0.5
                scales.append(max(size, 1e-300))
                terms = _terms(entries[i][j])
                if structure == "symmetric" and i != j:
                    terms = {m: 2 * c for m, c in terms.items()}
                for monomial, coefficient in terms.items():
                    if monomial and not boxed(monomial):
                        equations.setdefault(monomial, ({}, fmpq(0)))[0][index] = coefficient
        try:
            solved = complete(list(equations.values()), values, scales)
        except Unsolvable as error:
            raise scope.fail(f"no multipliers make the unknowns cancel ({error})") from error
        total = -slack
        for (name, i, j), completed in zip(places, solved, strict=True):
            near[name][i][j] = completed
            if forms[name][1] != "==" and i != j and forms[name][0].shape[0] == forms[name][0].shape[1]:
                near[name][j][i] = completed
        for name, (form, _) in forms.items():
            total = total + inner(Matrix.of(near[name]), form)
        return near, greatest_over_boxes(scope, total, boxes)
