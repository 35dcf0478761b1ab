"""A certificate in short, for the page: what it concludes, from which formulas, by which theorem, and its digest."""

import json
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from markupsafe import Markup, escape

from gainsay.errors import GainsayError
from gainsay.exact.rational import doubles_around
from gainsay.proof import kinds
from gainsay.report.numbers import number, span
from gainsay.report.sentences import LONGEST_FORMULA, name, said
from gainsay.tables import Case
from gainsay.tables.files import read_text

__all__ = ["CertificateFile", "read_certificate"]

_BOUNDS = {"at_most": "at most", "less_than": "below", "at_least": "at least", "greater_than": "above"}
#: what fields of certificates are called before their formulas; a short name of any other is a symbol
_LABELS = {
    "left": "one side",
    "right": "other side",
    "low": "above",
    "real": "real part",
    "imaginary": "imaginary part",
    "formula": "value",
    "modulo": "up to",
    "constraint": "condition",
    "matrix": "matrix",
    "then": "then",
}
#: characters of formulas that a page shows of one certificate; a hundred vertices of a polytope stay in the file
MOST_SHOWN = 2_500


@dataclass(frozen=True)
class Conclusion:
    """What a certificate concludes of one quantity.

    Attributes
    ----------
    quantity : str
        Its id; empty where the paper's tables declare none.
    about : Markup
        What it is, in words.
    truth : str
        ``holds`` or ``fails``; empty for a number.
    bound : Markup
        The number, or the bound on it, with its unit; empty for a truth.
    """

    quantity: str
    about: Markup
    truth: str
    bound: Markup


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
    concludes : tuple of Conclusion
    symbols : frozenset of str
        Letters that stand for something in its formulas, and so in its sentence.
    formulas : tuple of (Markup, str)
        Name of a part of the statement, and its formula; as many as a page shows, which typesets them.
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
    concludes: tuple[Conclusion, ...] = ()
    symbols: frozenset[str] = frozenset()
    formulas: tuple[tuple[Markup, str], ...] = ()
    unshown: int = 0
    definitions: tuple[tuple[str, str], ...] = field(default=(), repr=False)
    unknowns: tuple[tuple[Markup, str], ...] = ()
    faith: tuple[str, ...] = ()
    digest: str = ""
    file: str = ""


def _concluded(case: Case, conclusion: Mapping[str, str]) -> Conclusion:
    relation, value = conclusion["relation"], conclusion["value"] or ""
    declared = case.quantities.get(conclusion["quantity"])
    about = said(declared.meaning) if declared else escape(f"the {conclusion['of']}".replace("_", " "))
    quantity, unit = (declared.id, declared.unit) if declared else ("", "")
    if not value:
        return Conclusion(quantity, about, relation, Markup(""))
    if relation in _BOUNDS:
        towards = "up" if relation in ("at_most", "less_than") else "down"
        bound = Markup("{} {}").format(_BOUNDS[relation], number(_ends(value)[towards == "up"], unit, towards=towards))
    else:
        bound = span(*_ends(value), unit)
    return Conclusion(quantity, about, "", bound)


def _ends(value: str) -> tuple[str, str]:
    """Return a number, decimal or rational, or a range of them, as the doubles around it."""
    low, _, high = value.partition("..")
    least, greatest = doubles_around(Fraction(low), Fraction(high or low))
    return repr(least), repr(greatest)


def _label(label: str, unknowns: Mapping[str, Any]) -> Markup:
    """Return what stands before a formula: the paper's number of it, a word, or a symbol."""
    if label in _LABELS:
        return escape(_LABELS[label])
    if re.search("[<>=]", label):
        return escape("condition")  # named by itself
    if label in unknowns or re.fullmatch(r"[A-Za-z]\w?|alpha|gamma|rho", label):
        return name(label)
    return escape(label)


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
                    yield (
                        ("pole, real and imaginary part", f"row({', '.join(entry)})")
                        if key == "points"
                        else (entry[0], entry[1])
                    )
                elif key == "ranges":
                    yield f"{entry[0]}, ends of its range", f"row({entry[1]}, {entry[2]})"


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
            concludes=tuple(_concluded(case, conclusion) for conclusion in content["conclusions"]),
            symbols=frozenset(content["unknowns"]) | {defined for defined, _ in content["definitions"]},
            formulas=tuple((_label(label, content["unknowns"]), text) for label, text in parts[:shown]),
            unshown=len(parts) - shown,
            definitions=tuple((defined, text) for defined, text in content["definitions"]),
            unknowns=tuple((name(unknown), _shape(**shape)) for unknown, shape in content["unknowns"].items()),
            faith=tuple(content["faith"]),
            digest=content["digest"],
        )
    except (ValueError, KeyError, TypeError, AttributeError, IndexError, GainsayError):
        return CertificateFile(**known)  # stands as refused, with the checker's reason
