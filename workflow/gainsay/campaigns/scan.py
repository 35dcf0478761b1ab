"""Numbers over a grid of inputs."""

from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np

from gainsay.campaigns.plan import Block, Columns, Evaluation, Plan
from gainsay.tables import Case

#: points that a figure over their number shows at most
_DOTS = 20_000


def grid_scan(
    inputs: tuple[str, ...], quantity: str, evaluate: Callable[[Case, list[dict[str, str]]], np.ndarray], holds: float
) -> Evaluation:
    """Campaign of kind ``scan``: a number at each point of a grid, and how many are at most a bound.

    Parameters
    ----------
    inputs : tuple of str
    quantity : str
        Name of the number: a column of the results.
    evaluate : callable
        ``(case, points) -> array``: the points of one block, inputs as decimals.
    holds : float
        Bound against which the numbers are counted.
    """

    def block(case: Case, of: Block) -> Columns:
        points = of.points()
        values = np.asarray(evaluate(case, points), dtype=float)
        return {**{name: [float(p[name]) for p in points] for name in inputs}, quantity: values.tolist()}

    def count(columns: Columns) -> dict[str, int]:
        values = np.asarray(columns[quantity])
        return {"within": int(np.sum(values <= holds)), "beyond": int(np.sum(~(values <= holds)))}

    def findings(plan: Plan, counts: Mapping[str, int]) -> dict[str, Any]:
        return {"within": f"{counts['within']} of {plan.points} at most {holds:g}"}

    def draw(figure: Any, plan: Plan, rows: Iterator[Mapping[str, np.ndarray]]) -> None:
        axes = figure.subplots()
        if len(plan.axes) == 2:
            _draw_plane(figure, axes, plan, quantity, rows, holds)
            return
        step = -(-plan.points // _DOTS)
        for batch in rows:
            shown = batch["index"] % step == 0
            axes.plot(batch["index"][shown], batch[quantity][shown], ".", color="C0", markersize=2)
        axes.axhline(holds, color="0.4", linewidth=0.8)
        axes.set_xlabel("point")
        axes.set_ylabel(quantity)

    columns = {**dict.fromkeys(inputs, "float64"), quantity: "float64"}
    return Evaluation("scan", inputs, columns, block, count, findings, draw)


def _draw_plane(
    figure: Any, axes: Any, plan: Plan, quantity: str, rows: Iterator[Mapping[str, np.ndarray]], holds: float
) -> None:
    """Numbers over two inputs in colour, and the line on which they reach the bound."""
    sides = plan.side(0), plan.side(1)
    plane = np.empty((len(sides[1]), len(sides[0])))
    for batch in rows:
        i, j = plan.places(batch["index"])
        shown = (i % plan.step == 0) & (j % plan.step == 0)
        plane[j[shown] // plan.step, i[shown] // plan.step] = batch[quantity][shown]
    mesh = axes.pcolormesh(*sides, plane, shading="nearest", cmap="viridis", rasterized=True)
    if plane.min() < holds < plane.max():
        axes.contour(*sides, plane, levels=[holds], colors="white")
    for number, (side, axis) in enumerate(zip("xy", plan.axes, strict=True)):
        getattr(axes, f"set_{side}label")(plan.label(number))
        getattr(axes, f"set_{side}scale")("log" if axis.logarithmic else "linear")
    axes.grid(False)
    figure.colorbar(mesh, ax=axes, label=f"{quantity}, line at {holds:g}")
