"""What all figures share, on a made-up figure: places are asked of matplotlib's own renderer."""

from types import SimpleNamespace

import matplotlib
import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from gainsay.figures import FigureSpec, bound, curve, finish, panels, save
from gainsay.figures.style import STYLE, width_of
from gainsay.logs.palette import role

TIME = np.linspace(0.0, 10.0, 200)


def case_of(journal):
    return SimpleNamespace(paper=SimpleNamespace(journal=journal))


def draw(figure, logs=None, case=None):
    grid = panels(figure, ["thrust [N]", "norm [N]", "rate [deg/s]", "angle [deg]"], titles=["a", "b"], columns=2)
    for number, panel in enumerate(grid, start=1):
        curve(panel, TIME, 50.0 * np.sin(TIME * number), "axis_1", "x")
        curve(panel, TIME, 50.0 * np.cos(TIME * number), "axis_2", "y")
    bound(grid[0], 40.0, "40 N (5)")
    bound(grid[1], 30.0, "u_max", both=False)
    bound(grid[2], 5.0, "5 s", upright=True)
    finish(figure, grid)


@pytest.fixture
def figure():
    with matplotlib.rc_context(STYLE):
        made = Figure(figsize=(6.9, 3.0), layout="constrained")
        FigureCanvasAgg(made)
        draw(made)
        made.canvas.draw()
        yield made


def test_the_legend_names_each_curve_once_and_lies_on_no_panel(figure):
    (legend,) = figure.legends
    assert [text.get_text() for text in legend.get_texts()] == ["x", "y"]
    place = legend.get_window_extent()
    assert not any(place.overlaps(panel.get_tightbbox()) for panel in figure.axes)
    assert not any(panel.get_legend() for panel in figure.axes)


def test_every_panel_says_what_it_shows(figure):
    assert [panel.get_ylabel() for panel in figure.axes] == ["thrust [N]", "norm [N]", "rate [deg/s]", "angle [deg]"]
    assert [panel.get_xlabel() for panel in figure.axes] == ["", "", "time [s]", "time [s]"]
    assert all(panel.get_xlim() == (0.0, 10.0) for panel in figure.axes)  # no empty margins in time


def test_bounds_are_named_beside_the_panel(figure):
    first, second, third, _ = figure.axes
    assert [text.get_text() for text in first.texts] == ["40 N (5)", "\N{MINUS SIGN}40 N (5)"]
    assert [text.get_text() for text in second.texts] == ["u_max"]  # a norm has no lower bound
    inside = second.get_window_extent()
    assert second.texts[0].get_window_extent().x0 >= inside.x1
    assert third.texts[0].get_window_extent().y0 >= third.get_window_extent().y1
    drawn = [line for line in second.lines if line.get_color() == role("bound").on_light]
    assert [line.get_ydata()[0] for line in drawn] == [30.0]


def test_the_width_is_that_of_the_journal():
    """IEEE: two columns, 43 picas = 7.16 in; SpringerOpen: 170 mm."""
    assert width_of(case_of("IEEE Access, vol. 9")) == 7.16
    assert width_of(case_of("Advances in Difference Equations, 2013:142")) == pytest.approx(6.693, abs=1e-3)
    assert width_of(case_of("elsewhere")) == 6.9


def test_a_figure_is_the_same_to_the_byte(tmp_path):
    for name in ("one", "two"):
        save(FigureSpec("made_up", (), draw), {}, case_of("IEEE Access"), tmp_path / name)
    for ending in ("svg", "png"):
        files = [(tmp_path / name / f"made_up.{ending}").read_bytes() for name in ("one", "two")]
        assert files[0] == files[1] and len(files[0]) > 10000
