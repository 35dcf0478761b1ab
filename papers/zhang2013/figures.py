"""What the captions of Figures 1 to 3 announce, drawn from the logs (the pictures are lost), and two of ours."""

from collections.abc import Mapping, Sequence

from matplotlib.figure import Figure

from gainsay.figures import FigureSpec, compare, finish, panels
from gainsay.logs import Log
from gainsay.tables import Case

#: what is shown of the attitude, of the estimate, and at both ends of a run, s
_SHOWN, _ESTIMATE, _WINDOW = 100.0, 50.0, 20.0
READINGS = (
    ("nominal", "$K x$ delayed, $p(0) = 0$", "nominal"),
    ("input_delayed_matched", "input delayed, $p(0) = -L x(0)$", "perturbed"),
    ("no_observer", "no observer", "comparison"),
)


#: lies on the first reading for most of the run
DASHED = ("input_delayed_matched",)


def _readings(
    name: str, label: str, topic: str, field: str, until: float, named: Sequence[tuple[str, str, str]]
) -> FigureSpec:
    """One field in the readings of the text."""

    def draw(figure: Figure, logs: Mapping[str, Log], case: Case) -> None:
        grid = panels(figure, [label])
        compare(grid[0], logs, topic, field, named, until=until, dashed=DASHED)
        finish(figure, grid)

    return FigureSpec(name, tuple(run for run, _, _ in named), draw)


def designs(figure: Figure, logs: Mapping[str, Log], case: Case) -> None:
    """Draw the printed controller beside designs of ours."""
    grid = panels(figure, ["pitch angle [mrad]", r"$w_2 - \hat w_2$ [N m]"], columns=2, share_time=False)
    named = (
        ("nominal", "printed", "nominal"),
        ("repaired", "repaired", "axis_3"),
        ("resynthesised", "least squares", "comparison"),
    )
    compare(grid[0], logs, "/spacecraft/attitude_mrad", "angle", named, until=_SHOWN)
    behind = (named[2], named[0], named[1])  # the largest first, and last what lies on the printed one
    compare(grid[1], logs, "/observer", "error", behind, until=_ESTIMATE, dashed=("repaired",))
    finish(figure, grid)


def refused(figure: Figure, logs: Mapping[str, Log], case: Case) -> None:
    """Draw the first and the last seconds of the design that the LMIs accept and the flexible plant refuses."""
    named, end = (("fast", r"least $\gamma$", "nominal"),), float(logs["fast"].duration)
    labels = ["pitch angle [mrad]"] * 2 + [r"torque of the modes $w_2$ [N m]"] * 2
    titles = [f"first {_WINDOW:g} s", f"last {_WINDOW:g} s"]
    grid = panels(figure, labels, titles=titles, columns=2, share_time=False)
    topics = (("/spacecraft/attitude_mrad", "angle"), ("/disturbance", "w2"))
    for row, (topic, field) in enumerate(topics):
        for column, (since, until) in enumerate(((0.0, _WINDOW), (end - _WINDOW, end))):
            compare(grid[2 * row + column], logs, topic, field, named, since=since, until=until)
    grid[3].set_ylim(grid[2].get_ylim())
    finish(figure, grid[2:])


FIGURES = (
    _readings("figure_1", "pitch angle [mrad]", "/spacecraft/attitude_mrad", "angle", _SHOWN, READINGS),
    _readings("figure_2", "pitch rate [mrad/s]", "/spacecraft/rate_mrad_s", "rate", _SHOWN, READINGS),
    _readings("figure_3", r"$w_2 - \hat w_2$ [N m]", "/observer", "error", _ESTIMATE, READINGS[:2]),
    FigureSpec("designs", ("nominal", "repaired", "resynthesised"), designs),
    FigureSpec("refused", ("fast",), refused, 4.2),
)
