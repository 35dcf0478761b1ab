"""What all figures share: panels, curves in the colour of their role, named bounds, legends, deterministic files."""

import math
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure
from matplotlib.ticker import ScalarFormatter

from gainsay.figures.style import DASHES, RESOLUTION, STYLE, width_of
from gainsay.logs import Line, Log, Plot, lines
from gainsay.logs.palette import role
from gainsay.tables import Case

#: draws into a figure, from the logs by run and the tables
Draw = Callable[[Figure, Mapping[str, Log], Case], None]


class _PlainTicks(ScalarFormatter):
    """Numbers at ticks as plain text; a power of ten at the end of an axis alone is typeset, which takes a parser."""

    def __call__(self, x: float, pos: int | None = None) -> str:
        return super().__call__(x, pos).removeprefix(r"$\mathdefault{").removesuffix("}$")


@dataclass(frozen=True)
class FigureSpec:
    """A figure of a paper; its caption stands in paper.toml.

    Attributes
    ----------
    name : str
        File name without ending.
    runs : tuple of str
        The runs whose logs it is drawn from.
    draw : callable
        (figure, logs by run, case) -> None.
    height : float
        Inches.
    """

    name: str
    runs: tuple[str, ...]
    draw: Draw
    height: float = 3.0


def panels(
    figure: Figure, labels: Sequence[str], *, titles: Sequence[str] = (), columns: int = 1, share_time: bool = True
) -> list[Axes]:
    """Return one panel for each label.

    Parameters
    ----------
    figure : Figure
    labels : sequence of str
        Quantity and unit of each ordinate, e.g. ``pitch angle [deg]``.
    titles : sequence of str, optional
        What tells the panels apart, where the ordinate does not.
    columns : int
    share_time : bool
        Whether all panels have the same abscissa.
    """
    rows = -(-len(labels) // columns)
    axes = figure.subplots(rows, columns, sharex=share_time, squeeze=False).ravel()
    for panel, label in zip(axes, labels, strict=False):
        panel.set_ylabel(label)
    for panel, title in zip(axes, titles, strict=False):
        panel.set_title(title)
    for unused in axes[len(labels) :]:
        unused.set_visible(False)
    return list(axes[: len(labels)])


def curve(
    panel: Axes, x: np.ndarray, y: np.ndarray, role_name: str, label: str | None = None, *, dash: str = ""
) -> None:
    """Draw a curve in the colour and line style of its role; with another `dash` where it would cover one beneath."""
    style = role(role_name)
    line = DASHES[dash or style.dash]
    panel.plot(x, y, color=style.on_light, linestyle=line, linewidth=1.2 * style.width, label=label)


def ended(panel: Axes, x: float, text: str) -> None:
    """Say beside the last sample of a run that ends early why nothing follows it."""
    panel.annotate(
        text,
        (x, 0.5),
        xytext=(6, 0),
        xycoords=("data", "axes fraction"),
        textcoords="offset points",
        ha="left",
        va="center",
        fontsize=7,
    )


def curves(
    panel: Axes,
    log: Log,
    topic: str,
    fields: Sequence[str],
    *,
    labels: Sequence[str] = (),
    until: float | None = None,
) -> None:
    """Draw fields of a topic over time, the first in the colour of axis 1, the second of axis 2, and so on."""
    _draw_lines(panel, log, lines(topic, fields, labels=labels), until)


def _draw_lines(panel: Axes, log: Log, of: Sequence[Line], until: float | None) -> None:
    for line in of:
        signal = log[line.topic]
        shown = slice(None) if until is None else signal.time <= until
        curve(panel, signal.time[shown], signal.column(line.field)[shown], line.role, line.label)


def compare(
    panel: Axes,
    logs: Mapping[str, Log],
    topic: str,
    field: str,
    runs: Iterable[tuple[str, str, str]],
    *,
    since: float = 0.0,
    until: float = math.inf,
    dashed: Collection[str] = (),
) -> None:
    """Draw one field of several runs.

    Parameters
    ----------
    panel : Axes
    logs : mapping of str to Log
    topic, field : str
    runs : iterable of (str, str, str)
        Name of a run, what the legend says of it, and its colour role; the last one lies on top.
    since, until : float, optional
        What is shown, s.
    dashed : collection of str, optional
        Runs whose curves would cover another one beneath.
    """
    for run, label, role_name in runs:
        signal = logs[run][topic]
        shown = (signal.time >= since) & (signal.time <= until)
        dash = "dashed" if run in dashed else ""
        curve(panel, signal.time[shown], signal.column(field)[shown], role_name, label, dash=dash)


def figure_of_run(name: str, run: str, *plots: Plot, height: float = 3.0) -> FigureSpec:
    """Figure of one run that needs no drawing of its own: a panel for each plot, as a layout for viewers has it.

    Parameters
    ----------
    name, run : str
    *plots : Plot
        Curves, end of the time shown, and bounds, with the values that the run logs.
    height : float, optional
        Inches.
    """

    def draw(figure: Figure, logs: Mapping[str, Log], case: Case) -> None:
        log = logs[run]
        grid = panels(figure, [plot.title for plot in plots])
        for panel, plot in zip(grid, plots, strict=True):
            _draw_lines(panel, log, plot.lines, plot.until)
            for one in plot.bounds:
                for side, level in log.bounds[one.name].items():
                    if side in one.sides:
                        bound(panel, level, one.label or one.name, role_name=one.role, both=False)
        finish(figure, grid)

    return FigureSpec(name, (run,), draw, height)


def bound(
    panel: Axes, value: float, name: str, *, role_name: str = "bound", both: bool = True, upright: bool = False
) -> None:
    """Draw a bound as a dashed line, named beside the panel where no curve is.

    Parameters
    ----------
    panel : Axes
    value : float
    name : str
        Short: what it is, and its value where the paper prints it.
    role_name : str
        Colour: that of the curve that it bounds, where there are several.
    both : bool
        Whether it holds on both sides of zero; a norm has no lower bound.
    upright : bool
        Whether `value` is of the abscissa: a printed time.
    """
    look: dict[str, Any] = {"color": role(role_name).on_light, "linestyle": DASHES["dashed"], "linewidth": 0.8}
    if upright:
        panel.axvline(value, **look)
        panel.annotate(
            name,
            (value, 1.01),
            xycoords=("data", "axes fraction"),
            ha="center",
            va="bottom",
            fontsize=7,
            color=look["color"],
        )
        return
    for sign in (1, -1) if both else (1,):
        panel.axhline(sign * value, **look)
        panel.annotate(
            name if sign > 0 else f"\N{MINUS SIGN}{name}",
            (1.01, sign * value),
            xycoords=("axes fraction", "data"),
            ha="left",
            va="center",
            fontsize=7,
            color=look["color"],
        )


def finish(figure: Figure, panels_of_it: Sequence[Axes], *, x: str = "time [s]") -> None:
    """Name the abscissae of the lowest panels and put one legend above all of them, where it covers no curve."""
    entries: dict[str, Any] = {}
    for panel in panels_of_it:
        place = panel.get_subplotspec()
        if place is None or place.is_last_row() or not panel.get_shared_x_axes().get_siblings(panel)[1:]:
            panel.set_xlabel(x)
        for handle, label in zip(*panel.get_legend_handles_labels(), strict=True):
            entries.setdefault(label, handle)
    if entries:
        figure.legend([*entries.values()], [*entries], loc="outside upper left", ncols=min(len(entries), 5))


def save(spec: FigureSpec, logs: Mapping[str, Log], case: Case, folder: Path) -> None:
    """Draw a figure and write it as SVG, which says what it is drawn from, and PNG, without any date."""
    folder.mkdir(parents=True, exist_ok=True)
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(width_of(case), spec.height), layout="constrained")
        spec.draw(figure, logs, case)
        for axis in (axis for panel in figure.axes for axis in (panel.xaxis, panel.yaxis)):
            if type(axis.get_major_formatter()) is ScalarFormatter:
                axis.set_major_formatter(_PlainTicks())
        _lay_out(figure)
        source = ", ".join(f"logs/{run}.mcap" for run in spec.runs) or "quantities.csv"
        svg, png = (folder / f".{spec.name}.{ending}" for ending in ("svg", "png"))
        figure.dpi = RESOLUTION
        FigureCanvasSVG(figure).print_svg(svg, metadata={"Date": None, "Creator": None, "Source": source})
        figure.dpi = RESOLUTION  # an SVG is drawn in points
        FigureCanvasAgg(figure).print_png(png, metadata={"Software": None})
        for temporary in (svg, png):
            temporary.replace(folder / temporary.name.removeprefix("."))


def _lay_out(figure: Figure) -> None:
    """Lay a figure out once for all of its files, in points; `savefig` would draw it for that before each file."""
    FigureCanvasSVG(figure)  # whose widths of text count
    figure.dpi = FigureCanvasSVG.fixed_dpi
    engine = figure.get_layout_engine()
    if engine is not None:
        engine.execute(figure)
    figure.set_layout_engine("none")
