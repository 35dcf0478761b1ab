"""Displacement and control over time."""

from collections.abc import Mapping

from matplotlib.figure import Figure

from gainsay.figures import FigureSpec, curves, finish, panels
from gainsay.logs import Log
from gainsay.tables import Case


def both(figure: Figure, logs: Mapping[str, Log], case: Case) -> None:
    """Draw the two curves above each other."""
    above, below = drawn = panels(figure, ["Displacement [m]", "Control [N]"])
    curves(above, logs["nominal"], "/mass", ("x",))
    curves(below, logs["nominal"], "/control", ("u",))
    finish(figure, drawn)


FIGURES = (FigureSpec("figure_1", ("nominal",), both),)
