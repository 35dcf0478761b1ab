"""What all figures share: size, type, colour by role, bounds, deterministic files."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from gainsay.logs import Log
from gainsay.logs.palette import role
from gainsay.tables import Case

_STYLE = {
    "font.family": "DejaVu Sans",
    "font.size": 9,
    "axes.titlesize": 9,
    "axes.titlelocation": "left",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.alpha": 0.25,
    "grid.linewidth": 0.5,
    "legend.frameon": False,
    "legend.fontsize": 8,
    "lines.linewidth": 1.3,
    "svg.hashsalt": "gainsay",
    "path.simplify": True,
    "path.simplify_threshold": 0.1,
}
_DASHES = {"solid": "-", "dashed": (0, (5, 2)), "dotted": (0, (1, 1.5))}
#: width of a figure across both columns of a page, inches
WIDTH = 6.9


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
    draw: Callable[[Figure, Mapping[str, Log], Case], None]
    height: float = 3.2


def panels(figure: Figure, titles: Sequence[str], *, columns: int = 1, share_time: bool = True) -> list[Axes]:
    """Return one panel a title, each titled with its quantity and unit."""
    rows = -(-len(titles) // columns)
    axes = figure.subplots(rows, columns, sharex=share_time, squeeze=False).ravel()
    for panel, title in zip(axes, titles, strict=False):
        panel.set_title(title)
    for unused in axes[len(titles) :]:
        unused.set_visible(False)
    return list(axes[: len(titles)])


def curve(panel: Axes, x: np.ndarray, y: np.ndarray, role_name: str, label: str | None = None) -> None:
    """Draw a curve in the colour and line style of its role."""
    style = role(role_name)
    panel.plot(x, y, color=style.on_light, linestyle=_DASHES[style.dash], linewidth=1.3 * style.width, label=label)


def curves(
    panel: Axes, log: Log, topic: str, fields: Sequence[str], *, labels: Sequence[str] = (), until: float | None = None,
    suffix: str = "",
) -> None:  # fmt: skip
    """Draw fields of a topic over time, the first in the colour of axis 1, the second of axis 2, and so on."""
    signal = log[topic]
    shown = slice(None) if until is None else signal.time <= until
    for index, field in enumerate(fields):
        label = labels[index] if labels else field
        curve(panel, signal.time[shown], signal.column(field)[shown], f"axis_{index + 1}{suffix}", label)


def bound(panel: Axes, value: float, label: str | None = None) -> None:
    """Draw a bound as a dashed line on both sides of zero."""
    style = role("bound")
    for sign, text in ((1, label), (-1, None)):
        panel.axhline(sign * value, color=style.on_light, linestyle=_DASHES["dashed"], linewidth=0.8, label=text)


def finish(panel: Axes, *, x: str = "time [s]", legend: bool = True) -> None:
    """Name the abscissa and add the legend."""
    panel.set_xlabel(x)
    if legend:
        panel.legend(loc="best", ncols=2)


def save(spec: FigureSpec, logs: Mapping[str, Log], case: Case, folder: Path) -> None:
    """Draw a figure and write it as SVG and PNG, without any date."""
    folder.mkdir(parents=True, exist_ok=True)
    with matplotlib.rc_context(_STYLE):
        figure = Figure(figsize=(WIDTH, spec.height), layout="constrained")
        FigureCanvasAgg(figure)
        spec.draw(figure, logs, case)
        for ending, metadata in (("svg", {"Date": None, "Creator": None}), ("png", {"Software": None})):
            temporary = folder / f".{spec.name}.{ending}"
            figure.savefig(temporary, format=ending, dpi=200, metadata=metadata)
            temporary.replace(folder / f"{spec.name}.{ending}")
