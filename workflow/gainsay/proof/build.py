"""Builders: from floats that a solver returned to a certificate that the checker has accepted.

A witness of floats is rounded to short decimals, more digits being tried until the check passes; where it must satisfy
linear equations exactly (a Farkas proof, a dual bound, an equation among constraints) the rounded numbers are completed
to an exact solution. What cannot be certified raises; nothing is returned unchecked.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

from gainsay.errors import CertificateError
from gainsay.exact.ball import decimal_above, decimal_below
from gainsay.exact.rational import to_text
from gainsay.proof import checker
from gainsay.proof.certificate import ON_FAITH, Certificate, Conclusion
from gainsay.proof.completion import cancelling, has_floats, listed, on_equations, rounded, texts

__all__ = [
    "DIGITS",
    "accepted",
    "certificate",
    "dual_bound",
    "farkas",
    "feasible_point",
    "finish",
    "frame",
    "id_of",
    "one_line",
]

DIGITS = (6, 9, 12, 15, 17)
_accepted: set[tuple[str, str]] = set()
_SYMMETRIC, _SKEW = ("P", "S", "D"), ("G",)


def finish(draft: Certificate, tables: Any, quantities: Mapping[str, str] | None = None) -> Certificate:
    """Fill in the data and the conclusions of a draft, and check it.

    Parameters
    ----------
    draft : Certificate
        Its data are ignored; its conclusions are kept, those of `quantities` are added.
    tables : gainsay.tables.Case or any `gainsay.proof.scope.Tables`
        Their name is the paper's.
    quantities : mapping, optional
        From what the kind proves something about ("norm", "feasible", ...) to ids of quantities. Where there are no
        conclusions at all, everything proved is concluded of the formulas themselves, under no quantity.

    Returns
    -------
    Certificate
        Accepted by the checker.

    Raises
    ------
    CertificateError
        If it is refused.
    """
    draft = draft.changed(
        definitions=tuple((name, one_line(text)) for name, text in draft.definitions), fields=one_line(draft.fields)
    )
    # the proof is made of what a file of it would hold, once
    draft = Certificate.from_json(draft.to_json(compact=True), draft.id)
    proofs, data = checker.proved(draft, tables)
    conclusions = list(draft.conclusions)
    for of, quantity in (quantities or {}).items():
        about = [p for p in proofs if p.of == of]
        if not about:
            known = ", ".join(sorted({p.of for p in proofs}))
            raise CertificateError(
                f"{draft.id}: kind {draft.kind} proves nothing about {of!r} here (but about {known})"
            )
        conclusions += [Conclusion(quantity, p.relation, p.value, of) for p in about]
    if not conclusions:  # about the formulas themselves
        conclusions = [Conclusion("", p.relation, p.value, p.of) for p in proofs]
    done = Certificate.from_json(
        draft.changed(data=data, conclusions=tuple(dict.fromkeys(conclusions))).to_json(compact=True), draft.id
    )
    checker.concluded(done, tables, proofs, data)
    _accepted.add((done.paper, done.digest()))
    return done


def accepted(certificate: Certificate) -> bool:
    """Whether a builder of this process has had the checker accept this very certificate: it need not do so twice."""
    return (certificate.paper, certificate.digest()) in _accepted


def id_of(quantity: str) -> str:
    """Id of a certificate that has none of its own: that of its quantity, with dashes."""
    return quantity.replace(".", "-").replace("_", "-")


def certificate(
    kind: str,
    *,
    statement: str,
    id: str = "",
    tables: Any,
    fields: Mapping[str, Any],
    definitions: Iterable[tuple[str, str]] | Mapping[str, str] = (),
    unknowns: Mapping[str, Mapping[str, Any]] | None = None,
    witness: Mapping[str, Any] | None = None,
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
    statement, definitions, unknowns, fields, faith, precision
        As in the certificate; definitions as pairs or a mapping in order.
    id : str, optional
        By default that of the first of `quantities`, with dashes.
    tables : gainsay.tables.Case or any `gainsay.proof.scope.Tables`
        Their name is the paper's.
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
    id = id or id_of(next(iter((quantities or {}).values()), ""))
    if not id:
        raise CertificateError(f"a certificate of kind {kind} without a quantity needs an id")
    structures = {name: raw.get("structure", "full") for name, raw in (unknowns or {}).items()}
    for name in witness or {}:
        stem = name.rstrip("0123456789")
        structures.setdefault(name, "symmetric" if stem in _SYMMETRIC else "skew" if stem in _SKEW else "full")
    raw = {name: _listed(id, name, values) for name, values in (witness or {}).items()}
    rounds = digits if any(has_floats(rows) for rows in raw.values()) else digits[:1]
    draft = Certificate(
        id=id,
        paper=tables.name,
        statement=statement,
        kind=kind,
        fields=fields,
        definitions=_pairs(definitions),
        unknowns=unknowns or {},
        faith=(*ON_FAITH, *faith),
        precision=precision,
    )

    def attempt(count: int) -> Certificate:
        exact = {name: _exact(id, name, rows, count, structures[name]) for name, rows in raw.items()}
        return finish(draft.changed(witness=exact), tables, quantities)

    return _first(attempt, rounds)


def _listed(id: str, name: str, values: Any) -> list[list[Any]]:
    try:
        return listed(values)
    except TypeError as error:
        raise CertificateError(f"{id}: witness {name!r}: {type(values).__name__} is no matrix") from error


def _exact(id: str, name: str, rows: list[list[Any]], digits: int, structure: str) -> list[list[str]]:
    try:
        return texts(rounded(rows, digits, structure))
    except (TypeError, ValueError, IndexError) as error:
        raise CertificateError(f"{id}: witness {name!r}: {error}") from error


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
    raw = {name: listed(values) for name, values in point.items()}
    draft = frame("feasible", tables, parts)

    def attempt(count: int) -> Certificate:
        near = {n: rounded(rows, count, unknowns[n].get("structure", "full")) for n, rows in raw.items()}
        solved = on_equations(draft, tables, near)
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
    draft = frame("farkas", tables, parts)
    raw = {name: listed(values) for name, values in multipliers.items()}

    def attempt(count: int) -> Certificate:
        solved, _ = cancelling(draft, tables, raw, count)
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
    raw = {name: listed(values) for name, values in multipliers.items()}
    minimise = "minimise" in parts["fields"]
    draft = frame("dual_bound", tables, {**parts, "fields": {**parts["fields"], "bound": "0"}})

    def attempt(count: int) -> Certificate:
        solved, slack = cancelling(draft, tables, raw, count, "minimise" if minimise else "maximise")
        bound = decimal_below(-slack, bound_digits) if minimise else decimal_above(slack, bound_digits)
        whole = {**parts, "fields": {**parts["fields"], "bound": to_text(bound)}}
        return certificate("dual_bound", tables=tables, witness=solved, digits=(count,), **whole)

    return _first(attempt, digits)


def one_line(value: Any) -> Any:
    """Texts without line breaks: sources break formulas over lines, certificates hold them in one."""
    if isinstance(value, str):
        return " ".join(value.split())
    if isinstance(value, Mapping):
        return {key: one_line(inner) for key, inner in value.items()}
    return [one_line(inner) for inner in value] if isinstance(value, list | tuple) else value


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
    pairs = definitions.items() if isinstance(definitions, Mapping) else definitions
    return tuple((name, text) for name, text in pairs)


def frame(kind: str, tables: Any, parts: Mapping[str, Any]) -> Certificate:
    """Certificate of that kind and these parts, without witness and conclusions: to evaluate its formulas in."""
    return Certificate(
        id=parts["id"],
        paper=tables.name,
        statement=parts["statement"],
        kind=kind,
        fields=parts["fields"],
        definitions=_pairs(parts.get("definitions", ())),
        unknowns=parts.get("unknowns") or {},
        precision=parts.get("precision", 128),
    )
