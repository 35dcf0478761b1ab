"""Proofs over a box by branch and bound: each cell is halved until every part is proved, refuted or small.

Volumes are counted in the smallest parts there are, so that they add up exactly.
"""

from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np

from gainsay.campaigns.plan import Block, Columns, Evaluation, Plan
from gainsay.tables import Case

PROVED, REFUTED, OPEN = 1, -1, 0
#: part of the volume proved in white to green, refuted somewhere in red
_COLOURS = "RdYlGn"

Test = Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]


def branch(low: np.ndarray, high: np.ndarray, test: Test, deepest: int) -> dict[str, int]:
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
    dict
        ``proved``, ``refuted``, ``open``: volumes in parts of 2^-deepest of the box; ``refuted`` are smallest parts
        with a violating point each. ``boxes``: how many were tested.
    """
    counts = {"proved": 0, "refuted": 0, "open": 0, "boxes": 0}
    lows, highs = np.asarray(low, dtype=float)[None], np.asarray(high, dtype=float)[None]
    for depth in range(deepest + 1):
        if not len(lows):
            break
        outcomes, across = map(np.asarray, test(lows, highs))
        counts["boxes"] += len(lows)
        counts["proved"] += int(np.sum(outcomes == PROVED)) << (deepest - depth)
        rest = outcomes != PROVED
        if depth == deepest:
            counts["refuted"] += int(np.sum(outcomes == REFUTED))
            counts["open"] += int(np.sum(outcomes == OPEN))
            break
        lows, highs = _halved(lows[rest], highs[rest], across[rest])
    return counts


def _halved(lows: np.ndarray, highs: np.ndarray, across: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Both halves of each box across one input of each, beside each other."""
    rows = np.arange(len(lows))
    middle = (lows[rows, across] + highs[rows, across]) / 2
    left, right = highs.copy(), lows.copy()
    left[rows, across], right[rows, across] = middle, middle
    return np.stack([lows, right], 1).reshape(-1, lows.shape[1]), np.stack([left, highs], 1).reshape(-1, lows.shape[1])


def over_boxes(inputs: tuple[str, ...], test: Callable[[Case], Test], deepest: int, sentence: str) -> Evaluation:
    """Campaign of kind ``box``: a property proved over every part of a box, cell by cell.

    Parameters
    ----------
    inputs : tuple of str
        The first two are the sides of the figure.
    test : callable
        ``case -> test`` of `branch`, over inputs in this order.
    deepest : int
        How often a cell is halved at most.
    sentence : str
        The property, for people.
    """

    def block(case: Case, of: Block) -> Columns:
        cells, judge = of.cells(), test(case)
        ends = {side: np.array([[cell[name][k] for name in inputs] for cell in cells]) for k, side in enumerate("lh")}
        counts = [branch(low, high, judge, deepest) for low, high in zip(ends["l"], ends["h"], strict=True)]
        sides = {
            f"{name}_{end}": ends[end[0]][:, k].tolist() for k, name in enumerate(inputs) for end in ("low", "high")
        }
        return {**sides, **{key: [one[key] for one in counts] for key in ("proved", "refuted", "open", "boxes")}}

    def count(columns: Columns) -> dict[str, int]:
        whole = sum(int(p == 1 << deepest) for p in columns["proved"])
        return {"cells_proved": whole, **{k: int(sum(columns[k])) for k in ("proved", "refuted", "open", "boxes")}}

    def findings(plan: Plan, counts: Mapping[str, int]) -> dict[str, Any]:
        parts = plan.points << deepest
        answers = {key: f"{key}: {counts[key] / parts:.6f} of the volume" for key in ("proved", "refuted", "open")}
        holds = "holds over the whole box" if counts["proved"] == parts else "holds over the part proved"
        return {"property": f"{sentence}: {holds}", **answers, "parts": parts}

    def draw(figure: Any, plan: Plan, rows: Iterator[Mapping[str, np.ndarray]]) -> None:
        _draw(figure, plan, rows, deepest)

    sides = {f"{name}_{end}": "float64" for name in inputs for end in ("low", "high")}
    columns = {**sides, **dict.fromkeys(("proved", "refuted", "open", "boxes"), "int64")}
    return Evaluation("box", inputs, columns, block, count, findings, draw)


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
