"""Figures 2 to 5 of the paper, drawn again from the logs, and two of our own."""

from collections.abc import Mapping

from matplotlib.figure import Figure

from gainsay.figures import FigureSpec, bound, compare, curve, figure_of_run, finish, panels
from gainsay.logs import Log, Plot, lines
from gainsay.tables import Case

_TRANSIENT, _APPROACH = 20.0, 3000.0


def _velocities(topic: str, label: str, until: float) -> Plot:
    return Plot(label, lines(topic, ("vx", "vy", "vz"), labels=("$v_x$", "$v_y$", "$v_z$")), until=until)


def thrusts(figure: Figure, logs: Mapping[str, Log], case: Case) -> None:
    """Draw Figure 4: thrusts, the transient beside the whole approach, with the bounds of (5)."""
    labels = [f"$f_{axis}$ [N]" for axis in "xyz" for _ in range(2)]
    titles = [f"first {_TRANSIENT:g} s", f"first {_APPROACH:g} s"]
    grid = panels(figure, labels, titles=titles, columns=2, share_time=False)
    signal = logs["nominal"]["/chaser/thrust"]
    for index, axis in enumerate("xyz"):
        limit = case.number(f"thrust_max_{axis}")
        for column, until in enumerate((_TRANSIENT, _APPROACH)):
            panel = grid[2 * index + column]
            shown = signal.time <= until
            curve(panel, signal.time[shown], signal.column(axis)[shown], f"axis_{index + 1}")
            bound(panel, limit, f"{limit:g} N (5)")
    finish(figure, grid[-2:])


def trajectory(figure: Figure, logs: Mapping[str, Log], case: Case) -> None:
    """Draw Figure 5: the trajectory of the first 3000 s, in the orbital plane and out of it."""
    grid = panels(figure, ["along track y [m]", "out of plane z [m]"], columns=2, share_time=False)
    state = logs["nominal"]["/chaser/state"]
    shown = state.time <= _APPROACH
    x, y, z = (state.column(field)[shown] for field in "xyz")
    for panel, other in zip(grid, (y, z), strict=True):
        curve(panel, x, other, "truth", f"chaser, first {_APPROACH:g} s")
        panel.plot(x[:1], other[:1], marker="o", markersize=4, color="#1f1f1f", linestyle="none", label="start")
        panel.plot([0], [0], marker="+", markersize=9, color="#cc79a7", linestyle="none", label="target")
        panel.margins(x=0.05)
    finish(figure, grid, x="radial x [m]")


def starts(figure: Figure, logs: Mapping[str, Log], case: Case) -> None:
    """Draw thrust along y under three starts of the estimate that the text allows, whole and near the bounds."""
    titles = ["whole range", "near the bounds"]
    grid = panels(figure, ["$f_y$ [N]"] * 2, titles=titles, columns=2, share_time=False)
    named = (
        ("nominal", "estimate starts at the measured position", "nominal"),
        ("exact_start", "at the true state", "comparison"),
        ("blind_start", "at zero", "perturbed"),
    )
    limit = case.number("thrust_max_y")
    for panel in grid:
        compare(panel, logs, "/chaser/thrust", "y", named, until=_TRANSIENT)
        bound(panel, limit, f"{limit:g} N (5)", both=panel is grid[1])
    grid[1].set_ylim(-1.25 * limit, 1.25 * limit)
    finish(figure, grid)


def designs(figure: Figure, logs: Mapping[str, Log], case: Case) -> None:
    """Draw range and spent velocity increment of the printed controller and of our designs."""
    grid = panels(figure, ["range to the target [m]", "velocity increment so far [m/s]"], columns=2)
    named = (("nominal", "printed", "nominal"), ("repaired", "repaired", "axis_3"), ("lqr", "LQR", "comparison"))
    for panel, topic, field in zip(grid, ("/chaser/range", "/integrals"), ("range", "delta_v"), strict=True):
        compare(panel, logs, topic, field, named, until=_APPROACH)
    grid[0].set_yscale("log")
    grid[0].set_ylim(bottom=1e-3)
    grid[1].set_ylim(bottom=0)
    finish(figure, grid)


FIGURES = (
    figure_of_run(
        "figure_2", "nominal", _velocities("/observer/error", "velocity error of the estimate [m/s]", _TRANSIENT)
    ),
    figure_of_run("figure_3", "nominal", _velocities("/chaser/state", "relative velocity [m/s]", _APPROACH)),
    FigureSpec("figure_4", ("nominal",), thrusts, 5.0),
    FigureSpec("figure_5", ("nominal",), trajectory),
    FigureSpec("starts", ("nominal", "exact_start", "blind_start"), starts),
    FigureSpec("designs", ("nominal", "repaired", "lqr"), designs),
)
