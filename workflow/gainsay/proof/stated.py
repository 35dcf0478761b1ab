"""What a certificate states, apart from how it is proved: one digest of its formulas for a paper's record.

A witness may be any that proves the statement, and is found anew in every run; the formulas may not change unnoticed.
"""

import hashlib
import json
import re
from collections.abc import Mapping
from typing import Any

from gainsay.errors import CertificateError
from gainsay.proof import formulas, kinds
from gainsay.proof.certificate import Certificate, plain

__all__ = ["by_ends", "formulas_digest"]

_FOUND = "found"
_WHOLE = re.compile(r"ends\('([^']*)'\)\[0,0\]ends\('\1'\)\[0,1\]", re.ASCII)
_NUMBER = re.compile(r"[+-]?\d+(\.\d*)?([eE][+-]?\d+)?|[+-]?\d+/\d+", re.ASCII)
# "Theorem 1" and "(14)" are names; a number with decimals in a sentence is a value, which conclusions carry exactly.
_DECIMAL = re.compile(r"\d+\.\d+(e[+-]?\d+)?|\d+e[+-]?\d+", re.ASCII)


def by_ends(certificate: Certificate) -> frozenset[str]:
    """Plausible ranges that are read by their ends, and not as the range of an uncertain number of ``ranges``.

    What holds at the ends need not hold between them: that it does is the argument of whoever wrote the certificate.

    Examples
    --------
    >>> draft = Certificate("c", "p", "A sentence.", "enclosed", {"formula": "2 * ends('mass')[0, 1]"})
    >>> sorted(by_ends(draft))
    ['mass']
    >>> box = [["m", "ends('mass')[0, 0]", "ends('mass')[0, 1]"]]
    >>> sorted(by_ends(draft.changed(kind="lyapunov", fields={"matrix": "-m", "alpha": "0", "ranges": box})))
    []
    """
    return frozenset().union(*map(_ends, (text for _, text in certificate.definitions)), _ends(certificate.fields))


def _ends(value: Any) -> frozenset[str]:
    if isinstance(value, str):
        try:
            return formulas.ends_in(value)
        except CertificateError:  # a label
            return frozenset()
    if isinstance(value, Mapping):
        parts = [_of_box(part) if key == "ranges" else _ends(part) for key, part in value.items()]
        return frozenset().union(*parts)
    return frozenset().union(*map(_ends, value)) if isinstance(value, list | tuple) else frozenset()


def _of_box(entries: Any) -> frozenset[str]:
    """What the ranges of uncertain numbers read by an end, but for those that are whole plausible ranges."""
    rest = [entry for entry in entries if not _WHOLE.fullmatch("".join(map(str, entry[1:])).replace(" ", ""))]
    return _ends(rest)


def formulas_digest(certificate: Certificate) -> str:
    """Digest of everything that a certificate states, without its witness.

    It covers paper, id, kind, sentence, definitions, unknowns with their structure, formulas and constraints, the names
    of the table entries read, what is concluded about which quantity by which relation, and what stays on
    faith. It leaves out the witness, the precision, the values of the table entries (which the checker compares with
    the tables), and the numbers that a search found: the value of a conclusion, and a number written out in the fields
    that a kind lists as ``LEVELS`` or ``FOUND``, such as the level of a norm bound. A changed number of that sort
    changes what is concluded, and there the record compares it within its tolerance. Decimals in sentences count
    likewise.

    Parameters
    ----------
    certificate : Certificate
        Accepted or not: the digest proves nothing.

    Returns
    -------
    str
        "sha256:" and 64 hexadecimal digits; the same wherever and however the witness was found.

    Raises
    ------
    CertificateError
        If there is no such kind.

    Examples
    --------
    >>> draft = Certificate("c", "p", "A sentence.", "definite", {"constraint": "2 > 0"})
    >>> formulas_digest(draft) == formulas_digest(draft.changed(precision=256))
    True
    >>> formulas_digest(draft) == formulas_digest(draft.changed(fields={"constraint": "3 > 0"}))
    False
    """
    packed = json.dumps(_stated(certificate), sort_keys=True, ensure_ascii=True, separators=(",", ":"))
    return "sha256:" + hashlib.sha256(packed.encode("ascii")).hexdigest()


def _stated(certificate: Certificate) -> dict[str, Any]:
    fields = plain(certificate.fields)
    levels = [fields["level"]] if certificate.kind == "level" else []
    return {
        "paper": certificate.paper,
        "id": certificate.id,
        "kind": certificate.kind,
        "statement": _sentence(certificate.statement),
        "definitions": [[name, _number(text) if name in levels else text] for name, text in certificate.definitions],
        "unknowns": plain(certificate.unknowns),
        "fields": _fields(certificate.kind, fields),
        "entries": {group: sorted(entries) for group, entries in certificate.data.items()},
        "conclusions": sorted([c.of, c.quantity, c.relation] for c in certificate.conclusions),
        "faith": [_sentence(text) for text in certificate.faith],
    }


def _sentence(text: str) -> str:
    return _DECIMAL.sub("#", text)


def _number(value: Any) -> Any:
    """Mark in place of a number written out, or of a list of them; a formula stays."""
    if isinstance(value, list):
        return _FOUND if all(_number(x) == _FOUND for x in value) else value
    return _FOUND if isinstance(value, str) and _NUMBER.fullmatch(value.strip()) else value


def _fields(kind: str, fields: Mapping[str, Any], part: bool = False) -> dict[str, Any]:
    """Fields of a kind without the numbers that a search found; the levels of a part are no conclusion's and stay."""
    module = kinds.load(kind)
    inner: dict[str, set[str]] = {}
    for name in (*module.FOUND, *(() if part else module.LEVELS)):
        head, _, tail = name.partition(".")
        inner.setdefault(head, set()).add(tail)
    result = {}
    for name, value in fields.items():
        within = inner.get(name, set())
        if "" in within:
            value = _number(value)
        elif within and isinstance(value, list):
            value = [
                {k: _number(v) if k in within else v for k, v in x.items()} if isinstance(x, dict) else x for x in value
            ]
        elif kind == "level" and name == "parts" and isinstance(value, list):
            value = [_part(x) for x in value]
        result[name] = value
    return result


def _part(part: Any) -> Any:
    if isinstance(part, dict) and isinstance(part.get("kind"), str) and isinstance(part.get("fields"), dict):
        return {**part, "fields": _fields(part["kind"], part["fields"], part=True)}
    return part
