"""The runs of the numerical example: both readings of the delay, both starts of the observer, and designs of ours."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from gainsay.logs import (
    Appendage,
    Body,
    Bound,
    Line,
    LogWriter,
    Measure,
    Plot,
    RunSpec,
    Scene,
    Simulate,
    default_layout,
    lines,
    measuring,
    tab,
)
from gainsay.logs.sampling import moving_samples
from gainsay.tables import Case
from papers.zhang2013.response import Flight, external_torque, fly, numbers

SECOND: dict[str, Any] = {"step": 0.03, "stages": 6}
"""The second solution, on another mesh and of another order, that bands every number."""
DRAWN = 0.8
"""Metres drawn at the tip for the largest modal coordinate of a run: deflections of millimetres become visible."""


def record(case: Case, flight: Flight, second: Flight, log: LogWriter) -> None:
    """Log a run in full, its numbers by both solutions, and what the three-dimensional view shows.

    Samples stand as close as the signals need, at least `log_step` apart.
    """
    end = float(flight.solution.mesh[-1])
    count = round(end / case.number("log_step"))
    time = np.minimum(np.arange(count + 1) * case.number("log_step"), end)
    time = time[
        moving_samples(
            np.column_stack([flight.solution(time), flight.law(time), *flight.torque(time, flight.solution(time))])
        )
    ]
    states = flight.solution(time)
    w2, estimate = flight.w2(states), flight.estimate(states)
    feedback, compensation = flight.torque(time, states)
    log.signal("/spacecraft/attitude", {"angle": "rad"}, time, states[:, :1], shown="mrad")
    log.signal("/spacecraft/rate", {"rate": "rad/s"}, time, states[:, 1:2], shown="mrad/s")
    modal = {"eta1": "kg^0.5 m", "eta2": "kg^0.5 m", "eta1_rate": "kg^0.5 m/s", "eta2_rate": "kg^0.5 m/s"}
    log.signal("/spacecraft/modes", modal, time, states[:, 2:6])
    log.signal("/disturbance", {"w1": "N m", "w2": "N m"}, time, np.column_stack([external_torque(case)(time), w2]))
    log.signal("/observer", {"w2_estimate": "N m", "error": "N m"}, time, np.column_stack([estimate, w2 - estimate]))
    parts = {"total": "N m", "feedback": "N m", "compensation": "N m"}
    log.signal("/torque", parts, time, np.column_stack([feedback + compensation, feedback, compensation]))
    log.signal("/delay", {"delay": "s"}, time, flight.law(time)[:, None])
    squares = [
        flight.solution.integral(density, time)
        for density in (lambda t, x: (flight.w2(x) - flight.estimate(x)) ** 2, lambda t, x: x[:, 0] ** 2)
    ]
    log.signal("/integrals", {"squared_error": "N^2 m^2 s", "squared_angle": "rad^2 s"}, time, np.column_stack(squares))
    log.extremes(numbers(flight), numbers(second))
    log.bound("delay", "s", lower=0.0, upper=case.number("d_M"))
    log.event(0.0, "start", f"mode {flight.mode}, first estimate {estimate[0]:.4g} N m")
    draw_scene(time, states, log)


def draw_scene(time: np.ndarray, states: np.ndarray, log: LogWriter) -> None:
    """Log the body and its appendages, turned about the pitch axis y; deflections are drawn enlarged."""
    half = states[:, 0] / 2
    turn = np.column_stack([np.zeros_like(half), np.sin(half), np.zeros_like(half), np.cos(half)])
    log.transform("orbit", "spacecraft", time, np.zeros((len(time), 3)), turn)
    scale = DRAWN / max(np.abs(states[:, 2:4]).max(), 1e-12)
    log.summary("drawn_deflection", scale, "kg^-0.5")
    panels = tuple(
        Appendage((side * 0.8, 0.0, 0.0), (side, 0.0, 0.0), (0.0, 0.0, side), 4.0, 1.2, (scale,) * 2)
        for side in (1.0, -1.0)
    )
    log.body("spacecraft", "spacecraft", Body((1.6, 1.6, 1.6), panels), time, states[:, 2:4])
    log.axes("orbit", 3.0, name="orbit frame")
    log.axes("spacecraft", 2.0, labels=("", "", ""))


def flight(mode: str, start: str, design: str = "") -> Simulate:
    """Return the simulation of the printed gains, or of a design of ours, in one reading of the text."""

    def simulate(case: Case, designs: Mapping[str, Mapping[str, np.ndarray]], log: LogWriter) -> None:
        K, L = (designs[design][name] if design else case.printed(name).exact for name in "KL")
        record(case, fly(case, K, L, mode, start), fly(case, K, L, mode, start, **SECOND), log)

    return simulate


def measure(prefix: str, *names: str) -> Measure:
    """Return the function that reads a run's quantities from its log, banded by the second solution."""
    return measuring(
        prefix, names, "Gauss collocation, 5 points a step of 20 ms; band: difference to 6 points a step of 30 ms"
    )


SHORT = (
    "theta_10s",
    "theta_min",
    "theta_end",
    "rate_end",
    "vibration_rms_end",
    "squared_angle",
    "settling_1mrad",
    "vibration_rms_50s",
)
FULL = (*SHORT, "estimation_error_rms_50s", "estimation_error_rms_end")
#: reading of the text: where the delay acts, and the start of the observer
READINGS = {
    "matched_start": ("paper", "matched"),
    "input_delayed": ("all", "zero"),
    "input_delayed_matched": ("all", "matched"),
}
DESIGNS = ("resynthesised", "fast", "repaired")
RUNS = (
    RunSpec("nominal", flight("paper", "zero"), measure("run", *FULL)),
    *(RunSpec(name, flight(*reading), measure(f"run.{name}", *FULL)) for name, reading in READINGS.items()),
    RunSpec("no_observer", flight("no_observer", "zero"), measure("run.no_observer", *SHORT)),
    *(RunSpec(name, flight("paper", "zero", name), measure(f"run.{name}", *FULL)) for name in DESIGNS),
)

ABOUT = """# Flexible spacecraft of Zhang, Li and Guo 2013

One axis (pitch), two bending modes, a torque that arrives up to 30 ms late, and an observer that estimates the torque
w2 of the modes on the body. Panels are drawn bending far more than they do: 0.8 m at the run's largest deflection.

- **Angle** and **rate**: what the captions of Figures 1 and 2 announce; the pictures themselves are lost.
- **Estimation error** w2 - w2hat: what the caption of Figure 3 announces. Compare the runs `nominal` and `no_observer`.
- **Delay**: d(t) is not given in the text; ours touches zero and the bound 0.03 s.
"""

LOOK = {
    "": "Look at: the angle within the first 100 s and, under Observer, the error of the estimate.",
    "no_observer": "Look at: the angle without an observer; compare with `nominal`.",
    "fast": "Look at, under Whole run: the vibration of a design that the LMIs accept.",
    "repaired": "Look at: the angle within the first 100 s; compare with `nominal`.",
}
#: what is shown at first: the attitude's transient, the observer's, and that of the fast designs, s
_SHOWN, _ESTIMATE, _FIRST = 100.0, 20.0, 5.0


def _one(
    title: str,
    topic: str,
    field: str,
    label: str,
    role: str,
    until: float | None = None,
    bounds: tuple[Bound, ...] = (),
) -> Plot:
    return Plot(title, (Line(topic, field, label, role),), bounds, until)


_MODES = lines("/spacecraft/modes", ("eta1", "eta2"))
_PARTS = (Line("/torque", "feedback", "K x", "axis_1"), Line("/torque", "compensation", "-w2 estimate", "axis_2"))
_OBSERVED = (
    Line("/disturbance", "w2", "w2", "truth"),
    Line("/observer", "w2_estimate", "w2 estimate", "estimate"),
)


def _angle(title: str, until: float | None = None) -> Plot:
    return _one(title, "/spacecraft/attitude_mrad", "angle", "theta", "axis_2", until)


def _error(title: str, until: float | None = None) -> Plot:
    return _one(title, "/observer", "error", "w2 - w2 estimate", "axis_1", until)


LAYOUT = default_layout(
    "zhang2013",
    ABOUT,
    tab(
        "Attitude",
        _angle("Pitch angle [mrad]", _SHOWN),
        _one("Pitch rate [mrad/s]", "/spacecraft/rate_mrad_s", "rate", "theta rate", "axis_2", _SHOWN),
        Plot("Torque [N m]", _PARTS, until=_SHOWN),
        scene=Scene("Spacecraft, pitch about y", "orbit", elements=("spacecraft",), axes=("orbit", "spacecraft")),
        shares=(2, 1, 1),
    ),
    tab(
        "First seconds",
        _angle("Pitch angle, first seconds [mrad]", _FIRST),
        _one("Torque, first seconds [N m]", "/torque", "total", "total", "thrust", _FIRST),
    ),
    tab(
        "Observer",
        Plot("Torque of the modes [N m]", _OBSERVED, until=_ESTIMATE),
        _error("Estimation error [N m]", _ESTIMATE),
        Plot("Modal coordinates [kg^0.5 m]", _MODES, until=_ESTIMATE),
        shares=(5, 4, 3),
    ),
    tab(
        "Whole run",
        _angle("Pitch angle, whole run [mrad]"),
        _error("Estimation error, whole run [N m]"),
        Plot("Modal coordinates, whole run [kg^0.5 m]", _MODES),
    ),
    tab(
        "Delay",
        _one("Delay [s]", "/delay", "delay", "d", "magnitude", _ESTIMATE, (Bound("delay", "0 and d_M"),)),
        _one("Integral of squared angle [rad^2 s]", "/integrals", "squared_angle", "angle", "magnitude", _SHOWN),
    ),
    look=LOOK,
)
