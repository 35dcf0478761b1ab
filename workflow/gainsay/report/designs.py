"""What the synthesis gave beside what is printed: gains entry by entry, designs with their measures."""

from collections.abc import Sequence
from dataclasses import dataclass

from markupsafe import Markup

from gainsay.report.numbers import number, span, typeset
from gainsay.report.reading import DesignFile, PaperResults, Row

#: first word of the quantities of the printed design, tried in this order beside those of another design
PRINTED_PREFIXES = ("audit", "printed", "nominal", "simulation")


@dataclass(frozen=True)
class GainEntry:
    """An entry of a printed gain against the synthesis.

    Attributes
    ----------
    place : str
        Row and column.
    published, rounding, resynthesised, range : Markup
    identified : str
        ``yes``, ``no``, or empty where it was not examined.
    agrees : str
        ``yes`` or ``no``: whether the interval of the printed digits meets the entry (its range over near-optimal
        solutions where there is one); empty where there is nothing to compare.
    """

    place: str
    published: Markup
    rounding: Markup
    resynthesised: Markup
    range: Markup
    identified: str
    agrees: str


def _agrees(row: Row) -> str:
    low = row["range_low"] or row["resynthesised"]
    high = row["range_high"] or row["resynthesised"]
    if not low or not high:
        return ""
    meets = float(low) <= float(row["rounding_high"]) and float(row["rounding_low"]) <= float(high)
    return "yes" if meets else "no"


def gain_entries(found: PaperResults) -> dict[str, list[GainEntry]]:
    """Return the entries of every gain, in the order of gains.csv."""
    gains: dict[str, list[GainEntry]] = {}
    for row in found.gains:
        entry = GainEntry(
            place=f"{row['row']}, {row['column']}",
            published=typeset(row["published"]),
            rounding=span(row["rounding_low"], row["rounding_high"]),
            resynthesised=number(row["resynthesised"]),
            range=span(row["range_low"], row["range_high"]),
            identified={"1": "yes", "0": "no"}.get(row["identified"], ""),
            agrees=_agrees(row),
        )
        gains.setdefault(row["gain"], []).append(entry)
    return gains


@dataclass(frozen=True)
class Comparison:
    """A quantity of the printed design beside the same one of other designs."""

    name: str
    meaning: str
    printed: Markup
    others: tuple[Markup, ...]


def _split(quantity: str, design: str) -> str:
    """Return what is left of an id without the word of its design; empty where it has none."""
    words = quantity.split(".")
    return ".".join(word for word in words if word != design) if design in words else ""


def comparisons(found: PaperResults) -> list[Comparison]:
    """Return the quantities that are measured for the printed design and for another one."""
    rows, case = found.quantities, found.case
    names = [design.name for design in found.designs]
    keys = dict.fromkeys(key for quantity in rows for name in names if (key := _split(quantity, name)))
    compared = []
    for key in keys:
        printed = next((q for p in PRINTED_PREFIXES if (q := f"{p}.{key}") in rows), None)
        if printed is None:
            continue
        of = {name: next((q for q in rows if _split(q, name) == key), None) for name in names}
        others = tuple(number(rows[q]["value"], rows[q]["unit"]) if q else Markup("") for q in of.values())
        shown = number(rows[printed]["value"], rows[printed]["unit"])
        compared.append(Comparison(key, case.quantities[printed].meaning, shown, others))
    return compared


@dataclass(frozen=True)
class MatrixView:
    """A matrix ready to be shown: a title and rows of numbers."""

    title: str
    rows: tuple[tuple[Markup, ...], ...]


def _matrix(title: str, rows: Sequence[Sequence[Markup]]) -> MatrixView:
    return MatrixView(title, tuple(tuple(row) for row in rows))


def design_matrices(found: PaperResults, design: DesignFile) -> list[tuple[str, MatrixView | None, MatrixView]]:
    """Return each matrix of a design with the printed one of the same name and shape beside it."""
    pairs = []
    for name, rows in (design.matrices or {}).items():
        ours = _matrix(f"{name}, {design.name}", [[number(repr(float(x))) for x in row] for row in rows])
        parameter = found.case.parameters.get(name)
        printed = None
        if parameter is not None and parameter.type == "matrix":
            digits = found.case.printed(name).rows
            if (len(digits), len(digits[0])) == (len(rows), len(rows[0])):
                printed = _matrix(f"{name}, as printed", [[typeset(entry.text) for entry in row] for row in digits])
        pairs.append((name, printed, ours))
    return pairs
