"""Figures 3 to 9 of the paper, drawn again, and three of our own, from the logs, the tables and the synthesis."""

import re
from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from gainsay.figures import FigureSpec, bound, curve, curves, finish, panels
from gainsay.logs import Log
from gainsay.logs.palette import role
from gainsay.systems.norms import hinf_norm
from gainsay.tables import Case
from gainsay.tables.results import read_part
from papers.li2021 import plant

ANGLES = ("roll", "pitch", "yaw")
MODES = tuple(f"eta_{i}" for i in (1, 2, 3, 4))
READINGS = (("constant", "drawn once"), ("slow", "every second"), ("fast", "every 0.1 s"))


def poles(figure: Figure, logs: Mapping[str, Log], case: Case) -> None:
    """Draw Figure 3: open- and closed-loop poles with the disk."""
    left, right = panels(
        figure, ["Poles of (10) and the disk [1/s]", "Open-loop poles [1e-5/s]"], columns=2, share_time=False
    )
    nominal = plant.rigid(plant.constants(case))
    closed = np.linalg.eigvals(plant.closed_loop(nominal, plant.controller(case, "proposed")))
    opened = np.linalg.eigvals(nominal.A)
    left.add_patch(Circle((-case.number("disk_centre"), 0), case.number("disk_radius"), fill=False, linestyle="--"))
    left.plot(closed.real, closed.imag, "x", color="#0072b2", label="closed loop")
    left.plot(opened.real, opened.imag, "+", color="#d55e00", label="open loop")
    right.plot(1e5 * opened.real, 1e5 * opened.imag, "+", color="#d55e00", label="open loop")
    right.axvline(0, color="#999999", linewidth=0.8)
    left.set_aspect("equal")
    for panel in (left, right):
        finish(panel, x="real part")


def angles(figure: Figure, logs: Mapping[str, Log], case: Case) -> None:
    """Draw Figure 4: Euler angles."""
    (panel,) = panels(figure, ["Euler angles [rad]"])
    curves(panel, logs["proposed"], "/attitude/angles", ANGLES, until=100.0)
    finish(panel)


def rates(figure: Figure, logs: Mapping[str, Log], case: Case) -> None:
    """Draw Figure 5: Euler rates."""
    (panel,) = panels(figure, ["Euler rates [rad/s]"])
    curves(panel, logs["proposed"], "/attitude/rates", ANGLES, until=100.0)
    finish(panel)


def torque(figure: Figure, logs: Mapping[str, Log], case: Case) -> None:
    """Draw Figure 6: control torque, its transient, and its norm with the bound."""
    left, right = panels(figure, ["Control torque [N m]", "Norm of the torque [N m]"], columns=2)
    curves(left, logs["proposed"], "/wheels/torque", ("x", "y", "z"), until=60.0)
    signal = logs["proposed"]["/wheels/torque_size"]
    shown = signal.time <= 60.0
    curve(right, signal.time[shown], signal.column("size")[shown], "magnitude", "norm")
    bound(right, case.number("u_max"), "u_max")
    right.set_ylim(bottom=0)
    for panel in (left, right):
        finish(panel)


def modes(figure: Figure, logs: Mapping[str, Log], case: Case) -> None:
    """Draw Figure 7: modal coordinates."""
    (panel,) = panels(figure, ["Modal coordinates [kg^0.5 m]"])
    curves(panel, logs["proposed"], "/modes/coordinates", MODES)
    finish(panel)


def random_gains(name: str):
    """Return the drawing of Figure 8 or 9: angles under random gains, in three readings."""

    def draw(figure: Figure, logs: Mapping[str, Log], case: Case) -> None:
        grid = panels(figure, [f"Euler angles, gains {text} [rad]" for _, text in READINGS])
        for panel, (reading, _) in zip(grid, READINGS, strict=True):
            curves(panel, logs[f"{name}_{reading}"], "/attitude/angles", ANGLES, until=150.0)
            finish(panel)

    return draw


def designs(figure: Figure, logs: Mapping[str, Log], case: Case) -> None:
    """Draw largest angle and norm of the torque of the printed gains and of our own."""
    left, right = panels(figure, ["Largest Euler angle [rad]", "Norm of the torque [N m]"], columns=2)
    named = (("proposed", "printed", "nominal"), ("comparison", "[39]", "comparison"), ("repaired", "ours", "axis_3"),
             ("best", "largest variation", "perturbed"))  # fmt: skip
    for run, label, look in named:
        signal, size = logs[run]["/attitude/angles"], logs[run]["/wheels/torque_size"]
        shown = signal.time <= 60.0
        curve(left, signal.time[shown], np.abs(signal.values[shown]).max(axis=1), look, label)
        curve(right, size.time[size.time <= 30.0], size.column("size")[size.time <= 30.0], look, label)
    left.set_yscale("log")
    for panel in (left, right):
        finish(panel)


def tradeoff(figure: Figure, logs: Mapping[str, Log], case: Case) -> None:
    """Draw the gain variation reached over the norm and over the disk that the poles need, from synthesis."""
    read = [row for row in read_part(case, "quantities") if row["quantity"].startswith(("tradeoff.", "certified."))]
    values = {row["quantity"]: float(row["value"]) for row in read}
    numbers = sorted(int(name.split(".")[1]) for name in values if re.fullmatch(r"tradeoff\.\d+\.delta_m", name))
    searched = [[values[f"tradeoff.{i}.{what}"] for i in numbers] for what in ("norm", "disk_radius", "delta_m")]
    nominal, C = plant.rigid(plant.constants(case)), np.eye(3, 12)
    B = np.vstack([nominal.B, np.zeros((6, 3))])
    certified = []
    for name, label, look, marker in (
        ("printed", "printed", "nominal", "o"),
        ("repaired", "repaired", "axis_3", "s"),
        ("best", "largest", "perturbed", "D"),
    ):
        gains = plant.controller(case, "proposed") if name == "printed" else plant.gains_of(case.designs[name])
        loop = plant.closed_loop(nominal, gains)
        radius = np.abs(np.linalg.eigvals(loop) + case.number("disk_centre")).max()
        certified.append((hinf_norm(loop, B, C)[0], radius, values[f"certified.{name}.delta_m"], label, look, marker))
    axes = panels(figure, ["Largest gain variation delta_m [1]"] * 2, columns=2, share_time=False)
    for column, title in enumerate(("norm from d~ to y [rad/(N m)]", "largest |s + 1.01| over the poles [1/s]")):
        panel = axes[column]
        body = role("body").on_light
        panel.plot(searched[column], searched[2], "o", mfc="none", color=body, label="trade-off")
        for *place, reached, label, look, marker in certified:
            panel.plot(place[column], reached, marker, color=role(look).on_light, label=label)
        bound(panel, case.number("delta_m"), "the paper's")
        panel.set_ylim(0, 1.1 * max(values[name] for name in values if name.endswith(".delta_m")))
        finish(panel, x=title, legend=column == 0)


def _runs(name: str) -> tuple[str, ...]:
    return tuple(f"{name}_{reading}" for reading, _ in READINGS)


FIGURES = (
    FigureSpec("figure_3", ("proposed",), poles),
    FigureSpec("figure_4", ("proposed",), angles),
    FigureSpec("figure_5", ("proposed",), rates),
    FigureSpec("figure_6", ("proposed",), torque),
    FigureSpec("figure_7", ("proposed",), modes),
    FigureSpec("figure_8", _runs("proposed"), random_gains("proposed"), 7.0),
    FigureSpec("figure_9", _runs("comparison"), random_gains("comparison"), 7.0),
    FigureSpec("random_repaired", _runs("repaired"), random_gains("repaired"), 7.0),
    FigureSpec("tradeoff", (), tradeoff),
    FigureSpec("designs", ("proposed", "comparison", "repaired", "best"), designs),
)  # fmt: skip
