"""What all figures share, on a made-up figure: places are asked of matplotlib's own renderer."""

from types import SimpleNamespace

import matplotlib
import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from gainsay.figures import FigureSpec, bound, compare, curve, figure_of_run, finish, panels, save
from gainsay.figures.style import STYLE, width_of
from gainsay.logs import Bound, LogWriter, Plot, lines, read_log
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


def sine_log(path):
    with LogWriter(path, provenance={}) as log:
        log.signal("/state", {"x": "N", "y": "N"}, TIME, np.column_stack([np.sin(TIME), np.cos(TIME)]))
        log.bound("thrust", "N", lower=-0.5, upper=0.75)
    return read_log(path)


def drawn(draw):
    with matplotlib.rc_context(STYLE):
        made = Figure(figsize=(6.9, 3.0), layout="constrained")
        FigureCanvasAgg(made)
        draw(made)
    return made


def test_a_figure_of_one_run_shows_the_curves_and_the_bounds_of_its_plots(tmp_path):
    log = sine_log(tmp_path / "run.mcap")
    plots = (
        Plot("thrust [N]", lines("/state", "xy", labels=("along", "across")), (Bound("thrust", "5"),), until=5.0),
        Plot("across [N]", lines("/state", "y")),
    )
    spec = figure_of_run("figure_1", "nominal", *plots)
    assert (spec.name, spec.runs) == ("figure_1", ("nominal",))
    first, second = drawn(lambda figure: spec.draw(figure, {"nominal": log}, None)).axes
    assert first.get_ylabel() == "thrust [N]"
    along, across, *bounds = first.get_lines()
    assert (along.get_label(), along.get_color()) == ("along", role("axis_1").on_light)
    assert across.get_xdata().max() <= 5.0 < second.get_lines()[0].get_xdata().max()
    assert sorted(line.get_ydata()[0] for line in bounds) == [-0.5, 0.75]


def test_runs_are_compared_within_the_times_shown(tmp_path):
    logs = {name: sine_log(tmp_path / f"{name}.mcap") for name in ("a", "b")}
    named = (("a", "first", "nominal"), ("b", "second", "perturbed"))

    def both(figure):
        compare(panels(figure, ["x [N]"])[0], logs, "/state", "x", named, since=2.0, until=4.0, dashed=("a",))

    (panel,) = drawn(both).axes
    first, second = panel.get_lines()
    assert (first.get_linestyle(), second.get_label()) == ("--", "second")
    np.testing.assert_array_equal(first.get_xdata(), TIME[(TIME >= 2.0) & (TIME <= 4.0)])
