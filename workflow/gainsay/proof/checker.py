"""The independent checker: evaluates a certificate from the tables alone, and says what it proved.

It imports python-flint and nothing that the certificates were found with.
"""

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any

from gainsay.errors import CertificateError, GainsayError
from gainsay.exact.ball import precision
from gainsay.exact.budget import budget
from gainsay.exact.rational import exact
from gainsay.proof import kinds
from gainsay.proof.certificate import LARGEST_FILE, ON_FAITH, Certificate, Conclusion
from gainsay.proof.kinds import Proved
from gainsay.proof.scope import CaseTables, Scope, adapted
from gainsay.proof.stated import by_ends

__all__ = ["CaseTables", "Proof", "check", "check_file", "prepare", "proved", "read_certificate"]


#: what no check covers where a formula reads an end of a plausible range
BETWEEN_ENDS = (
    "That what it concludes for every plausible value of {0!r} follows from what its formulas read of the ends."
)
#: work that one check may take, in units of `gainsay.exact.budget`: four times what the largest of the papers' takes
WORK = 5e9


@dataclass(frozen=True)
class Proof:
    """What an accepted certificate proves.

    Attributes
    ----------
    id, paper, statement, kind : str
        As in the certificate; that the statement says what the conclusions say is on faith.
    theorem : str
        What the conclusions rest on.
    proved : tuple of Proved
        What the kind of proof gives.
    conclusions : tuple of Conclusion
        What follows for quantities, with exact values.
    formulas : tuple of (str, str)
        Everything that it is about: unknowns, definitions and the kind's fields, each a name and a text.
    faith : tuple of str
        What no check covers.
    """

    id: str
    paper: str
    statement: str
    kind: str
    theorem: str
    proved: tuple[Proved, ...]
    conclusions: tuple[Conclusion, ...]
    formulas: tuple[tuple[str, str], ...]
    faith: tuple[str, ...]


def prepare(certificate: Certificate, tables: Any) -> tuple[Scope, Any]:
    """Scope of a certificate and the module of its kind, its fields checked by name."""
    try:
        kind = kinds.load(certificate.kind)
    except CertificateError as error:
        raise CertificateError(f"{certificate.id}: {error}") from error
    for name in kind.REQUIRED:
        if name not in certificate.fields:
            raise CertificateError(f"{certificate.id}: field {name!r} is missing")
    for name in certificate.fields:
        if name not in (*kind.REQUIRED, *kind.OPTIONAL):
            raise CertificateError(f"{certificate.id}: unknown field {name!r} of kind {certificate.kind}")
    return Scope(certificate, tables), kind


def proved(certificate: Certificate, tables: Any) -> tuple[list[Proved], dict[str, Any]]:
    """What the kind's theorem gives, and the data that were read on the way; conclusions are not looked at."""
    with precision(certificate.precision), budget(WORK):
        scope, kind = prepare(certificate, tables)
        try:
            return kind.prove(scope), scope.reader.data
        except (ValueError, ArithmeticError) as error:
            raise error if isinstance(error, GainsayError) else scope.fail(error) from error


def _same_data(certificate: Certificate, tables: Any) -> None:
    """Refuse data that are not the tables', naming the entry."""
    scope, _ = prepare(certificate, tables)
    reader = scope.reader
    read = {
        "number": reader.number,
        "plausible": reader.plausible,
        "printed": reader.printed,
        "half_units": reader.half_units,
        "design": lambda name: reader.design(*name.split(".", 1)),
    }
    for group, entries in certificate.data.items():
        if group not in read or not isinstance(entries, dict):
            raise scope.fail(f"data: unknown group {group!r}")
        for name, stored in entries.items():
            if group == "design" and "." not in name:
                raise scope.fail(f"data: {name!r} is not a design and entry")
            read[group](name)
            now = reader.data.get(group, {}).get(name)
            if now is not None and now != stored:
                raise scope.fail(f"{group} {name!r} is {_difference(stored, now)} than in the tables")


def _difference(stored: Any, now: Any) -> str:
    if isinstance(stored, str) and isinstance(now, str):
        return f"{stored} and not {now}: other"
    if isinstance(stored, list) and isinstance(now, list) and len(stored) == len(now):
        for i, (a, b) in enumerate(zip(stored, now, strict=True)):
            for j, (x, y) in enumerate(zip(a, b, strict=False)):
                if x != y:
                    return f"at row {i + 1}, column {j + 1} {x} and not {y}: other"
    return "other"


def _complete(stored: dict[str, Any], read: dict[str, Any], owner: str) -> None:
    for group, entries in read.items():
        for name in entries:
            if name not in stored.get(group, {}):
                raise CertificateError(f"{owner}: the formulas read {group} {name!r}, which is not among its data")
    for group, entries in stored.items():
        for name in entries:
            if name not in read.get(group, {}):
                raise CertificateError(f"{owner}: data hold {group} {name!r}, which no formula reads")


def implied(proofs: Sequence[Proved], conclusion: Conclusion) -> bool:
    """Whether what was proved implies a conclusion."""
    about = [p for p in proofs if p.of == conclusion.of]
    if conclusion.relation in ("holds", "fails"):
        return conclusion.value is None and any(p.relation == conclusion.relation for p in about)
    if conclusion.value is None:
        return False
    if conclusion.relation == "inside":
        low, high = ends(conclusion.value)
        below = Conclusion(conclusion.quantity, "at_least", str(low), conclusion.of)
        return implied(proofs, below) and implied(
            proofs, Conclusion(conclusion.quantity, "at_most", str(high), conclusion.of)
        )
    value = exact(conclusion.value)
    above = conclusion.relation in ("at_most", "less_than")
    strict = conclusion.relation in ("less_than", "greater_than")
    for p in about:
        if p.value is None:
            continue
        if p.relation == "inside":
            bound, is_strict = ends(p.value)[1 if above else 0], False
        elif p.relation in (("at_most", "less_than") if above else ("at_least", "greater_than")):
            bound, is_strict = exact(p.value), p.relation in ("less_than", "greater_than")
        else:
            continue
        if (bound < value if above else bound > value) or (bound == value and (is_strict or not strict)):
            return True
    return False


def ends(value: str) -> tuple[Fraction, Fraction]:
    """Ends of an interval written ``low..high``."""
    low, separator, high = value.partition("..")
    if not separator:
        raise ValueError(f"{value!r} is not an interval low..high")
    return exact(low), exact(high)


def check(certificate: Certificate, tables: Any) -> Proof:
    """Check a certificate against tables.

    Parameters
    ----------
    certificate : Certificate
    tables : gainsay.tables.Case or any `gainsay.proof.scope.Tables`

    Returns
    -------
    Proof

    Raises
    ------
    CertificateError
        In one line, with the certificate's id, what does not match or is not proved.
    """
    try:
        with budget(WORK):
            return _check(certificate.validated(), tables)
    except GainsayError:
        raise
    except Exception as error:  # whatever a check stumbles over, memory and recursion too, it has not accepted it
        raise CertificateError(
            f"{certificate.id}: malformed ({type(error).__name__}: {error})".replace("\n", " ")[:300]
        ) from error


def concluded(certificate: Certificate, tables: Any, proofs: Sequence[Proved], read: dict[str, Any]) -> Proof:
    """What follows from what `proved` has just found and read of the same certificate: it is not proved twice."""
    return _check(certificate, tables, (proofs, read))


def _check(
    certificate: Certificate, tables: Any, known: tuple[Sequence[Proved], dict[str, Any]] | None = None
) -> Proof:
    owner = certificate.id
    if tables.name != certificate.paper:
        raise CertificateError(
            f"{owner}: a certificate of {certificate.paper!r}, checked against the tables of {tables.name!r}"
        )
    if not certificate.conclusions:
        raise CertificateError(f"{owner}: a certificate without a conclusion proves nothing")
    if known is None:
        _same_data(certificate, tables)
        known = proved(certificate, tables)
    proofs, read = known
    _complete(dict(certificate.data), read, owner)
    reader = adapted(tables)
    for conclusion in certificate.conclusions:
        try:
            follows = implied(proofs, conclusion)
        except ValueError as error:
            raise CertificateError(f"{owner}: conclusion on {conclusion.quantity!r}: {error}") from error
        if not follows:
            given = "; ".join(f"{p.of} {p.relation} {p.value or ''}".strip()[:200] for p in proofs)
            raise CertificateError(
                f"{owner}: {conclusion.of or '?'} {conclusion.relation} {conclusion.value or ''} "
                f"of {conclusion.quantity!r} does not follow from what was proved ({given})"
            )
        if conclusion.quantity and hasattr(reader, "has_quantity") and not reader.has_quantity(conclusion.quantity):
            raise CertificateError(f"{owner}: quantity {conclusion.quantity!r} is not declared in quantities.csv")
        if conclusion.quantity and hasattr(reader, "requirements"):
            _same_requirements(certificate, conclusion.quantity, reader.requirements(conclusion.quantity))
    kind = kinds.load(certificate.kind)
    ends = tuple(BETWEEN_ENDS.format(name) for name in sorted(by_ends(certificate)))
    faith = tuple(dict.fromkeys((*ON_FAITH, *getattr(kind, "FAITH", ()), *certificate.faith, *ends)))
    return Proof(
        id=owner,
        paper=certificate.paper,
        statement=certificate.statement,
        kind=certificate.kind,
        theorem=kind.THEOREM,
        proved=tuple(proofs),
        conclusions=tuple(certificate.conclusions),
        formulas=tuple(_formulas(certificate)),
        faith=faith,
    )


def _same_requirements(certificate: Certificate, quantity: str, wanted: frozenset[str]) -> None:
    """Refuse a certificate that meets other requirements than those a quantity is a level of."""
    of_kind = getattr(kinds.load(certificate.kind), "requirements", None)
    met = frozenset() if of_kind is None else of_kind(certificate)
    if met != wanted:
        of_proof, of_table = ("; ".join(sorted(names)) or "nothing" for names in (met, wanted))
        raise CertificateError(
            f"{certificate.id}: what is required is {of_proof}, and of {quantity!r} in quantities.csv {of_table}"
        )


def _formulas(certificate: Certificate) -> Iterator[tuple[str, str]]:
    """Unknowns, definitions and fields of a certificate, each a name and a text."""
    for name, raw in certificate.unknowns.items():
        m, n = raw.get("shape", [1, 1])
        yield f"unknown {name}", f"{raw.get('structure', 'full')}, {m} x {n}" if (m, n) != (1, 1) else "a number"
    yield from certificate.definitions
    for name, value in certificate.fields.items():
        if name == "constraints":
            yield from ((str(label), str(text)) for label, text in value)
        else:
            yield name, value if isinstance(value, str) else json.dumps(value, ensure_ascii=True)


def read_certificate(path: Path) -> Certificate:
    """Read a certificate from its file, unchecked.

    Raises
    ------
    CertificateError
        If it is malformed, too large, or not the one that the file is named after.
    """
    path = Path(path)
    try:
        with path.open("rb") as file:
            raw = file.read(LARGEST_FILE + 1)
        if len(raw) > LARGEST_FILE:
            raise CertificateError(f"{path.name}: more than {LARGEST_FILE} bytes")
        text = raw.decode("utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise CertificateError(f"{path.name}: not readable as text") from error
    certificate = Certificate.from_json(text, path.stem)
    if certificate.id != path.stem:
        raise CertificateError(f"{path.name}: holds the certificate {certificate.id!r}")
    return certificate


def check_file(path: Path, root: Path) -> Proof:
    """Check the certificate in a file against the tables of its paper under the project root.

    Raises
    ------
    CertificateError
        If it is refused, or about a paper that is not there.
    InputError
        If the paper's tables cannot be read.
    """
    from gainsay.tables import paper_names, read_case

    certificate = read_certificate(path)
    if certificate.paper not in paper_names(Path(root)):
        raise CertificateError(f"{certificate.id}: about {certificate.paper!r}, which is not a paper of this project")
    return check(certificate, read_case(Path(root), certificate.paper))
