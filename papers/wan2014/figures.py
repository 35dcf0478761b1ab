"""Figures 2 to 5 of the paper, drawn again from the logs, and two of our own."""

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure

from gainsay.figures import FigureSpec, bound, curve, curves, finish, panels
from gainsay.logs import Log
from gainsay.tables import Case

VELOCITIES = ("vx", "vy", "vz")
_TRANSIENT, _APPROACH = 20.0, 3000.0


def estimation_error(figure: Figure, logs: Mapping[str, Log], case: Case) -> None:
    """Draw Figure 2: velocity components of the error vector."""
    (panel,) = panels(figure, ["Velocity error of the estimate [m/s]"])
    curves(panel, logs["nominal"], "/observer/error", VELOCITIES, until=_TRANSIENT)
    finish(panel)


def velocities(figure: Figure, logs: Mapping[str, Log], case: Case) -> None:
    """Draw Figure 3: relative velocities."""
    (panel,) = panels(figure, ["Relative velocity [m/s]"])
    curves(panel, logs["nominal"], "/chaser/state", VELOCITIES, until=_APPROACH)
    finish(panel)


def thrusts(figure: Figure, logs: Mapping[str, Log], case: Case) -> None:
    """Draw Figure 4: thrusts, the transient beside the whole approach, with the bounds of (5)."""
    titles = [f"Thrust along {axis} [N]" for axis in "xyz" for _ in range(2)]
    grid = panels(figure, titles, columns=2, share_time=False)
    signal = logs["nominal"]["/chaser/thrust"]
    for index, axis in enumerate("xyz"):
        for column, until in enumerate((_TRANSIENT, _APPROACH)):
            panel = grid[2 * index + column]
            shown = signal.time <= until
            curve(panel, signal.time[shown], signal.column(axis)[shown], f"axis_{index + 1}")
            bound(panel, case.number(f"thrust_max_{axis}"))
            finish(panel, legend=False, x="time [s]" if index == 2 else "")


def trajectory(figure: Figure, logs: Mapping[str, Log], case: Case) -> None:
    """Draw Figure 5: the trajectory of the first 3000 s, in the orbital plane and out of it."""
    left, right = panels(figure, ["Along track y over radial x [m]", "Out of plane z over radial x [m]"], columns=2,
                         share_time=False)  # fmt: skip
    state = logs["nominal"]["/chaser/state"]
    shown = state.time <= _APPROACH
    x, y, z = (state.column(field)[shown] for field in "xyz")
    for panel, other in ((left, y), (right, z)):
        curve(panel, x, other, "truth", "chaser")
        panel.plot([0], [0], marker="+", markersize=9, color="#cc79a7", linestyle="none", label="target")
        finish(panel, x="radial x [m]")


def starts(figure: Figure, logs: Mapping[str, Log], case: Case) -> None:
    """Draw thrust along y under three starts of the estimate that the paper's text allows."""
    (panel,) = panels(figure, ["Thrust along y [N], by the start of the estimate"])
    named = (("nominal", "measured position", "nominal"), ("exact_start", "true state", "comparison"),
             ("blind_start", "zero", "perturbed"))  # fmt: skip
    for run, label, role in named:
        signal = logs[run]["/chaser/thrust"]
        shown = signal.time <= _TRANSIENT
        curve(panel, signal.time[shown], signal.column("y")[shown], role, label)
    bound(panel, case.number("thrust_max_y"), "bound of (5)")
    panel.set_yscale("symlog", linthresh=40)
    finish(panel)


def designs(figure: Figure, logs: Mapping[str, Log], case: Case) -> None:
    """Draw range and spent velocity increment of the printed controller and of our designs."""
    left, right = panels(figure, ["Range to the target [m]", "Velocity increment so far [m/s]"], columns=2)
    named = (("nominal", "printed", "nominal"), ("repaired", "repaired", "axis_3"), ("lqr", "LQR", "comparison"))
    for run, label, role in named:
        for panel, topic, field in ((left, "/chaser/range", "range"), (right, "/integrals", "delta_v")):
            signal = logs[run][topic]
            shown = signal.time <= _APPROACH
            curve(panel, signal.time[shown], np.maximum(signal.column(field)[shown], 1e-3), role, label)
    left.set_yscale("log")
    for panel in (left, right):
        finish(panel)


FIGURES = (
    FigureSpec("figure_2", ("nominal",), estimation_error),
    FigureSpec("figure_3", ("nominal",), velocities),
    FigureSpec("figure_4", ("nominal",), thrusts, 5.0),
    FigureSpec("figure_5", ("nominal",), trajectory),
    FigureSpec("starts", ("nominal", "exact_start", "blind_start"),
               starts),
    FigureSpec("designs", ("nominal", "repaired", "lqr"),
               designs),
)  # fmt: skip
