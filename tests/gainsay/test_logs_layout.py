import colorsys
import json
import math
from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest

from gainsay.errors import InputError, LogError
from gainsay.logs import (
    Bound,
    Columns,
    EventLog,
    Layout,
    Line,
    LogWriter,
    Measured,
    Plot,
    Rows,
    RunSpec,
    Scene,
    Tab,
    Text,
    default_layout,
    read_log,
    tab,
)
from gainsay.logs.check import check_layout, layout_problems
from gainsay.logs.eye import eye_of
from gainsay.logs.foxglove import foxglove_layout
from gainsay.logs.layout import bound_lines, playback_speed
from gainsay.logs.palette import ROLES, in_plots, on_both, rgb, role
from gainsay.logs.shapes import Shapes
from tests.gainsay.demo_log import LAYOUT, write_demo


@pytest.fixture(scope="module")
def log(tmp_path_factory):
    return read_log(write_demo(tmp_path_factory.mktemp("demo") / "spiral.mcap", samples=101))


def one(panel):
    return Layout("demo", (Tab("T", panel),))


def plot(topic="/chaser/thrust", field="x", title="Thrust [N]", **kwargs):
    return Plot(title, (Line(topic, field, "f", "axis_1"),), **kwargs)


def test_demo_layout_fits_its_log(log):
    check_layout(LAYOUT, log)


@pytest.mark.parametrize(
    ("panel", "words"),
    [
        (plot(topic="/chaser/thrusts"), "no signal /chaser/thrusts"),
        (plot(topic="/events"), "no signal /events"),
        (plot(topic="/scene/path"), "no signal /scene/path"),
        (plot(field="w"), "no field 'w' in /chaser/thrust"),
        (plot(title="Thrust [kN]"), r"/chaser/thrust\.x is in 'N'"),
        (plot(topic="/chaser/position"), r"/chaser/position\.x is in 'm'"),
        (plot(bounds=(Bound("thrust"),)), "no bound 'thrust'"),
        (Scene("S", "eci", elements=("path",)), "no frame 'eci'"),
        (Scene("S", "lvlh", elements=("paths",)), "no element 'paths'"),
        (Scene("S", "lvlh", axes=("chaser_lvlh",)), "no element 'axes_chaser_lvlh'"),
        (Scene("S", "lvlh", elements=("path",), axes=("x",), follow="x"), "no frame 'x'"),
        (Scene("S", "lvlh"), "nothing to draw"),
    ],
)
def test_what_does_not_resolve_is_named(log, panel, words):
    with pytest.raises(LogError, match=rf"spiral\.mcap: layout demo: .*{words}"):
        check_layout(one(panel), log)


def test_all_problems_are_counted(log):
    layout = one(Rows(plot(field="w"), plot(topic="/nothing")))
    assert len(layout_problems(layout, log)) == 2
    with pytest.raises(LogError, match=r"and 1 more"):
        check_layout(layout, log)


def test_empty_topics_events_and_loose_frames_are_found(tmp_path):
    with LogWriter(tmp_path / "a.mcap", provenance={}) as writing:
        writing.signal("/a", {"x": "m"}, [], np.empty((0, 1)))
        writing.transform("lvlh", "chaser", [0.0], [[0, 0, 0]])
        writing.transform("eci", "earth", [0.0], [[0, 0, 0]])
        writing.line("path", "earth", [[0, 0, 0], [1, 1, 1]], "truth")
    log = read_log(tmp_path / "a.mcap")
    assert layout_problems(one(plot("/a", "x", "A [m]")), log) == ["plot 'A [m]': no message on /a"]
    assert "no event" in layout_problems(one(EventLog()), log)[0]
    assert "'earth' of 'path' is not tied to 'lvlh'" in layout_problems(one(Scene("S", "lvlh", ("path",))), log)[0]


@pytest.mark.parametrize(
    "make",
    [
        lambda: plot(title="Thrust"),
        lambda: plot(title="[N]"),
        lambda: Plot("Thrust [N]", ()),
        lambda: Line("/a", "x", "x", "pink"),
        lambda: Line("/a", "x", "", "axis_1"),
        lambda: Line("/a", "x.y", "x", "axis_1"),
        lambda: Line("a", "x", "x", "axis_1"),
        lambda: Scene("S", "lvlh", follow="chaser"),
        lambda: Bound("thrust", sides=("left",)),
        lambda: Bound("thrust", role="pink"),
        lambda: Rows(),
        lambda: Rows(plot(), shares=(1, 2)),
        lambda: Columns(plot(), shares=(0,)),
        lambda: Layout("demo", ()),
        lambda: Layout("Demo 1", (Tab("A", plot()),)),
        lambda: Layout("demo", (Tab("A", plot()), Tab("A", plot()))),
        lambda: RunSpec("Run 1", print, print),
        lambda: Measured(1.0, "two\nlines"),
        lambda: Measured(1.0, "m", lower=2.0),
    ],
)
def test_wrong_declarations_are_refused(make):
    with pytest.raises(InputError):
        make()


def test_tabs_of_some_runs():
    layout = Layout("demo", (Tab("A", plot()), Tab("B", plot(), runs=("clipped",))))
    assert [tab.title for tab in layout.for_run("nominal").tabs] == ["A"]
    assert [tab.title for tab in layout.for_run("clipped").tabs] == ["A", "B"]


def leaves(tree):
    if isinstance(tree, str):
        return [tree]
    assert tree.keys() == {"direction", "first", "second", "splitPercentage"}
    assert tree["direction"] in ("row", "column")
    assert 0 < tree["splitPercentage"] < 100
    return leaves(tree["first"]) + leaves(tree["second"])


def test_foxglove_layout_has_every_panel_once_and_resolves(log):
    """The shape that Foxglove-compatible viewers ask for, and every path in it exists in the log."""
    made = json.loads(foxglove_layout(LAYOUT, log))
    assert made.keys() == {"configById", "globalVariables", "userNodes", "playbackConfig", "layout"}
    panels = made["configById"]
    tabs = panels[made["layout"]]["tabs"]
    assert [tab["title"] for tab in tabs] == ["Approach", "About"]
    first = panels[leaves(tabs[0]["layout"])[0]]
    assert first["foxglovePanelTitle"].startswith("demo spiral: ")
    shown = [name for tab in tabs for name in leaves(tab["layout"])]
    assert sorted([*shown, made["layout"]]) == sorted(panels)
    kinds = {Plot: "Plot", Scene: "3D", EventLog: "RosOut"}
    expected = [kinds[type(panel)] for panel in LAYOUT.panels() if not isinstance(panel, Text)]
    assert [name.split("!")[0] for name in shown] == expected
    for name, config in panels.items():
        for path in config.get("paths", []):
            topic, field = path["value"].rsplit(".", 1)
            assert field in log[topic].fields
        for topic in config.get("topics", {}):
            assert name.startswith("3D!")
            assert log.kind(topic) == "scene"
    values = [path["value"] for path in panels["Plot!plot2"]["paths"]]
    assert {f"/bounds/{b}.{s}" for b in ("thrust_xy", "thrust_z") for s in ("lower", "upper")} <= set(values)


def test_a_tab_of_text_alone_is_left_out(log):
    """Open Foxglove-compatible viewers have no panel for text; splits close over the gap."""
    page = Text("Page", "words")
    layout = Layout("demo", (Tab("A", Columns(page, page)), Tab("B", Rows(page, plot(), page, plot()))))
    (tab,) = json.loads(foxglove_layout(layout, log))["configById"]["Tab!tab1"]["tabs"]
    assert tab["title"] == "B"
    assert leaves(tab["layout"]) == ["Plot!plot1", "Plot!plot2"]


def test_plots_alone_and_tabs_come_before_the_page_about_all_runs():
    scene = Scene("S", "lvlh")
    layout = default_layout(
        "demo", "words", plot(), tab("Flight", plot(), scene=scene, runs=("a",)), look={"a": "this"}
    )
    response, flight, about = layout.tabs
    assert (response.content, flight.content) == (Rows(plot()), Columns(scene, Rows(plot())))
    assert (flight.title, flight.runs, layout.look) == ("Flight", ("a",), {"a": "this"})
    assert about.content == Columns(Text("About", "words"), EventLog())


def test_the_camera_looks_from_where_the_eye_is(log):
    """Foxglove's camera: -r sin(phi) sin(theta), -r sin(phi) cos(theta), r cos(phi) from the target."""
    scene = Scene("S", "lvlh", ("path",), direction=(3.0, -4.0, 1.2))
    camera = json.loads(foxglove_layout(one(scene), log))["configById"]["3D!3d1"]["cameraState"]
    phi, theta, r = math.radians(camera["phi"]), math.radians(camera["thetaOffset"]), camera["distance"]
    away = (-r * math.sin(phi) * math.sin(theta), -r * math.sin(phi) * math.cos(theta), r * math.cos(phi))
    eye = eye_of(scene, Shapes(log))
    assert camera["targetOffset"] == pytest.approx(eye.target)
    farther = np.subtract(eye.place, eye.target) * 1.35  # a panel of 3 to 4 shows less of the width than of the height
    assert away == pytest.approx(farther)
    assert np.array(away) / r == pytest.approx(np.array([3.0, -4.0, 1.2]) / math.sqrt(26.44))


def test_everything_drawn_is_seen_from_the_first(log):
    """Each point of the path lies inside a cone of the half angle 22.5 deg, the narrower of the viewers' cameras."""
    scene = Scene("S", "lvlh", ("path", "thrust"))
    eye = eye_of(scene, Shapes(log))
    points = log["/chaser/position"].values
    ahead = np.subtract(eye.target, eye.place) / np.linalg.norm(np.subtract(eye.target, eye.place))
    seen = points - eye.place
    angles = np.degrees(np.arccos(seen @ ahead / np.linalg.norm(seen, axis=1)))
    assert 5.0 < angles.max() < 22.5
    near = eye_of(Scene("S", "lvlh", ("chaser",), ("chaser",), follow="chaser"), Shapes(log))
    assert near.target == (0.0, 0.0, 0.0)
    assert np.linalg.norm(near.place) < 8000.0  # following, it is the body that counts, about 2 km wide


def test_the_first_tab_says_what_is_shown_and_what_to_look_at():
    layout = Layout("demo", (Tab("A", plot()), Tab("B", plot())), look={"": "the peak", "clipped": "the corner"})
    for run, look in (("nominal", "the peak"), ("clipped", "the corner")):
        first, second = layout.for_run(run, {"about": "printed gains", "title": "A paper"}).tabs
        text = first.content.items[0].markdown
        assert text.startswith(f"**demo, run {run}**: printed gains. *A paper*") and look in text
        assert second == layout.tabs[1]


def test_a_bound_has_the_colour_of_what_it_bounds_and_the_sides_that_it_has(log):
    both = plot(bounds=(Bound("thrust_z", "fz", "axis_3"),))
    upper = plot(bounds=(Bound("thrust_z", "fz", "axis_3", ("upper",)),))
    assert [(line.label, line.role) for line in bound_lines(both, {})] == [
        ("fz (lower)", "axis_3"),
        ("fz (upper)", "axis_3"),
    ]
    assert [(line.field, line.label) for line in bound_lines(upper, {"thrust_z": ("lower", "upper")})] == [
        ("upper", "fz")
    ]


@pytest.mark.parametrize(
    ("duration", "speed"), [(0.5, 1), (30.0, 1), (31.0, 2), (100.0, 5), (300.0, 10), (20000.0, 1000)]
)
def test_a_run_plays_in_half_a_minute(duration, speed):
    assert playback_speed(duration) == speed
    assert duration / speed <= 30.0


def test_shares_become_percentages(log):
    layout = one(Rows(plot(), plot(), plot(), shares=(2, 1, 1)))
    panels = json.loads(foxglove_layout(layout, log))["configById"]
    tree = panels["Tab!tab1"]["tabs"][0]["layout"]
    assert tree["splitPercentage"] == 50.0  # 2 of 4
    assert tree["second"]["splitPercentage"] == 50.0  # 1 of the remaining 2


def luminance(colour):
    """Relative luminance of WCAG 2.1, section 1.4.3."""
    linear = [c / 12.92 if c <= 0.03928 else ((c + 0.055) / 1.055) ** 2.4 for c in (part / 255 for part in colour)]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


@pytest.mark.parametrize("name", list(ROLES))
def test_what_has_one_colour_stands_out_on_white_and_on_dark(name):
    """WCAG 2.1 (1.4.11) asks 3:1 of graphics."""
    found = luminance(on_both(name))
    assert 1.05 / (found + 0.05) >= 3.0
    assert (found + 0.05) / (luminance((20, 22, 26)) + 0.05) >= 3.0


def darkened(colour):
    """What tinycolor2, which the viewers use, makes of a colour that it is to darken by 30: its lightness less 0.3."""
    hue, lightness, saturation = colorsys.rgb_to_hls(*(part / 255 for part in colour))
    return tuple(255 * part for part in colorsys.hls_to_rgb(hue, max(0.0, lightness - 0.3), saturation))


@pytest.mark.parametrize("name", list(ROLES))
def test_a_curve_of_dots_keeps_its_colour_in_a_plot(name):
    """On a light ground a dot is darkened: it stands out 3:1 and is no black; on a dark ground the tone itself does."""
    on_light, on_dark = darkened(in_plots(name)), in_plots(name)
    assert 1.05 / (luminance(on_light) + 0.05) >= 3.0
    if name not in ("truth", "magnitude", "body"):  # those are grey
        assert max(on_light) - min(on_light) >= 50.0
        assert max(darkened(on_both("axis_1"))) < 50.0  # what figures draw is blackened
    assert (luminance(on_dark) + 0.05) / (luminance((20, 22, 26)) + 0.05) >= 3.0


@pytest.mark.parametrize("name", list(ROLES))
def test_colours_stand_out_from_their_ground(name):
    """WCAG 2.1 (1.4.11) asks 3:1 of graphics: held on the dark ground; on paper pale estimates and orange give way."""
    dark = (luminance(rgb(name)) + 0.05) / (luminance((20, 22, 26)) + 0.05)
    light = 1.05 / (luminance(rgb(name, dark=False)) + 0.05)
    assert dark >= 3.0
    assert light >= (1.5 if name.endswith("estimate") else 2.2 if name == "thrust" else 2.5)


#: full loss of one sort of cone (Machado, Oliveira and Fernandes 2009, severity 1), and grey by the weights of WCAG
VISION = {
    "protanopia": (
        (0.152286, 1.052583, -0.204868), (0.114503, 0.786281, 0.099216), (-0.003882, -0.048116, 1.051998),
    ),
    "deuteranopia": (
        (0.367322, 0.860646, -0.227968), (0.280085, 0.672501, 0.047413), (-0.011820, 0.042940, 0.968881),
    ),
    "tritanopia": (
        (1.255528, -0.076749, -0.178779), (-0.078411, 0.930809, 0.147602), (0.004733, 0.691367, 0.303900),
    ),
    "grey": ((0.2126, 0.7152, 0.0722),),
}  # fmt: skip


@pytest.mark.parametrize("dark", [False, True], ids=["paper", "dark"])
@pytest.mark.parametrize("kind", VISION)
def test_axes_look_apart_to_everyone(kind, dark):
    axes = [rgb(f"axis_{number}", dark=dark) for number in (1, 2, 3)]
    seen = [[sum(m * c for m, c in zip(row, axis, strict=True)) for row in VISION[kind]] for axis in axes]
    gaps = [math.dist(one, other) for one, other in combinations(seen, 2)]
    assert min(gaps) > (25.0 if kind == "grey" else 60.0)


def test_an_unknown_role_lists_the_known_ones():
    with pytest.raises(InputError, match="axis_1, axis_2"):
        role("pink")


def test_layout_is_frozen():
    with pytest.raises(AttributeError):
        LAYOUT.name = "other"
    assert replace(LAYOUT, name="other").tabs == LAYOUT.tabs
