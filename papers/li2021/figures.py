"""Figures 3 to 9 of the paper, drawn again, and three of our own, from the logs, the tables and the synthesis."""

import re
from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from gainsay.figures import Draw, FigureSpec, bound, curve, curves, ended, figure_of_run, finish, panels
from gainsay.logs import Log, Plot, lines
from gainsay.logs.palette import role
from gainsay.results.returned import read_part
from gainsay.systems.norms import hinf_norm
from gainsay.tables import Case
from papers.li2021 import plant

ANGLES = ("roll", "pitch", "yaw")
MODES = tuple(f"eta_{i}" for i in (1, 2, 3, 4))
MODE_LABELS = tuple(rf"$\eta_{i}$" for i in (1, 2, 3, 4))
#: what is shown of a run under random gains, s
_RANDOM = 150.0
READINGS = (("constant", "once"), ("slow", "every second"), ("fast", "every 0.1 s"))


def poles(figure: Figure, logs: Mapping[str, Log], case: Case) -> None:
    """Draw Figure 3: open- and closed-loop poles with the disk."""
    titles, small = ["poles and the disk", "open-loop poles, enlarged"], r"[$10^{-5}$ 1/s]"
    labels = ["imaginary part [1/s]", f"imaginary part {small}"]
    left, right = panels(figure, labels, titles=titles, columns=2, share_time=False)
    nominal = plant.rigid(plant.constants(case))
    closed = np.linalg.eigvals(plant.closed_loop(nominal, plant.controller(case, "proposed")))
    opened = np.linalg.eigvals(nominal.A)
    centre, radius = case.number("disk_centre"), case.number("disk_radius")
    ring = Circle((-centre, 0), radius, fill=False, linestyle="--", label=f"D({centre:g}, {radius:g})")
    left.add_patch(ring)
    left.plot(closed.real, closed.imag, "x", color=role("axis_1").on_light, label="closed loop")
    for panel, scale in ((left, 1.0), (right, 1e5)):
        open_loop = role("axis_2").on_light
        panel.plot(scale * opened.real, scale * opened.imag, "+", color=open_loop, label="open loop")
        panel.axvline(0, color="#999999", linewidth=0.8)
        panel.margins(0.1)
    left.set_aspect("equal")
    finish(figure, (left, right), x="real part [1/s]")
    right.set_xlabel(f"real part {small}")


def torque(figure: Figure, logs: Mapping[str, Log], case: Case) -> None:
    """Draw Figure 6: control torque in its transient, and its norm with the bound."""
    grid = panels(figure, ["control torque [N m]", "norm of the torque [N m]"], columns=2)
    curves(grid[0], logs["proposed"], "/wheels/torque", ("x", "y", "z"), until=60.0)
    signal = logs["proposed"]["/wheels/torque_size"]
    shown = signal.time <= 60.0
    curve(grid[1], signal.time[shown], signal.column("size")[shown], "magnitude", "norm")
    bound(grid[1], case.number("u_max"), f"$u_{{max}}$ = {case.number('u_max'):g} N m", both=False)
    grid[1].set_ylim(bottom=0)
    finish(figure, grid)


def modes(figure: Figure, logs: Mapping[str, Log], case: Case) -> None:
    """Draw Figure 7: modal coordinates, the first minute and all of the run."""
    titles = ["first 60 s", "whole run"]
    grid = panels(figure, [r"modal coordinates [kg$^{0.5}$ m]"] * 2, titles=titles, share_time=False)
    for panel, until in zip(grid, (60.0, None), strict=True):
        curves(panel, logs["proposed"], "/modes/coordinates", MODES, labels=MODE_LABELS, until=until)
    finish(figure, grid)


def random_gains(name: str) -> Draw:
    """Return the drawing of Figure 8 or 9: angles under random gains, in three readings."""

    def draw(figure: Figure, logs: Mapping[str, Log], case: Case) -> None:
        titles = [f"gains redrawn: {text}" for _, text in READINGS]
        grid = panels(figure, ["Euler angles [deg]"] * 3, titles=titles)
        for panel, (reading, _) in zip(grid, READINGS, strict=True):
            log = logs[f"{name}_{reading}"]
            curves(panel, log, "/attitude/angles_deg", ANGLES, until=_RANDOM)
            if log.duration < _RANDOM:
                ended(
                    panel, log.duration, f"diverges: an angle passes 10 rad at {log.duration:.3g} s, where the run ends"
                )
        finish(figure, grid)

    return draw


def designs(figure: Figure, logs: Mapping[str, Log], case: Case) -> None:
    """Draw largest angle and norm of the torque of the printed gains and of our own."""
    labels = ["largest Euler angle [deg]", "norm of the torque [N m]"]
    left, right = panels(figure, labels, columns=2, share_time=False)
    named = (
        ("proposed", "printed", "nominal"),
        ("comparison", "[39]", "comparison"),
        ("repaired", "repaired", "axis_3"),
        ("best", "largest gain variation", "perturbed"),
    )
    for run, label, look in named:
        signal, size = logs[run]["/attitude/angles_deg"], logs[run]["/wheels/torque_size"]
        shown = signal.time <= 60.0
        curve(left, signal.time[shown], np.abs(signal.values[shown]).max(axis=1), look, label)
        curve(right, size.time[size.time <= 30.0], size.column("size")[size.time <= 30.0], look, label)
    left.set_yscale("log")
    right.set_ylim(bottom=0)
    finish(figure, (left, right))


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
        ("best", "largest gain variation", "perturbed", "D"),
    ):
        gains = plant.controller(case, "proposed" if name == "printed" else name)
        loop = plant.closed_loop(nominal, gains)
        radius = np.abs(np.linalg.eigvals(loop) + case.number("disk_centre")).max()
        certified.append((hinf_norm(loop, B, C)[0], radius, values[f"certified.{name}.delta_m"], label, look, marker))
    axes = panels(figure, [r"certified gain variation $\delta_m$"] * 2, columns=2, share_time=False)
    for column in range(2):
        panel = axes[column]
        body = role("body").on_light
        panel.plot(searched[column], searched[2], "o", mfc="none", color=body, label="trade-off designs")
        for *place, reached, label, look, marker in certified:
            panel.plot(place[column], reached, marker, color=role(look).on_light, label=label)
        bound(panel, case.number("delta_m"), f"{case.number('delta_m'):g} (Table 1)", both=False)
        panel.set_ylim(0, 1.1 * max(values[name] for name in values if name.endswith(".delta_m")))
        panel.margins(x=0.05)
    finish(figure, axes)
    for panel, title in zip(
        axes, (r"norm from $\tilde d$ to $y$ [rad/(N m)]", r"largest $|s + 1.01|$ over the poles [1/s]"), strict=True
    ):
        panel.set_xlabel(title)


def _runs(name: str) -> tuple[str, ...]:
    return tuple(f"{name}_{reading}" for reading, _ in READINGS)


FIGURES = (
    FigureSpec("figure_3", ("proposed",), poles),
    figure_of_run(
        "figure_4", "proposed", Plot("Euler angles [deg]", lines("/attitude/angles_deg", ANGLES), until=100.0)
    ),
    figure_of_run(
        "figure_5", "proposed", Plot("Euler rates [deg/s]", lines("/attitude/rates_deg_s", ANGLES), until=100.0)
    ),
    FigureSpec("figure_6", ("proposed",), torque),
    FigureSpec("figure_7", ("proposed",), modes, 4.6),
    FigureSpec("figure_8", _runs("proposed"), random_gains("proposed"), 7.0),
    FigureSpec("figure_9", _runs("comparison"), random_gains("comparison"), 7.0),
    FigureSpec("random_repaired", _runs("repaired"), random_gains("repaired"), 7.0),
    FigureSpec("tradeoff", (), tradeoff),
    FigureSpec("designs", ("proposed", "comparison", "repaired", "best"), designs),
)
