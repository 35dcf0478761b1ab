"""Identities of a paper's algebra, and counterexamples to what it prints as one."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from gainsay.proof import Certificate, build
from gainsay.statements.unknowns import Unknown, scalar

__all__ = ["differing", "identical"]


def identical(
    case: Any,
    quantity: str,
    sentence: str,
    left: str,
    right: str,
    unknowns: Mapping[str, Unknown] | str = "",
    *,
    id: str = "",
    definitions: Mapping[str, str] | Iterable[tuple[str, str]] = (),
    modulo: Sequence[str] = (),
    at: Mapping[str, Any] | None = None,
    faith: Sequence[str] = (),
) -> Certificate:
    """Certify that two formulas are equal for every value of their unknowns.

    Parameters
    ----------
    case : gainsay.tables.Case
    quantity : str
        Its value is 1 where they are equal; nothing, where no quantity says so.
    sentence : str
        What is proved, one sentence.
    left, right : str
        The formulas.
    unknowns : mapping of str to Unknown, or str
        With their shapes; a text of names, such as ``"cf sf n"``, where all are numbers.
    id : str, optional
        Of the certificate; by default that of the quantity, with dashes.
    definitions : mapping of str to str, or pairs, optional
        Names that the formulas use, in order.
    modulo : sequence of str, optional
        Polynomials that vanish, such as ``"c**2 + s**2 - 1"``, or ``"e**2"`` for an identity to first order in e.
    at : mapping of str to value, optional
        A point at which they vanish, so that the identity speaks of some point; a number that is not named is 1.
    faith : sequence of str, optional
        What the proof leaves to prose.

    Raises
    ------
    CertificateError
        If they are not equal, or the polynomials do not vanish at the point.

    Examples
    --------
    >>> from gainsay.tables import find_root, read_case
    >>> case = read_case(find_root(), "wan2014")
    >>> circle = {"s": "3/5", "c": "4/5"}
    >>> made = identical(case, "", "(s + c)^2 is 1 + 2 s c on the circle.", "(s + c)**2", "1 + 2*s*c", "s c",
    ...                  id="square", modulo=["s**2 + c**2 - 1"], at=circle)
    >>> [(conclusion.of, conclusion.relation) for conclusion in made.conclusions]
    [('identity', 'holds')]
    """
    point = {name: (at or {}).get(name, 1) for name in _named(unknowns)} if modulo else {}
    fields = {"left": left, "right": right} | ({"modulo": list(modulo)} if modulo else {})
    return _made("identity", case, quantity, sentence, id, definitions, unknowns, fields, point, faith)


def differing(
    case: Any,
    quantity: str,
    sentence: str,
    left: str,
    right: str,
    unknowns: Mapping[str, Unknown] | str = "",
    *,
    id: str = "",
    definitions: Mapping[str, str] | Iterable[tuple[str, str]] = (),
    at: Mapping[str, Any] | None = None,
    faith: Sequence[str] = (),
) -> Certificate:
    """Certify that two formulas are not equal: values of their unknowns at which they differ.

    Parameters
    ----------
    case, sentence, left, right, unknowns, id, definitions, faith
        As for `identical`.
    quantity : str
        Its value is 0 where they differ; nothing, where no quantity says so.
    at : mapping of str to value, optional
        Where they differ; unknowns that are not named have small integers as entries. Without `unknowns`, its names
        are those of unknown numbers.

    Raises
    ------
    CertificateError
        If they are not proved to differ there.
    """
    unknowns = unknowns or " ".join(at or ())
    point = {**_somewhere(_named(unknowns)), **(at or {})}
    fields = {"left": left, "right": right}
    return _made("different", case, quantity, sentence, id, definitions, unknowns, fields, point, faith)


def _named(unknowns: Mapping[str, Unknown] | str) -> dict[str, Unknown]:
    return dict.fromkeys(unknowns.split(), scalar()) if isinstance(unknowns, str) else dict(unknowns)


def _made(
    kind: str,
    case: Any,
    quantity: str,
    sentence: str,
    id: str,
    definitions: Mapping[str, str] | Iterable[tuple[str, str]],
    unknowns: Mapping[str, Unknown] | str,
    fields: Mapping[str, Any],
    point: Mapping[str, Any],
    faith: Sequence[str],
) -> Certificate:
    return build.certificate(
        kind,
        id=id,
        tables=case,
        statement=sentence,
        definitions=definitions,
        unknowns={name: unknown.entry() for name, unknown in _named(unknowns).items()},
        witness=point,
        fields=fields,
        quantities={"identity": quantity} if quantity else {},
        faith=faith,
    )


def _integers() -> Iterator[int]:
    """Yield the integers 1 to 12 in an order without a pattern, again and again: powers of 2 modulo 13."""
    value = 1
    while True:
        yield value
        value = 2 * value % 13


def _somewhere(unknowns: Mapping[str, Unknown]) -> dict[str, list[list[int]]]:
    """Values of small integers, square ones with a dominant diagonal, so that they have an inverse."""
    integers, point = _integers(), {}
    for name, unknown in unknowns.items():
        rows = [[next(integers) for _ in range(unknown.columns)] for _ in range(unknown.rows)]
        if unknown.rows == unknown.columns > 1:
            for i in range(unknown.rows):
                for j in range(i):
                    if unknown.structure != "full":
                        rows[i][j] = rows[j][i] = rows[j][i] if unknown.structure == "symmetric" else 0
                rows[i][i] += 12 * unknown.rows
        point[name] = rows
    return point
