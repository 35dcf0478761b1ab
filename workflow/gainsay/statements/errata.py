"""Errata that follow from editions: what is printed and what should stand there are the cells that differ."""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from gainsay.errors import InputError, one_of
from gainsay.proof.typeset import tex
from gainsay.statements.statement import Cell, Statement

__all__ = ["corrections", "from_editions"]

Place = tuple[int, int]
_PLACE = re.compile(r"\((\d+),(\d+)\)")


@dataclass(frozen=True)
class _Differing:
    """A cell of one edition as a reader sees it: block, equation, and the texts of both sides as TeX."""

    place: Place
    equation: str
    blocks: bool
    printed: str
    corrected: str


def _cells(edition: Statement) -> Iterator[_Differing]:
    """Yield the cells in which an edition differs, with the numbers of their blocks as printed."""
    rows = list(edition.printed_rows)
    for cell in edition.differences:
        i, j = (rows.index(name) + 1 for name in (cell.row, cell.column))
        equation = edition.label.removesuffix(f" {edition.edition}")
        yield _Differing((i, j), equation, len(rows) > 1, *_sides(edition, cell, (i, j)))


def _sides(edition: Statement, cell: Cell, place: Place) -> tuple[str, str]:
    gone = [number for name, number in zip((cell.row, cell.column), place, strict=True) if name not in edition.rows]
    printed, corrected = (f"${tex(text, edition.notation) if text else 0}$" for text in (cell.printed, cell.corrected))
    return printed, f"no block row {gone[-1]}" if gone else corrected


def _spelled(texts: Sequence[tuple[str, _Differing]], several: bool) -> str:
    """Sentence of texts and where they stand, those that are alike said once."""
    sentences = []
    for text in dict.fromkeys(text for text, _ in texts):
        cells = [cell for other, cell in texts if other == text]
        if text.startswith("no "):
            sentences.append(text)
            continue
        places = list(dict.fromkeys(cell.place for cell in cells if cell.blocks))
        equations = list(dict.fromkeys(cell.equation for cell in cells if several or not cell.blocks))
        blocks = " and ".join(f"({i},{j})" for i, j in places)
        where = f" in block{'s' if len(places) > 1 else ''} {blocks}" if places else ""
        of = f" {'of' if places else 'in'} {' and '.join(equations)}" if equations else ""
        sentences.append(f"{text}{where}{of}")
    return ", ".join(sentences)


def _named(named: str, editions: Mapping[str, Statement]) -> Iterator[_Differing]:
    """Yield the cells that an erratum's `edition` names, all of an edition where it names no block."""
    for part in named.split("; "):
        label, _, places = part.partition(": ")
        if label not in editions:
            raise InputError("edition", value=label, expected=one_of(label, editions))
        cells = {cell.place: cell for cell in _cells(editions[label])}
        wanted = [(int(i), int(j)) for i, j in _PLACE.findall(places)] or list(cells)
        for place in wanted:
            if place not in cells:
                known = " ".join(f"({i},{j})" for i, j in cells)
                raise InputError("block", value=f"({place[0]},{place[1]}) of {label}", expected=f"one of {known}")
            yield cells[place]


def from_editions(named: str, editions: Iterable[Statement]) -> tuple[str, str]:
    r"""Return what an erratum's editions say is printed, and what should stand there.

    Parameters
    ----------
    named : str
        Editions and blocks as the column ``edition`` of errata.csv names them.
    editions : iterable of Statement
        Those of the paper.

    Returns
    -------
    printed, corrected : str
        Sentences with TeX between dollars.

    Raises
    ------
    InputError
        If there is no such edition, or it does not differ in such a block.

    Examples
    --------
    >>> from gainsay.statements import Statement
    >>> printed = Statement("(21)", "Theorem 1", ("x", "z"), {("x", "z"): "C.T", ("z", "z"): "g*eye(2)"}, {},
    ...                     notation={"g": r"\gamma^{2}"})
    >>> from_editions("(21) corrected: (2,2)", [printed.corrected({("z", "z"): "-g*eye(2)"})])
    ('$\\gamma^{2} I$ in block (2,2)', '$-\\gamma^{2} I$ in block (2,2)')
    """
    cells = list(_named(named, {edition.label: edition for edition in editions}))
    several = len({cell.equation for cell in cells}) > 1
    printed, corrected = ([(getattr(cell, side), cell) for cell in cells] for side in ("printed", "corrected"))
    return _spelled(printed, several), _spelled(corrected, several)


def corrections(named: Iterable[str], editions: Iterable[Statement]) -> list[str]:
    """Return the cells of editions that no erratum names, each as ``label: (row,column)``; every one should be named.

    Parameters
    ----------
    named : iterable of str
        The column ``edition`` of all errata.
    editions : iterable of Statement
    """
    known = {edition.label: edition for edition in editions}
    places = {(cell.equation, cell.place) for text in named if text for cell in _named(text, known)}
    return [
        f"{edition.label}: ({cell.place[0]},{cell.place[1]})"
        for edition in known.values()
        for cell in _cells(edition)
        if (cell.equation, cell.place) not in places
    ]
