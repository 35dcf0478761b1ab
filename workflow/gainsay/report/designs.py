"""Designs beside the printed one, or beside one of ours where none is printed: every measure, and their gains."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from markupsafe import Markup

from gainsay.report.numbers import number, typeset
from gainsay.report.reading import PaperResults, Row
from gainsay.tables import Case
from gainsay.tables.designs import Design, DesignFile
from gainsay.tables.lint import held_against, measure_of
from gainsay.tables.reading import PrintedMatrix

#: relative difference below which two designs are called alike
ALIKE = 1e-3
#: what stands between the parts of a meaning
_PARTS = re.compile(", |: ")


@dataclass(frozen=True)
class Measure:
    """A measure of the printed design, or of the one that stands for it, beside the same one of the others.

    Attributes
    ----------
    meaning, unit : str
    better : str
        ``less`` or ``more``.
    own : Markup
    others : tuple of (Markup, str)
        Value, and ``better``, ``worse``, ``alike`` or nothing, for each design of `Comparison.designs`.
    """

    meaning: str
    unit: str
    better: str
    own: Markup
    others: tuple[tuple[Markup, str], ...]


@dataclass(frozen=True)
class Comparison:
    """A table of designs.

    Attributes
    ----------
    against : str
        The design that the others are held against; empty where it is the printed one.
    designs : tuple of str
        Those that are measured.
    measures : tuple of Measure
        A row each.
    """

    against: str
    designs: tuple[str, ...]
    measures: tuple[Measure, ...]


def _outcome(better: str, printed: float, other: float) -> str:
    if abs(other - printed) <= ALIKE * max(abs(printed), abs(other)):
        return "alike"
    return "better" if (other < printed) == (better == "less") else "worse"


def comparisons(results: PaperResults) -> tuple[Comparison, ...]:
    """Return every measure that paper.toml names beside each design that has it, a table for each that is compared.

    The design that the others are held against stands in a row even where no other design was measured alike.
    """
    against = dict.fromkeys(map(held_against, results.case.paper.measures.values()))
    return tuple(_comparison(results, design) for design in against)


def _comparison(results: PaperResults, against: str) -> Comparison:
    case = results.case
    names = [*case.paper.designs, *(run for run in case.paper.runs if run not in case.paper.designs)]
    asked = {
        own: {name: quantity for name in names if (quantity := measure_of(case, text, name)) not in ("", own)}
        for own, text in case.paper.measures.items()
        if held_against(text) == against
    }
    designs = tuple(name for name in names if any(name in quantities for quantities in asked.values()))
    return Comparison(against, designs, tuple(_measure(results, own, asked[own], designs) for own in asked))


def _measure(results: PaperResults, quantity: str, quantities: Mapping[str, str], designs: Sequence[str]) -> Measure:
    rows, about = results.quantities, results.case.quantities[quantity]
    better = results.case.paper.measures[quantity].partition(" ")[0]
    own = rows.get(quantity)
    meaning = _shared(about.meaning, [results.case.quantities[quantities[name]].meaning for name in quantities])
    others = tuple(_other(own, rows.get(quantities.get(name, "")), better) for name in designs)
    return Measure(meaning, about.unit, better, number(own["value"], digits=4) if own else Markup(""), others)


def _shared(meaning: str, others: Sequence[str]) -> str:
    """Return the parts of a meaning that those of other designs have too; all of it where its head is its own."""
    parts = [part for part in _PARTS.split(meaning) if all(part in _PARTS.split(other) for other in others)]
    return ", ".join(parts) if parts and meaning.startswith(parts[0]) else meaning


def _other(own: Row | None, row: Row | None, better: str) -> tuple[Markup, str]:
    if row is None:
        return Markup(""), ""
    outcome = _outcome(better, float(own["value"]), float(row["value"])) if own else ""
    return number(row["value"], digits=4), outcome


@dataclass(frozen=True)
class MatrixView:
    """A matrix ready to be shown: a title and rows of numbers."""

    title: str
    rows: tuple[tuple[Markup, ...], ...]


@dataclass(frozen=True)
class DesignView:
    """A design: what it is, how it was found, and its gains.

    Attributes
    ----------
    name, about : str
        As in paper.toml.
    file : DesignFile or None
        What was asked and how the search went; None where no search has found it yet.
    effort : str
        What the search cost, in words.
    matrices : tuple of (str, MatrixView or None, MatrixView)
        Name of each matrix, the printed one of the same name and shape, and ours.
    """

    name: str
    about: str
    file: DesignFile | None = None
    effort: str = ""
    matrices: tuple[tuple[str, MatrixView | None, MatrixView], ...] = ()


def design_views(case: Case) -> tuple[DesignView, ...]:
    """Return every design that paper.toml names, as the paper's folder has it."""
    return tuple(
        _design_view(case, case.designs[name], about) if name in case.designs else DesignView(name, about)
        for name, about in case.paper.designs.items()
    )


def _design_view(case: Case, design: Design, about: str) -> DesignView:
    effort = ", ".join(f"{count} {what}" for what, count in design.file.effort.items())
    matrices = []
    for name, ours in design.matrices.items():
        rows = tuple(tuple(number(entry.text) for entry in row) for row in ours.rows)
        matrices.append(
            (name, _printed(case, name, ours), MatrixView(f"{name}, {design.name}".replace("_", " "), rows))
        )
    return DesignView(design.name, about, design.file, effort, tuple(matrices))


def _printed(case: Case, matrix: str, ours: PrintedMatrix) -> MatrixView | None:
    name = case.paper.printed.get(matrix, matrix)
    parameter = case.parameters.get(name)
    if parameter is None or parameter.type != "matrix":
        return None
    printed = case.printed(name)
    if printed.floats.shape != ours.floats.shape:
        return None
    return MatrixView(f"{name}, as printed", tuple(tuple(typeset(e.text) for e in row) for row in printed.rows))
