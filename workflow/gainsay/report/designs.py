"""Designs beside the printed one: one table of every measure, and their gains."""

from collections.abc import Sequence
from dataclasses import dataclass

from markupsafe import Markup

from gainsay.report.numbers import number, typeset
from gainsay.report.reading import DesignFile, PaperResults, Row
from gainsay.tables.lint import measure_of

#: relative difference below which two designs are called alike
ALIKE = 1e-3


@dataclass(frozen=True)
class Measure:
    """A measure of the printed design beside the same one of the others.

    Attributes
    ----------
    meaning : str
    better : str
        ``less`` or ``more``.
    printed : Markup
    others : tuple of (Markup, str)
        Value, and ``better``, ``worse``, ``alike`` or nothing, for each design of `Comparison.designs`.
    """

    meaning: str
    better: str
    printed: Markup
    others: tuple[tuple[Markup, str], ...]


@dataclass(frozen=True)
class Comparison:
    """The table of designs: names of the designs measured, and a row a measure."""

    designs: tuple[str, ...]
    measures: tuple[Measure, ...]


def _outcome(better: str, printed: float, other: float) -> str:
    if abs(other - printed) <= ALIKE * max(abs(printed), abs(other)):
        return "alike"
    return "better" if (other < printed) == (better == "less") else "worse"


def comparison(found: PaperResults) -> Comparison:
    """Return every measure that paper.toml names of the printed design, beside each design that has it.

    The printed design stands in a row even where no other design was measured alike.
    """
    rows, case = found.quantities, found.case
    names = [*case.paper.designs, *(run for run in case.paper.runs if run not in case.paper.designs)]
    asked = {
        printed: {name: quantity for name in names if (quantity := measure_of(case, text, name)) not in ("", printed)}
        for printed, text in case.paper.measures.items()
    }
    measured = [name for name in names if any(name in quantities for quantities in asked.values())]
    measures = []
    for printed, quantities in asked.items():
        better = case.paper.measures[printed].partition(" ")[0]
        own = rows.get(printed)
        others = tuple(_other(own, rows.get(quantities.get(name, "")), better) for name in measured)
        shown = number(own["value"], own["unit"], digits=4) if own else Markup("")
        measures.append(Measure(case.quantities[printed].meaning, better, shown, others))
    return Comparison(tuple(measured), tuple(measures))


def _other(own: Row | None, row: Row | None, better: str) -> tuple[Markup, str]:
    if row is None:
        return Markup(""), ""
    outcome = _outcome(better, float(own["value"]), float(row["value"])) if own else ""
    return number(row["value"], row["unit"], digits=4), outcome


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
