"""A made-up run that uses everything a log can hold: for tests and for trying out viewers.

A chaser spirals in on the target in 3000 s while an observer, started at zero velocity, converges. No paper is behind
it; the curves are closed forms.
"""

from pathlib import Path
from typing import Any

import numpy as np

from gainsay.logs.layout import Bound, Columns, EventLog, Layout, Line, Plot, Rows, Scene, Tab, Text
from gainsay.logs.scene import Appendage, Body
from gainsay.logs.views import write_views
from gainsay.logs.writer import LogWriter

_POSITION = {"x": "m", "y": "m", "z": "m"}
_THRUST = {"x": "N", "y": "N", "z": "N"}
_WING: dict[str, Any] = {"length": 900.0, "width": 260.0, "tip": (300.0,)}

ABOUT = """
# A spiral approach

A chaser spirals in on a target at the origin of the rotating LVLH frame (*x* radial, *y* along track, *z* across).

- **Scene**: the path flown, the chaser with its body axes and two solar wings (deflection exaggerated), its thrust.
- **Position**: solid is the true state, pale its estimate; they agree after about 600 s.
- **Thrust**: red lines are the bounds of 40 N and 20 N. The peak on *x* is marked in the event log.

No paper is behind this run: it is there to try out viewers.
"""

_AXES = ("x", "y", "z")


def _lines(topic: str, role: str = "axis_{}", label: str = "{}") -> tuple[Line, ...]:
    return tuple(Line(topic, axis, label.format(axis), role.format(i + 1)) for i, axis in enumerate(_AXES))


LAYOUT = Layout(
    "demo",
    (
        Tab(
            "Approach",
            Columns(
                Scene(
                    "Path relative to the target, LVLH",
                    "lvlh",
                    elements=("path", "target", "chaser", "thrust"),
                    axes=("lvlh", "chaser"),
                ),
                Rows(
                    Plot(
                        "Relative position [m]",
                        (
                            *_lines("/chaser/position"),
                            *_lines("/observer/position", "axis_{}_estimate", "{} estimate"),
                        ),
                    ),
                    Plot(
                        "Thrust [N]",
                        _lines("/chaser/thrust", label="f{}"),
                        bounds=(
                            Bound("thrust_xy", "fx, fy at most 40 N", "axis_1"),
                            Bound("thrust_z", "fz at most 20 N", "axis_3"),
                        ),
                    ),
                    Plot("Estimation error [m]", (Line("/observer/error", "norm", "norm", "magnitude"),)),
                    shares=(2, 2, 1),
                ),
                shares=(1, 1),
            ),
        ),
        Tab("About", Columns(Text("About this run", ABOUT), EventLog(), shares=(1, 1))),
    ),
)


def write_demo(path: Path, *, samples: int = 3001) -> Path:
    """Write the log of the demonstration run.

    Parameters
    ----------
    path : Path
    samples : int
        Samples over 3000 s.
    """
    time = np.linspace(0.0, 3000.0, samples)
    radius, angle = 5000.0 * np.exp(-time / 700.0), 2.0 * np.pi * time / 1100.0
    position = np.stack([radius * np.cos(angle), radius * np.sin(angle), 0.35 * radius * np.cos(0.7 * angle)], axis=1)
    error = 800.0 * np.exp(-time / 120.0)[:, None] * np.array([1.0, -0.7, 0.4]) * np.cos(time / 90.0)[:, None]
    thrust = np.stack(
        [
            38.0 * np.exp(-time / 500.0) * np.cos(angle + 0.3),
            33.0 * np.exp(-time / 500.0) * np.sin(angle + 0.3),
            12.0 * np.exp(-time / 500.0) * np.cos(0.7 * angle),
        ],
        axis=1,
    )
    half = 0.5 * (angle + np.pi)
    turn = np.stack([np.zeros_like(half), np.zeros_like(half), np.sin(half), np.cos(half)], axis=1)
    wing = np.exp(-time / 900.0) * np.sin(2.0 * np.pi * time / 160.0)
    peak = int(np.abs(thrust[:, 0]).argmax())
    near = time[np.linalg.norm(position, axis=1) < 500.0][0]
    body = Body(
        (450.0, 350.0, 350.0),
        (
            Appendage((0.0, 175.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0), **_WING),
            Appendage((0.0, -175.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, 1.0), **_WING),
        ),
    )
    with LogWriter(
        path, provenance={"paper": "demo", "run": Path(path).stem}, attachments={"note.md": b"demo\n"}
    ) as log:
        log.signal("/chaser/position", _POSITION, time, position)
        log.signal("/observer/position", _POSITION, time, position + error)
        log.signal("/observer/error", {"norm": "m"}, time, np.linalg.norm(error, axis=1)[:, None])
        log.signal("/chaser/thrust", _THRUST, time, thrust)
        log.bound("thrust_xy", "N", lower=-40.0, upper=40.0)
        log.bound("thrust_z", "N", lower=-20.0, upper=20.0)
        log.event(0.0, "start", "5 km from the target, observer starts with an error of 1 km")
        log.extreme("peak_fx", time[peak], thrust[peak, 0], "N", limit=35.0)
        log.event(near, "near", "range stays below 500 m", "info")
        log.event(3000.0, "end", "end of the run")
        log.summary("impulse", float(np.trapezoid(np.linalg.norm(thrust, axis=1), time)), "N s")
        log.transform("lvlh", "chaser", time, position, turn)
        log.line("path", "lvlh", position, "truth")
        log.marker("target", "lvlh", (0.0, 0.0, 0.0), 300.0, "target", label="target")
        log.axes("lvlh", 2000.0, labels=("x radial", "y along track", "z across"), name="LVLH")
        log.axes("chaser", 1100.0, labels=("", "", ""))
        log.body("chaser", "chaser", body, time, wing[:, None])
        # Thrust is given in LVLH axes: a frame that moves with the chaser but keeps them.
        log.transform("lvlh", "chaser_lvlh", time, position)
        log.arrows("thrust", "chaser_lvlh", time, thrust, 60.0, "thrust")
    return Path(path)


def demo_root(root: Path) -> Path:
    """Write two runs of a paper called demo below a project root; one has its views."""
    for run in ("spiral", "later"):
        write_demo(root / f"results/demo/logs/{run}.mcap", samples=301)
    write_views(root / "results/demo/logs/spiral.mcap", LAYOUT)
    return root
