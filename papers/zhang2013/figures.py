"""What the captions of Figures 1 to 3 announce, drawn from the logs (the pictures are lost), and two of ours."""

from collections.abc import Mapping

from matplotlib.figure import Figure

from gainsay.figures import FigureSpec, curve, finish, panels
from gainsay.logs import Log
from gainsay.tables import Case

_SHOWN, _ESTIMATE = 100.0, 50.0
READINGS = (
    ("nominal", "K x delayed, p(0) = 0", "nominal"),
    ("input_delayed_matched", "input delayed, p(0) = -L x(0)", "perturbed"),
    ("no_observer", "no observer", "comparison"),
)


def _draw(
    figure: Figure, logs: Mapping[str, Log], title: str, topic: str, field: str, until: float, runs: tuple
) -> None:
    (panel,) = panels(figure, [title])
    for run, label, role in runs:
        signal = logs[run][topic]
        shown = signal.time <= until
        curve(panel, signal.time[shown], signal.column(field)[shown], role, label)
    finish(panel)


def angle(figure: Figure, logs: Mapping[str, Log], case: Case) -> None:
    """Draw Figure 1: the attitude angle."""
    _draw(figure, logs, "Pitch angle [rad]", "/spacecraft/attitude", "angle", _SHOWN, READINGS)


def rate(figure: Figure, logs: Mapping[str, Log], case: Case) -> None:
    """Draw Figure 2: the attitude angle rate."""
    _draw(figure, logs, "Pitch rate [rad/s]", "/spacecraft/rate", "rate", _SHOWN, READINGS)


def estimation(figure: Figure, logs: Mapping[str, Log], case: Case) -> None:
    """Draw Figure 3: the error of the estimated vibration torque."""
    runs = tuple(reading for reading in READINGS if reading[0] != "no_observer")
    _draw(figure, logs, "Estimation error w2 - w2hat [N m]", "/observer", "error", _ESTIMATE, runs)


def designs(figure: Figure, logs: Mapping[str, Log], case: Case) -> None:
    """Draw the printed controller beside designs of ours."""
    left, right = panels(figure, ["Pitch angle [rad]", "Estimation error [N m]"], columns=2)
    runs = (
        ("nominal", "printed", "nominal"),
        ("repaired", "repaired", "axis_3"),
        ("resynthesised", "least squares", "comparison"),
    )
    for run, label, role in runs:
        for panel, topic, field, until in (
            (left, "/spacecraft/attitude", "angle", _SHOWN),
            (right, "/observer", "error", _ESTIMATE),
        ):
            signal = logs[run][topic]
            shown = signal.time <= until
            curve(panel, signal.time[shown], signal.column(field)[shown], role, label)
    for panel in (left, right):
        finish(panel)


def refused(figure: Figure, logs: Mapping[str, Log], case: Case) -> None:
    """Draw the design that the LMIs accept and the flexible plant refuses."""
    left, right = panels(figure, ["Pitch angle [rad]", "Torque of the modes w2 [N m]"], columns=2)
    for panel, topic, field in ((left, "/spacecraft/attitude", "angle"), (right, "/disturbance", "w2")):
        signal = logs["fast"][topic]
        curve(panel, signal.time, signal.column(field), "perturbed", "least gamma")
        finish(panel)


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
    ),
)
