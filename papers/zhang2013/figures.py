"""What the captions of Figures 1 to 3 announce, drawn from the logs (the pictures are lost), and two of ours."""

from collections.abc import Iterable, Mapping

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gainsay.figures import FigureSpec, curve, finish, panels
from gainsay.logs import Log
from gainsay.tables import Case

#: what is shown of the attitude, of the estimate, and at both ends of a run, s
_SHOWN, _ESTIMATE, _WINDOW = 100.0, 50.0, 20.0
READINGS = (
    ("nominal", "$K x$ delayed, $p(0) = 0$", "nominal"),
    ("input_delayed_matched", "input delayed, $p(0) = -L x(0)$", "perturbed"),
    ("no_observer", "no observer", "comparison"),
)


def _draw(
    panel: Axes,
    logs: Mapping[str, Log],
    topic: str,
    field: str,
    shown: tuple[float, float],
    named: Iterable[tuple[str, str, str]],
) -> None:
    """Draw one field of several runs, each (run, label, role), between two times."""
    for run, label, role in named:
        signal = logs[run][topic]
        inside = (signal.time >= shown[0]) & (signal.time <= shown[1])
        dash = "dashed" if role == "perturbed" else ""  # it lies on the first reading for most of the run
        curve(panel, signal.time[inside], signal.column(field)[inside], role, label, dash=dash)


def angle(figure: Figure, logs: Mapping[str, Log], case: Case) -> None:
    """Draw Figure 1: the attitude angle."""
    grid = panels(figure, ["pitch angle [mrad]"])
    _draw(grid[0], logs, "/spacecraft/attitude_mrad", "angle", (0.0, _SHOWN), READINGS)
    finish(figure, grid)


def rate(figure: Figure, logs: Mapping[str, Log], case: Case) -> None:
    """Draw Figure 2: the attitude angle rate."""
    grid = panels(figure, ["pitch rate [mrad/s]"])
    _draw(grid[0], logs, "/spacecraft/rate_mrad_s", "rate", (0.0, _SHOWN), READINGS)
    finish(figure, grid)


def estimation(figure: Figure, logs: Mapping[str, Log], case: Case) -> None:
    """Draw Figure 3: the error of the estimated vibration torque."""
    named = tuple(reading for reading in READINGS if reading[0] != "no_observer")
    grid = panels(figure, [r"$w_2 - \hat w_2$ [N m]"])
    _draw(grid[0], logs, "/observer", "error", (0.0, _ESTIMATE), named)
    finish(figure, grid)


def designs(figure: Figure, logs: Mapping[str, Log], case: Case) -> None:
    """Draw the printed controller beside designs of ours."""
    grid = panels(figure, ["pitch angle [mrad]", r"$w_2 - \hat w_2$ [N m]"], columns=2, share_time=False)
    named = (
        ("nominal", "printed", "nominal"),
        ("repaired", "repaired", "axis_3"),
        ("resynthesised", "least squares", "comparison"),
    )
    _draw(grid[0], logs, "/spacecraft/attitude_mrad", "angle", (0.0, _SHOWN), named)
    _draw(grid[1], logs, "/observer", "error", (0.0, _ESTIMATE), named[::-1])  # the largest behind
    finish(figure, grid)


def refused(figure: Figure, logs: Mapping[str, Log], case: Case) -> None:
    """Draw the first and the last seconds of the design that the LMIs accept and the flexible plant refuses."""
    named, end = (("fast", r"least $\gamma$", "nominal"),), float(logs["fast"].duration)
    labels = ["pitch angle [mrad]"] * 2 + [r"torque of the modes $w_2$ [N m]"] * 2
    titles = [f"first {_WINDOW:g} s", f"last {_WINDOW:g} s"]
    grid = panels(figure, labels, titles=titles, columns=2, share_time=False)
    topics = (("/spacecraft/attitude_mrad", "angle"), ("/disturbance", "w2"))
    for row, (topic, field) in enumerate(topics):
        for column, shown in enumerate(((0.0, _WINDOW), (end - _WINDOW, end))):
            _draw(grid[2 * row + column], logs, topic, field, shown, named)
    grid[3].set_ylim(grid[2].get_ylim())
    finish(figure, grid[2:])


FIGURES = (
    FigureSpec(
        "figure_1",
        ("nominal", "input_delayed_matched", "no_observer"),
        angle,
    ),
    FigureSpec(
        "figure_2",
        ("nominal", "input_delayed_matched", "no_observer"),
        rate,
    ),
    FigureSpec(
        "figure_3",
        ("nominal", "input_delayed_matched"),
        estimation,
    ),
    FigureSpec(
        "designs",
        ("nominal", "repaired", "resynthesised"),
        designs,
    ),
    FigureSpec(
        "refused",
        ("fast",),
        refused,
        4.2,
    ),
)
