"""A certificate in short, for the page: what it concludes, from which formulas, by which theorem, and its digest."""

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from markupsafe import Markup, escape

from gainsay.errors import GainsayError
from gainsay.proof import kinds
from gainsay.report.numbers import number, span
from gainsay.report.sentences import LONGEST_FORMULA, formula, name
from gainsay.tables import Case
from gainsay.tables.files import read_text

__all__ = ["CertificateFile", "read_certificate"]

_BOUNDS = {"at_most": "≤", "less_than": "<", "at_least": "≥", "greater_than": ">"}
#: characters of formulas that a page shows of one certificate; a hundred vertices of a polytope stay in the file
MOST_SHOWN = 2_500


@dataclass(frozen=True)
class CertificateFile:
    """A certificate with what the checker said of it.

    Attributes
    ----------
    id : str
    accepted : bool
    says : str
        What it proves, or why it is refused.
    theorem : str
        What its conclusions rest on; empty where the file cannot be read.
    concludes : tuple of (str, Markup)
        Quantity, and what is concluded of it.
    formulas : tuple of (str, Markup)
        Name of a part of the statement, and the part typeset; as many as a page shows.
    unshown : int
        How many more there are.
    definitions : tuple of (str, str)
        Name and formula of what the statement is written in.
    unknowns : tuple of (Markup, str)
        Name, and its structure and shape.
    faith : tuple of str
        What no check covers.
    digest : str
        Of everything in the file.
    file : str
        Below the paper's results; empty where it is missing.
    """

    id: str
    accepted: bool
    says: str
    theorem: str = ""
    concludes: tuple[tuple[str, Markup], ...] = ()
    formulas: tuple[tuple[str, Markup], ...] = ()
    unshown: int = 0
    definitions: tuple[tuple[str, str], ...] = field(default=(), repr=False)
    unknowns: tuple[tuple[Markup, str], ...] = ()
    faith: tuple[str, ...] = ()
    digest: str = ""
    file: str = ""


def _concluded(conclusion: Mapping[str, str]) -> tuple[str, Markup]:
    relation, value = conclusion["relation"], conclusion["value"] or ""
    if relation in _BOUNDS:
        towards = "up" if relation in ("at_most", "less_than") else "down"
        said = Markup("{} {}").format(_BOUNDS[relation], _number(value, towards))
    elif relation == "inside":
        low, _, high = value.partition("..")
        said = span(low, high) if _decimal(low) and _decimal(high) else escape(value.replace("..", " to "))
    else:
        said = escape(relation)
    return conclusion["quantity"] or conclusion["of"], said


def _decimal(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _number(text: str, towards: str) -> Markup:
    return number(text, towards=towards) if _decimal(text) else escape(text)


def _shape(structure: str = "full", shape: Sequence[int] = (1, 1)) -> str:
    if tuple(shape) == (1, 1):
        return "a number"
    return f"{structure.replace('full', '')} {shape[0]} × {shape[1]}".strip()


def _parts(fields: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Yield every formula of a certificate's own fields with its name: a formula, or a list of formulas or constraints.

    Parts that are no formulas, such as the structure of an uncertainty, stay in the file.
    """
    for key, value in fields.items():
        label = key.replace("_", " ")
        if isinstance(value, str):
            yield label, value
        elif isinstance(value, list):
            for entry in value:
                if isinstance(entry, str):
                    yield label, entry
                elif isinstance(entry, list) and len(entry) == 2 and all(isinstance(text, str) for text in entry):
                    yield entry[0], entry[1]


def _shown(parts: list[tuple[str, str]]) -> int:
    """Return how many of the formulas a page shows: the first always, then as many as fit."""
    total = 0
    for count, (_, text) in enumerate(parts):
        total += min(len(text), LONGEST_FORMULA)
        if count and total > MOST_SHOWN:
            return count
    return len(parts)


def read_certificate(case: Case, row: Mapping[str, str]) -> CertificateFile:
    """Return a certificate of the table of certificates; a damaged one stands with the checker's reason alone."""
    name_of = f"certificates/{row['certificate']}.json"
    file = name_of if (case.results / name_of).is_file() else ""
    known: dict[str, Any] = {
        "id": row["certificate"],
        "accepted": row["accepted"] == "1",
        "says": row["says"],
        "file": file,
    }
    if not file:
        return CertificateFile(**known)
    try:
        content = json.loads(read_text(case.results / file, case.root))
        parts = list(_parts(content["fields"]))
        shown = _shown(parts)
        return CertificateFile(
            **known,
            theorem=kinds.load(content["kind"]).THEOREM,
            concludes=tuple(_concluded(conclusion) for conclusion in content["conclusions"]),
            formulas=tuple((label, formula(text)) for label, text in parts[:shown]),
            unshown=len(parts) - shown,
            definitions=tuple((defined, text) for defined, text in content["definitions"]),
            unknowns=tuple((name(unknown), _shape(**shape)) for unknown, shape in content["unknowns"].items()),
            faith=tuple(content["faith"]),
            digest=content["digest"],
        )
    except (ValueError, KeyError, TypeError, AttributeError, IndexError, GainsayError):
        return CertificateFile(**known)  # stands as refused, with the checker's reason
