"""The figures of the paper, drawn from the logs alone."""

from collections.abc import Mapping

from matplotlib.figure import Figure

from gainsay.figures import FigureSpec, curves, finish, panels
from gainsay.logs import Log
from gainsay.tables import Case


def angle(figure: Figure, logs: Mapping[str, Log], case: Case) -> None:
    """Draw Figure 1."""
    (panel,) = drawn = panels(figure, ["Angle [rad]"])
    curves(panel, logs["nominal"], "/satellite/state", ("angle",))
    finish(figure, drawn)


FIGURES = (FigureSpec("figure_1", ("nominal",), angle),)
