"""Figures 6 to 14 of pinheiro2013, drawn from the logs in the paper's colours and line styles.

Blue: gamma = 0.2, which the paper calls pure H-infinity; black: gamma = 2; red: gamma = 100, called pure H2. Solid:
nominal plant; dashed: plants with uncertainty. Axes and scales of the paper's pictures are lost.
"""

from collections.abc import Mapping

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gainsay.figures import Draw, FigureSpec, bound, finish, panels
from gainsay.logs import Log, Signal
from gainsay.tables import Case

COLOURS = {"hinf": "#0055a4", "mixed": "#1f1f1f", "h2": "#dd4637"}
LABELS = {
    "hinf": r"$\gamma = 0.2$ (pure $H_\infty$)",
    "mixed": r"$\gamma = 2$ (mixed)",
    "h2": r"$\gamma = 100$ (pure $H_2$)",
}
NAMES = {"roll": "x", "pitch": "y", "yaw": "z"}
#: what is shown of the fastest design's angles, and of the torques, s
_FAST, _TORQUE = 10.0, 30.0


def _curve(
    panel: Axes,
    signal: Signal,
    field: str,
    design: str,
    *,
    dashed: bool = False,
    label: str = "",
    until: float | None = None,
) -> None:
    shown = slice(None) if until is None else signal.time <= until
    panel.plot(
        signal.time[shown],
        signal.column(field)[shown],
        color=COLOURS[design],
        linewidth=0.8 if dashed else 1.2,
        linestyle=(0, (4, 2)) if dashed else "solid",
        label=label or None,
    )


def _panels(figure: Figure, label: str, enlarged: str = "") -> list:
    """Return a panel a reconstruction, and one more of each below for what is `enlarged`."""
    titles = [f"reconstruction {r}" for r in "AB"] + [f"reconstruction {r}, {enlarged}" for r in "AB" if enlarged]
    return panels(figure, [label] * len(titles), titles=titles, columns=2, share_time=not enlarged)


def uncertainty(name: str) -> Draw:
    """Return the drawing of an angle with and without uncertainty, one panel a reconstruction."""

    def draw(figure: Figure, logs: Mapping[str, Log], case: Case) -> None:
        grid = _panels(figure, f"{name} angle [deg]", f"first {_FAST:g} s")
        for index, panel in enumerate(grid):
            r, until = "ab"[index % 2], None if index < 2 else _FAST
            for design in _EXTREMES if until is None else _EXTREMES[:1]:
                log = logs[f"{r}_{design}_release"]
                _curve(panel, log["/nominal/angles_deg"], name, design, label=LABELS[design], until=until)
                for k in (1, 2):
                    _curve(panel, log[f"/plant_{k}/angles_deg"], name, design, dashed=True, until=until)
            panel.plot([], [], color="#666666", linewidth=0.8, linestyle=(0, (4, 2)), label="with uncertainty")
        finish(figure, grid)

    return draw


def control(name: str) -> Draw:
    """Return the drawing of a control torque, one panel a reconstruction, with the wheel's limit."""

    def draw(figure: Figure, logs: Mapping[str, Log], case: Case) -> None:
        grid = _panels(figure, f"control torque, {name} [N m]")
        limit = case.number("wheel_torque")
        for panel, r in zip(grid, "ab", strict=True):
            for design in COLOURS:
                log = logs[f"{r}_{design}_release"]
                _curve(panel, log["/nominal/torque"], NAMES[name], design, label=LABELS[design], until=_TORQUE)
            bound(panel, limit, f"{limit:g} N m\n(Table 2)")
        finish(figure, grid)

    return draw


def external(name: str) -> Draw:
    """Return the drawing of an angle under the torques (25), one panel a reconstruction."""

    def draw(figure: Figure, logs: Mapping[str, Log], case: Case) -> None:
        grid = _panels(figure, f"{name} angle [deg]")
        for panel, r in zip(grid, "ab", strict=True):
            for design in ("h2", "mixed", "hinf"):
                log = logs[f"{r}_{design}_disturbed"]
                _curve(panel, log["/nominal/angles_deg"], name, design, label=LABELS[design])
            since, until = case.number("step_start"), case.number("step_end")
            panel.axvspan(since, until, color="#ececec", zorder=0, label=f"step of (25), {since:g} to {until:g} s")
        finish(figure, grid)

    return draw


def _runs(kind: str, designs: tuple[str, ...] = tuple(COLOURS)) -> tuple[str, ...]:
    return tuple(f"{r}_{design}_{kind}" for r in "ab" for design in designs)


_EXTREMES = ("hinf", "h2")
FIGURES = tuple(
    FigureSpec(f"figure_{first + axis}", runs, draw(name), height)
    for first, runs, draw, height in (
        (6, _runs("release", _EXTREMES), uncertainty, 5.2),
        (9, _runs("release"), control, 3.2),
        (12, _runs("disturbed"), external, 3.2),
    )
    for axis, name in enumerate(NAMES)
)
