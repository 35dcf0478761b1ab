"""Proofs over a box by branch and bound: each cell is halved until every part is proved, refuted or small.

Volumes are counted in the smallest parts there are, so that they add up exactly. A cell that is proved whole carries a
certificate of every part it was halved into; one of which something is refuted, of a point that violates.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from fractions import Fraction
from typing import Any, Protocol

import numpy as np

from gainsay.campaigns.plan import Block, Columns, Evaluation, Plan
from gainsay.errors import CertificateError, GainsayError
from gainsay.proof import Certificate, build, check
from gainsay.tables import Case

PROVED, REFUTED, OPEN = 1, -1, 0
#: part of the volume proved in white to green, refuted somewhere in red
_COLOURS = "RdYlGn"

#: parts of a cell that are certified one by one at most, and rows that are held in memory at a time then
MOST_PARTS, GROUP = 256, 64
#: a box or a point as a certificate says it: each input as its name and decimals
Texts = list[list[str]]
#: least and greatest value of an input, exact
Side = tuple[Fraction, ...]
Test = Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]


class Property(Protocol):
    """A property of points that can be proved over a box, and its violation at a point."""

    def __call__(self, low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """As the test of `branch`."""

    def over(self, ranges: Sequence[Sequence[str]]) -> Mapping[str, Any]:
        """What a certificate states of a box, ``[name, low, high]`` each: kind, statement, definitions, fields."""

    def at(self, point: Sequence[Sequence[str]]) -> Mapping[str, Any]:
        """What a certificate states of a point that violates, ``[name, value]`` each, its first definitions."""

    def proof(self, name: str, ranges: Sequence[Sequence[str]]) -> Certificate:
        """Certify the property over a box; raises `CertificateError`."""

    def violation(self, name: str, point: Sequence[Sequence[str]]) -> Certificate:
        """Certify that a point violates it; raises `CertificateError`."""


def branch(
    low: np.ndarray, high: np.ndarray, test: Test, deepest: int
) -> tuple[dict[str, int], list[tuple[np.ndarray, np.ndarray]], np.ndarray | None]:
    """Branch and bound over one box.

    Parameters
    ----------
    low, high : ndarray, shape (k,)
        Ends of the box.
    test : callable
        ``(low, high) -> (outcomes, inputs)`` for boxes, shapes (m, k): `PROVED` where the property is proved for the
        whole box, `REFUTED` where a point of it is proved to violate it, `OPEN` where neither is; and the number of the
        input across which the box is halved then.
    deepest : int
        How often a box is halved at most.

    Returns
    -------
    (counts, parts, point)
        Counts ``proved``, ``refuted``, ``open``: volumes in parts of 2^-deepest of the box; ``refuted`` are smallest
        parts with a violating point each, ``boxes`` how many were tested. Ends of the parts proved. The middle of the
        first box refuted, or None.
    """
    parts: list[tuple[np.ndarray, np.ndarray]] = []
    point: np.ndarray | None = None
    counts = {"proved": 0, "refuted": 0, "open": 0, "boxes": 0}
    lows, highs = np.asarray(low, dtype=float)[None], np.asarray(high, dtype=float)[None]
    for depth in range(deepest + 1):
        if not len(lows):
            break
        outcomes, across = map(np.asarray, test(lows, highs))
        counts["boxes"] += len(lows)
        counts["proved"] += int(np.sum(outcomes == PROVED)) << (deepest - depth)
        rest = outcomes != PROVED
        parts += zip(lows[~rest], highs[~rest], strict=True)
        if point is None and (outcomes == REFUTED).any():
            first = int(np.argmax(outcomes == REFUTED))
            point = (lows[first] + highs[first]) / 2
        if depth == deepest:
            counts["refuted"] += int(np.sum(outcomes == REFUTED))
            counts["open"] += int(np.sum(outcomes == OPEN))
            break
        lows, highs = _halved(lows[rest], highs[rest], across[rest])
    return counts, parts, point


def _halved(lows: np.ndarray, highs: np.ndarray, across: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Both halves of each box across one input of each, beside each other."""
    rows = np.arange(len(lows))
    middle = (lows[rows, across] + highs[rows, across]) / 2
    left, right = highs.copy(), lows.copy()
    left[rows, across], right[rows, across] = middle, middle
    return np.stack([lows, right], 1).reshape(-1, lows.shape[1]), np.stack([left, highs], 1).reshape(-1, lows.shape[1])


def over_boxes(inputs: tuple[str, ...], of: Callable[[Case], Property], deepest: int, sentence: str) -> Evaluation:
    """Campaign of kind ``box``: a property proved over every part of a box, cell by cell.

    Parameters
    ----------
    inputs : tuple of str
        The first two of the row are the sides of the figure.
    of : callable
        ``case -> property``, over inputs in the order given here.
    deepest : int
        How often a cell is halved at most.
    sentence : str
        The property, for people.
    """

    def block(case: Case, cells: Block) -> Columns:
        held = of(case)
        columns: dict[str, list[Any]] = {name: [] for name in types}
        for index, cell in zip(cells.indices, cells.cells(), strict=True):
            low, high = _ends(cell, inputs)
            counts, parts, point = branch(low, high, held, deepest)
            whole = counts["proved"] == 1 << deepest
            proofs = _proofs(held, f"{cells.plan.row.name}-{index}", inputs, parts if whole else [], point)
            row: dict[str, Any] = {**counts, "certified": len(proofs)}
            row["certificate"] = "\n".join(one.to_json(compact=True) for one in proofs)
            row |= {f"{name}_{end}": cell[name][k] for name in inputs for k, end in enumerate(("low", "high"))}
            for name, values in columns.items():
                values.append(row[name])
        return columns

    def recheck(case: Case, cell: Block, row: Mapping[str, Any]) -> str:
        low, high = _ends(cell.cells()[0], inputs)
        return _doubt(case, of(case), _ranges(inputs, low, high), row, row["proved"] == 1 << deepest)

    def count(columns: Columns) -> dict[str, int]:
        whole = np.asarray(columns["proved"]) == 1 << deepest
        certified = np.asarray(columns["certified"]) > 0
        cells = {"cells_proved": whole, "cells_certified": whole & certified, "cells_refuted": certified & ~whole}
        return {
            **{name: int(np.sum(of_cells)) for name, of_cells in cells.items()},
            **{k: int(sum(columns[k])) for k in ("proved", "refuted", "open", "boxes", "certified")},
        }

    def findings(plan: Plan, counts: Mapping[str, int]) -> dict[str, Any]:
        parts = plan.points << deepest
        answers = {key: f"{key}: {counts[key] / parts:.6f} of the volume" for key in ("proved", "refuted", "open")}
        holds = "holds over the whole box" if counts["proved"] == parts else "holds over the part proved"
        certified = (
            f"of {plan.points} cells {counts['cells_proved']} are proved whole, {counts['cells_certified']} of them by "
            f"certificates, and {counts['cells_refuted']} have a certified point that violates"
        )
        return {"property": f"{sentence}: {holds}", **answers, "cells": certified, "parts": parts}

    def draw(figure: Any, plan: Plan, rows: Iterator[Mapping[str, np.ndarray]]) -> None:
        _draw(figure, plan, rows, deepest)

    sides = {f"{name}_{end}": "float64" for name in inputs for end in ("low", "high")}
    numbers = dict.fromkeys(("proved", "refuted", "open", "boxes", "certified"), "int64")
    types = {**sides, **numbers, "certificate": "string"}
    return Evaluation("box", inputs, types, block, count, findings, draw, recheck, GROUP)


def _ends(cell: Mapping[str, tuple[float, float]], inputs: Sequence[str]) -> tuple[np.ndarray, np.ndarray]:
    low, high = (np.array([cell[name][k] for name in inputs]) for k in (0, 1))
    return low, high


def _ranges(inputs: Sequence[str], low: np.ndarray, high: np.ndarray) -> Texts:
    """A box as a certificate says it: neighbours share their end to the digit."""
    return [[name, repr(float(a)), repr(float(b))] for name, a, b in zip(inputs, low, high, strict=True)]


def _proofs(
    held: Property,
    name: str,
    inputs: Sequence[str],
    parts: Sequence[tuple[np.ndarray, np.ndarray]],
    point: np.ndarray | None,
) -> list[Certificate]:
    """Certificates of the parts of a cell that is proved whole, or of a point that violates; none where one fails."""
    if len(parts) > MOST_PARTS:
        return []
    try:
        if point is not None:
            values = [[input_, repr(float(value))] for input_, value in zip(inputs, point, strict=True)]
            return [held.violation(name, values)]
        return [held.proof(f"{name}-{k}", _ranges(inputs, *part)) for k, part in enumerate(parts)]
    except CertificateError:
        return []


def _doubt(case: Case, held: Property, cell: Texts, row: Mapping[str, Any], whole: bool) -> str:
    """Say what is wrong with the certificates of a cell: refused, of something else, or not of all of the cell."""
    lines = row["certificate"].splitlines()
    if len(lines) != row["certified"]:
        return f"{len(lines)} certificates where {row['certified']} are counted"
    try:
        certificates = [Certificate.from_json(line, "row") for line in lines]
        for certificate in certificates:
            check(certificate, case)
        if whole:
            boxes = [certificate.fields.get("ranges", []) for certificate in certificates]
            stated = [held.over(box) for box in boxes]
        else:
            points = [certificate.definitions[: len(cell)] for certificate in certificates]
            stated = [held.at(point) for point in points]
            boxes = [[[name, value, value] for name, value in point] for point in points]
    except (GainsayError, TypeError, ValueError) as error:
        return str(error)
    if not all(_says(certificate, parts) for certificate, parts in zip(certificates, stated, strict=True)):
        return "a certificate of something else"
    if any([name for name, *_ in box] != [name for name, *_ in cell] for box in boxes):
        return "a certificate of other inputs"
    ends = [[tuple(map(Fraction, side[1:])) for side in box] for box in (cell, *boxes)]
    if not all(_within(box, ends[0]) for box in ends[1:]):
        return "a certificate of another cell"
    return "its certificates leave out a part of it" if whole and lines and not _covered(ends[0], ends[1:]) else ""


def _says(certificate: Certificate, parts: Mapping[str, Any]) -> bool:
    """Whether a certificate states these parts."""
    found = {name: getattr(certificate, name) for name in parts}
    return build.one_line(found) == build.one_line(dict(parts))


def _within(box: Sequence[Side], cell: Sequence[Side]) -> bool:
    return all(low <= a and b <= high for (a, b), (low, high) in zip(box, cell, strict=True))


def _covered(cell: Sequence[Side], boxes: Sequence[Sequence[Side]]) -> bool:
    """Whether boxes within a cell cover it: one is it, or a cut that meets none of them leaves two such cells."""
    if len(boxes) < 2:
        return list(cell) == list(boxes[0]) if boxes else False
    for k, (low, high) in enumerate(cell):
        for cut in sorted({box[k][1] for box in boxes} - {high}):
            if all(box[k][1] <= cut or box[k][0] >= cut for box in boxes):
                sides = (
                    ((low, cut), [b for b in boxes if b[k][1] <= cut]),
                    ((cut, high), [b for b in boxes if b[k][0] >= cut]),
                )
                return all(_covered([*cell[:k], side, *cell[k + 1 :]], part) for side, part in sides)
    return False


def _draw(figure: Any, plan: Plan, rows: Iterator[Mapping[str, np.ndarray]], deepest: int) -> None:
    """Part of the volume that is proved, least over the other inputs, for each cell of the first two."""
    first, second = plan.axes[0], plan.axes[1] if len(plan.axes) > 1 else None
    least = np.full(plan.sides, 1.0)
    for batch in rows:
        np.minimum.at(least, plan.places(batch["index"]), batch["proved"] / (1 << deepest))
    axes = figure.subplots()
    extent = (first.low, first.high, second.low if second else 0, second.high if second else 1)
    shown = axes.imshow(least.T, origin="lower", extent=extent, aspect="auto", vmin=0, vmax=1, cmap=_COLOURS)
    axes.grid(False)
    axes.set_xlabel(first.name)
    axes.set_ylabel(second.name if second else "")
    figure.colorbar(shown, ax=axes, label="part proved, least over the other inputs")
