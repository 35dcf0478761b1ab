"""Numbers over a grid of inputs."""

from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np

from gainsay.campaigns.plan import Block, Columns, Evaluation, Plan
from gainsay.tables import Case


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
            _draw_plane(figure, axes, plan, quantity, np.concatenate([batch[quantity] for batch in rows]), holds)
            return
        for batch in rows:
            axes.plot(batch["index"], batch[quantity], ".", color="C0", markersize=2)
        axes.axhline(holds, color="0.4", linewidth=0.8)
        axes.set_xlabel("point")
        axes.set_ylabel(quantity)

    columns = {**dict.fromkeys(inputs, "float64"), quantity: "float64"}
    return Evaluation("scan", inputs, columns, block, count, findings, draw)


def _draw_plane(figure: Any, axes: Any, plan: Plan, quantity: str, values: np.ndarray, holds: float) -> None:
    """Numbers over two inputs in colour, and the line on which they reach the bound."""
    sides = [
        [float(axis.value(k, count)) for k in range(count)] for axis, count in zip(plan.axes, plan.counts, strict=True)
    ]
    # the second input runs fastest
    plane = values.reshape(plan.counts).T
    shown = axes.pcolormesh(*sides, plane, shading="nearest", cmap="viridis", rasterized=True)
    if plane.min() < holds < plane.max():
        axes.contour(*sides, plane, levels=[holds], colors="white")
    for side, axis in zip("xy", plan.axes, strict=True):
        getattr(axes, f"set_{side}label")(axis.name)
        getattr(axes, f"set_{side}scale")("log" if axis.logarithmic else "linear")
    axes.grid(False)
    figure.colorbar(shown, ax=axes, label=f"{quantity}, line at {holds:g}")
