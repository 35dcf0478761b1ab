"""Builders: from floats that a solver returned to a certificate that the checker has accepted.

A witness of floats is rounded to short decimals, more digits being tried until the check passes; where it must satisfy
linear equations exactly (a Farkas proof, a dual bound, an equation among constraints) the rounded numbers are completed
to an exact solution. What cannot be certified raises; nothing is returned unchecked.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from fractions import Fraction
from typing import Any

from flint import fmpq, fmpq_mpoly

from gainsay.errors import CertificateError
from gainsay.exact.ball import decimal_above, decimal_below, precision
from gainsay.exact.linear import Unsolvable, complete
from gainsay.exact.matrix import BALL, Matrix
from gainsay.exact.rational import float_rows, shorten, to_fmpq, to_text
from gainsay.proof import checker
from gainsay.proof.certificate import ON_FAITH, Certificate, Conclusion
from gainsay.proof.duality import constraints
from gainsay.proof.scope import Scope, has_structure, positions

__all__ = ["DIGITS", "certificate", "dual_bound", "farkas", "feasible_point", "finish"]

DIGITS = (6, 9, 12, 15, 17)
_SYMMETRIC, _SKEW = ("P", "S", "D"), ("G",)


def finish(draft: Certificate, tables: Any, quantities: Mapping[str, str] | None = None) -> Certificate:
    """Fill in the data and the conclusions of a draft, and check it.

    Parameters
    ----------
    draft : Certificate
        Its data are ignored; its conclusions are kept, those of `quantities` are added.
    tables : gainsay.tables.Case or any `gainsay.proof.scope.Tables`
    quantities : mapping, optional
        From what the kind proves something about ("norm", "feasible", ...) to ids of quantities.

    Returns
    -------
    Certificate
        Accepted by the checker.

    Raises
    ------
    CertificateError
        If it is refused.
    """
    found, data = checker.proved(draft, tables)
    listed = list(draft.conclusions)
    for of, quantity in (quantities or {}).items():
        about = [p for p in found if p.of == of]
        if not about:
            known = ", ".join(sorted({p.of for p in found}))
            raise CertificateError(
                f"{draft.id}: kind {draft.kind} proves nothing about {of!r} here (but about {known})"
            )
        listed += [Conclusion(quantity, p.relation, p.value, of) for p in about]
    done = Certificate.from_json(draft.changed(data=data, conclusions=tuple(dict.fromkeys(listed))).to_json(), draft.id)
    checker.check(done, tables)
    return done


def certificate(
    kind: str,
    *,
    id: str,
    paper: str,
    statement: str,
    tables: Any,
    fields: Mapping[str, Any],
    definitions: Iterable[tuple[str, str]] | Mapping[str, str] = (),
    unknowns: Mapping[str, Mapping[str, Any]] | None = None,
    witness: Mapping[str, Any] | None = None,
    claims: Sequence[str] = (),
    quantities: Mapping[str, str] | None = None,
    faith: Sequence[str] = (),
    precision: int = 128,
    digits: Sequence[int] = DIGITS,
) -> Certificate:
    """Certificate of any kind, checked.

    Parameters
    ----------
    kind : str
        Module of `gainsay.proof.kinds`.
    id, paper, statement, claims, definitions, unknowns, fields, faith, precision
        As in the certificate; definitions as pairs or a mapping in order.
    tables : gainsay.tables.Case or any `gainsay.proof.scope.Tables`
    witness : mapping of str to array_like
        Floats are rounded to each of `digits` in turn until the check passes; texts and fractions stay as they are.
        Unknowns follow their structure; of the others ``P``, ``S``, ``D1``, ... are made symmetric, ``G1``, ... skew.
    quantities : mapping
        As in `finish`.

    Raises
    ------
    CertificateError
        If it is refused with every number of digits; the last refusal.
    """
    structures = {name: raw.get("structure", "full") for name, raw in (unknowns or {}).items()}
    for name in witness or {}:
        stem = name.rstrip("0123456789")
        structures.setdefault(name, "symmetric" if stem in _SYMMETRIC else "skew" if stem in _SKEW else "full")
    raw = {name: _listed(values) for name, values in (witness or {}).items()}
    rounds = digits if any(_has_floats(rows) for rows in raw.values()) else digits[:1]
    draft = Certificate(
        id=id,
        paper=paper,
        statement=statement,
        kind=kind,
        fields=fields,
        definitions=_pairs(definitions),
        unknowns=unknowns or {},
        claims=tuple(claims),
        faith=(*ON_FAITH, *faith),
        precision=precision,
    )

    def attempt(count: int) -> Certificate:
        texts = {name: _texts(rounded(rows, count, structures[name])) for name, rows in raw.items()}
        return finish(draft.changed(witness=texts), tables, quantities)

    return _first(attempt, rounds)


def feasible_point(
    *, tables: Any, point: Mapping[str, Any], digits: Sequence[int] = DIGITS, **parts: Any
) -> Certificate:
    """Certificate of kind ``feasible``; equations among the constraints are satisfied exactly.

    Parameters
    ----------
    point : mapping of str to array_like
        Value of every unknown.
    tables, digits, and everything else
        As for `certificate`; `fields` holds the constraints.

    Raises
    ------
    CertificateError
        If it is refused with every number of digits, or its equations contradict each other.
    """
    unknowns = parts["unknowns"]
    raw = {name: _listed(values) for name, values in point.items()}
    frame = _frame("feasible", parts)

    def attempt(count: int) -> Certificate:
        near = {n: rounded(rows, count, unknowns[n].get("structure", "full")) for n, rows in raw.items()}
        solved = _on_equations(frame, tables, near)
        return certificate("feasible", tables=tables, witness=solved, digits=(count,), **parts)

    return _first(attempt, digits)


def farkas(*, tables: Any, multipliers: Mapping[str, Any], digits: Sequence[int] = DIGITS, **parts: Any) -> Certificate:
    """Certificate of kind ``farkas``: rounded multipliers are completed so that every unknown cancels exactly.

    Parameters
    ----------
    multipliers : mapping of constraint name to array_like
        Multipliers Z_k >= 0 of the constraints F_k > 0 (of -F_k where the constraint reads F_k < 0), with some room
        inside the cone; constraints left out have none.
    tables, digits, and everything else
        As for `certificate`; `fields` holds the constraints.

    Raises
    ------
    CertificateError
        If it is refused with every number of digits.
    """
    frame = _frame("farkas", parts)
    raw = {name: _listed(values) for name, values in multipliers.items()}

    def attempt(count: int) -> Certificate:
        solved, _ = _cancelling(frame, tables, raw, count)
        return certificate("farkas", tables=tables, witness=solved, digits=(count,), **parts)

    return _first(attempt, digits)


def dual_bound(
    *,
    tables: Any,
    multipliers: Mapping[str, Any],
    digits: Sequence[int] = DIGITS,
    bound_digits: int = 12,
    **parts: Any,
) -> Certificate:
    """Certificate of kind ``dual_bound`` with the best bound that the completed multipliers prove.

    Parameters
    ----------
    multipliers : mapping of constraint name to array_like
        As for `farkas`; the sum of <Z_k, F_k> has the linear part of the objective (``minimise``) or of its negative.
    bound_digits : int
        Significant digits of the bound, rounded to the safe side.
    tables, digits, and everything else
        As for `certificate`; `fields` holds the constraints and ``minimise`` or ``maximise``, no bound.
    """
    raw = {name: _listed(values) for name, values in multipliers.items()}
    minimise = "minimise" in parts["fields"]
    frame = _frame("dual_bound", {**parts, "fields": {**parts["fields"], "bound": "0"}})

    def attempt(count: int) -> Certificate:
        solved, slack = _cancelling(frame, tables, raw, count, "minimise" if minimise else "maximise")
        bound = decimal_below(-slack, bound_digits) if minimise else decimal_above(slack, bound_digits)
        whole = {**parts, "fields": {**parts["fields"], "bound": to_text(bound)}}
        return certificate("dual_bound", tables=tables, witness=solved, digits=(count,), **whole)

    return _first(attempt, digits)


def _first(attempt: Callable[[int], Certificate], digits: Sequence[int]) -> Certificate:
    last: CertificateError | None = None
    for count in digits:
        try:
            return attempt(count)
        except CertificateError as error:
            last = error
    assert last is not None
    raise last


def _pairs(definitions: Iterable[tuple[str, str]] | Mapping[str, str]) -> tuple[tuple[str, str], ...]:
    listed = definitions.items() if isinstance(definitions, Mapping) else definitions
    return tuple((name, text) for name, text in listed)


def _frame(kind: str, parts: Mapping[str, Any]) -> Certificate:
    return Certificate(
        id=parts["id"],
        paper=parts["paper"],
        statement=parts["statement"],
        kind=kind,
        fields=parts["fields"],
        definitions=_pairs(parts.get("definitions", ())),
        unknowns=parts.get("unknowns") or {},
        precision=parts.get("precision", 128),
    )


def _listed(values: Any) -> list[list[Any]]:
    if isinstance(values, Matrix):
        return values.rows()
    listed = values.tolist() if hasattr(values, "tolist") else values
    if isinstance(listed, str | int | float | Fraction | fmpq):
        return [[listed]]
    rows = [list(row) if isinstance(row, Sequence) and not isinstance(row, str) else [row] for row in listed]
    return [[x.item() if hasattr(x, "item") else x for x in row] for row in rows]


def _has_floats(rows: list[list[Any]]) -> bool:
    return any(isinstance(x, float) for row in rows for x in row)


def rounded(rows: list[list[Any]], digits: int, structure: str = "full") -> list[list[fmpq]]:
    """Rows with floats rounded to so many significant digits, of exactly that structure; exact entries stay."""
    if not _has_floats(rows):
        return [[to_fmpq(x) for x in row] for row in rows]
    floats = float_rows([[float(x) for x in row] for row in rows])
    if structure in ("symmetric", "skew"):
        sign = 1 if structure == "symmetric" else -1
        floats = [[(floats[i][j] + sign * floats[j][i]) / 2 for j in range(len(floats))] for i in range(len(floats))]
    if structure == "diagonal":
        floats = [[x if i == j else 0.0 for j, x in enumerate(row)] for i, row in enumerate(floats)]
    return [[to_fmpq(shorten(x, digits)) for x in row] for row in floats]


def _texts(rows: Any) -> list[list[str]]:
    return [[to_text(x) for x in row] for row in rows]


def _on_equations(frame: Certificate, tables: Any, near: Mapping[str, list[list[fmpq]]]) -> dict[str, Any]:
    """Values of the unknowns near the given ones that satisfy every equation among the constraints."""
    listed = [(name, text) for name, text in constraints(Scope(frame, tables)) if "==" in text]
    if not listed:
        return dict(near)
    with precision(frame.precision):
        scope = Scope(frame, tables)
        scope.bind_indeterminates()
        scope.define()
        forms = [scope.constraint(text)[0] for _, text in listed]
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


def _cancelling(
    frame: Certificate, tables: Any, raw: Mapping[str, list[list[Any]]], digits: int, objective: str = ""
) -> tuple[dict[str, Any], Fraction]:
    """Rounded multipliers completed so that no unknown outside the boxes is left in the weighted sum.

    Returns
    -------
    tuple of (multipliers, largest value over the boxes of the weighted sum minus the objective's part)
    """
    from gainsay.proof.duality import greatest_over_boxes, inner, unknown_boxes

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
        for (name, i, j), value in zip(places, solved, strict=True):
            near[name][i][j] = value
            if forms[name][1] != "==" and i != j and forms[name][0].shape[0] == forms[name][0].shape[1]:
                near[name][j][i] = value
        for name, (form, _) in forms.items():
            total = total + inner(Matrix.of(near[name]), form)
        return near, greatest_over_boxes(scope, total, boxes)
