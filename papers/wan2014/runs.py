"""The runs of section 4: the printed controller under every start of its observer, and the designs of ours."""

from collections.abc import Mapping

import numpy as np

from gainsay.errors import ComputationError
from gainsay.logs import (
    Body,
    Bound,
    Columns,
    Line,
    Log,
    LogWriter,
    Measure,
    Measured,
    Plot,
    Rows,
    RunSpec,
    Scene,
    Simulate,
    Tab,
    default_layout,
    lines,
    measuring,
    tab,
)
from gainsay.simulation.ode import Trajectory
from gainsay.tables import Case
from papers.wan2014 import plant
from papers.wan2014.plant import AXES, COST, DELTA_V, ESTIMATE, POSITION, SQUARED_ERROR, VELOCITY, ClosedLoop
from papers.wan2014.scans import CAPTURE_RADIUS, FLUCTUATION, settling_time

STATE = {"x": "m", "y": "m", "z": "m", "vx": "m/s", "vy": "m/s", "vz": "m/s"}
FORCE = dict.fromkeys(AXES, "N")
RTOL = 1e-12
METHOD = "DOP853 at 1e-12, located on dense output; band: difference to LSODA at 1e-12"


def sample_times(end: float) -> np.ndarray:
    """Return the times of the log's samples, s: dense in the observer's transient, sparse once all is quiet."""
    grid = np.concatenate([np.arange(0, 30, 0.05), np.arange(30, 3000, 1.0), np.arange(3000, end, 10.0), [end]])
    return np.unique(grid)


def scalars(case: Case, loop: ClosedLoop, trajectory: Trajectory) -> dict[str, tuple[float, float, str]]:
    """Return the located numbers of a run: name -> (time, value, unit)."""
    end = float(trajectory.ends[-1])
    final = trajectory(end)
    numbers = {
        "cost": (end, float(final[COST]), "1"),
        "delta_v": (end, float(final[DELTA_V]), "m/s"),
        "squared_error": (end, float(final[SQUARED_ERROR]), "1"),
        "final_range": (end, float(np.linalg.norm(final[POSITION])), "m"),
        "final_speed": (end, float(np.linalg.norm(final[VELOCITY])), "m/s"),
        "range_3000s": (3000.0, float(np.linalg.norm(trajectory(3000.0)[POSITION])), "m"),
    }
    for index, axis in enumerate(AXES):
        time, value = plant.peak_thrust(loop, trajectory, index)
        numbers[f"peak_f{axis}"] = (time, value, "N")
    try:
        capture = plant.capture_time(trajectory, CAPTURE_RADIUS)
        numbers["capture_10m"] = (capture, capture, "s")
    except ComputationError:
        pass  # a run that never captures has no capture time; its measures then lack it, and say so
    settled = settling_time(case, trajectory)
    numbers["error_settling"] = (settled, settled, "s")
    return numbers


def fly(case: Case, loop: ClosedLoop, start: np.ndarray, log: LogWriter) -> None:
    """Simulate a closed loop over the horizon and log it in full, with its located extremes and its numerical error."""
    end = case.number("horizon")
    trajectory = loop.simulate(start, end, rtol=RTOL)
    second = loop.simulate(start, end, rtol=RTOL, method="LSODA")
    time = sample_times(end)
    states = trajectory(time)
    estimate, thrust = states[:, ESTIMATE], loop.thrust(states[:, ESTIMATE])
    log.signal("/chaser/state", STATE, time, states[:, :6])
    log.signal("/observer/state", STATE, time, estimate)
    log.signal("/observer/error", STATE, time, states[:, :6] - estimate)
    log.signal("/chaser/thrust", FORCE, time, thrust)
    log.signal("/chaser/range", {"range": "m"}, time, plant.distance(time, states)[:, None])
    integrals = {"cost": "1", "delta_v": "m/s", "squared_error": "1"}
    log.signal("/integrals", integrals, time, states[:, [COST, DELTA_V, SQUARED_ERROR]])
    limits = {f"peak_f{axis}": limit for axis, limit in zip(AXES, loop.limits, strict=True)}
    log.extremes(scalars(case, loop, trajectory), scalars(case, loop, second), limits=limits)
    for axis, limit in zip(AXES, loop.limits, strict=True):
        log.bound(f"thrust_{axis}", "N", lower=-limit, upper=limit)
    note_saturation(loop, trajectory, log)
    draw_scene(time, states, thrust, log)


def note_saturation(loop: ClosedLoop, trajectory: Trajectory, log: LogWriter) -> None:
    """Log every time at which clipping begins or ends."""
    for instant in trajectory.ends[1:-1]:
        commanded = -trajectory(float(instant))[ESTIMATE] @ loop.K.T
        near = int(np.argmin(np.abs(np.abs(commanded) / loop.limits - 1)))
        log.event(float(instant), "saturation", f"commanded f{AXES[near]} passes its bound", level="warning")


def draw_scene(time: np.ndarray, states: np.ndarray, thrust: np.ndarray, log: LogWriter) -> None:
    """Log what the three-dimensional view shows, in the target's LVLH frame."""
    log.transform("lvlh", "chaser", time, states[:, POSITION])
    log.line("trajectory", "lvlh", states[:, POSITION], "truth")
    log.line("estimated_trajectory", "lvlh", states[:, ESTIMATE][:, :3], "estimate", width=1.0)
    log.body("chaser", "chaser", Body((160.0, 160.0, 160.0)))
    # The largest thrust of the run is drawn 1 km long.
    log.arrows("thrust", "chaser", time, thrust, 1000.0 / np.linalg.norm(thrust, axis=1).max(), "thrust")
    log.marker("target", "lvlh", (0.0, 0.0, 0.0), 120.0, "target", label="target")
    log.axes("lvlh", 1000.0, labels=("x radial", "y along track", "z"), name="LVLH")
    log.axes("chaser", 400.0, labels=("", "", ""))
    log.event(0.0, "start", "chaser 5 km from the target; the estimate starts as the run says")


def measure(prefix: str, names: tuple[str, ...]) -> Measure:
    """Return the function that reads a run's quantities from its log: the located value, banded by a second method."""
    of_extremes = measuring(prefix, names, METHOD)

    def measured(case: Case, log: Log) -> dict[str, Measured]:
        numbers = dict(of_extremes(case, log))
        if prefix in ("audit", "audit.exact_start"):
            thrust = log["/chaser/thrust"]
            early = thrust.column("x")[thrust.time <= FLUCTUATION]
            variation = float(np.sum(np.abs(np.diff(early))))
            numbers[f"{prefix}.fluctuation"] = Measured(variation, "sum of the changes between samples 0.05 s apart")
        if "error_settling" in names and "capture_10m" in names:
            share = log.extremes["error_settling"].value / log.extremes["capture_10m"].value
            numbers[f"{prefix}.error_settling_share"] = Measured(
                share, "settling time of the estimate over capture time"
            )
        return numbers

    return measured


PEAKS = tuple(f"peak_f{axis}" for axis in AXES)
FULL = ("cost", "delta_v", *PEAKS, "range_3000s", "final_range", "capture_10m")


def flight(start: str, design: str = "", **changed: bool) -> Simulate:
    """Return the simulation of the printed gains, or of a design of ours, from a start of the observer."""

    def simulate(case: Case, designs: Mapping[str, Mapping[str, np.ndarray]], log: LogWriter) -> None:
        gains = {name: case.matrix(name) for name in "KL"} | (dict(designs[design]) if design else {})
        fly(case, ClosedLoop(case, gains["K"], gains["L"], **changed), plant.observer_start(case, start), log)

    return simulate


RUNS = (
    RunSpec("nominal", flight("measured_position"), measure("audit", (*FULL, "final_speed", "error_settling"))),
    RunSpec("exact_start", flight("exact"), measure("audit.exact_start", FULL)),
    RunSpec("blind_start", flight("zero"), measure("audit.blind_start", FULL)),
    RunSpec("blind_start_clipped", flight("zero", clipped=True), measure("audit.blind_start_clipped", FULL)),
    RunSpec("linear", flight("measured_position", linear=True), measure("audit.linear", FULL)),
    RunSpec("resynthesised", flight("measured_position", "resynthesised"), measure("run.resynthesised", FULL)),
    RunSpec("repaired", flight("measured_position", "repaired"), measure("run.repaired", FULL)),
    RunSpec("lqr", flight("measured_position", "lqr"), measure("run.lqr", FULL)),
)


POSITIONS, VELOCITIES = tuple(STATE)[:3], tuple(STATE)[3:]
POSITION_SHOWN, VELOCITY_SHOWN = lines("/chaser/state", POSITIONS), lines("/chaser/state", VELOCITIES)
ESTIMATED = lines(
    "/observer/state", VELOCITIES, labels=[f"{name} estimated" for name in VELOCITIES], suffix="_estimate"
)
THRUST_SHOWN = lines("/chaser/thrust", AXES)
#: what is shown at first: the approach, and the observer's transient, s
_SHOWN, _TRANSIENT = 3000.0, 30.0

ABOUT = """# Rendezvous of Wan, Liu and Karimi 2014

A 200 kg chaser 5 km from its target in near-circular orbit, in the target's LVLH frame: x up, y along track, z out of
plane. Grey line: where it is. Thin orange line: where its observer believes it is. Arrows: thrust, the largest of the
run 1 km long.

- **Velocity error** (Figure 2): decays within seconds; the paper shows these three curves.
- **Velocity** (Figure 3) and **thrust** (Figure 4) with the bounds (5), 40, 40 and 20 N. Whether they are kept depends
  on where the estimate starts, which the paper does not say: compare the runs `nominal` and `blind_start`.
- **Trajectory** (Figure 5): the first 3000 s.
"""

LOOK = {
    "nominal": "Look at: thrust against its bounds (5), and the trajectory of the first 3000 s (Figure 5).",
    "exact_start": "Look at, under First seconds: thrust without any error of the estimate; compare with `nominal`.",
    "blind_start": "Look at, under First seconds: thrust against its bounds (5) while the estimate finds the chaser.",
    "blind_start_clipped": "Look at, under First seconds: thrust clipped at its bounds; compare with `blind_start`.",
    "linear": "Look at: the paper's linear plant; compare the approach with `nominal`.",
    "resynthesised": "Look at: the sub-problem solved again; compare the approach with `nominal`.",
    "repaired": "Look at: range and velocity increment, under Integrals; compare with `nominal`.",
    "lqr": "Look at: thrust against its bounds (5); compare with `repaired`.",
}
_BOUNDS = (Bound("thrust_x", "fx, fy: 40 N", "axis_1"), Bound("thrust_z", "fz: 20 N", "axis_3"))

_SCENE = Scene(
    "Relative trajectory, LVLH",
    "lvlh",
    elements=("trajectory", "estimated_trajectory", "thrust", "chaser", "target"),
    axes=("lvlh", "chaser"),
)
_ERROR = "/observer/error"


def _sum(title: str, topic: str, field: str, label: str) -> Plot:
    return Plot(title, (Line(topic, field, label, "magnitude"),), until=_SHOWN)


LAYOUT = default_layout(
    "wan2014",
    ABOUT,
    tab(
        "Rendezvous",
        Plot("Relative position [m]", POSITION_SHOWN, until=_SHOWN),
        Plot("Relative velocity [m/s]", VELOCITY_SHOWN, until=_SHOWN),
        Plot("Thrust [N]", THRUST_SHOWN, until=_SHOWN, bounds=_BOUNDS),
        scene=_SCENE,
    ),
    Tab(
        "First seconds",
        Columns(
            Rows(
                Plot("Thrust, first seconds [N]", THRUST_SHOWN, until=_TRANSIENT, bounds=_BOUNDS),
                Plot("Relative velocity and its estimate [m/s]", (*VELOCITY_SHOWN, *ESTIMATED), until=_TRANSIENT),
            ),
            Rows(
                Plot("Velocity error of the estimate [m/s]", lines(_ERROR, VELOCITIES), until=_TRANSIENT),
                Plot("Position error of the estimate [m]", lines(_ERROR, POSITIONS), until=_TRANSIENT),
            ),
        ),
    ),
    tab(
        "Integrals",
        _sum("Range to the target [m]", "/chaser/range", "range", "range"),
        _sum("Cost J so far [1]", "/integrals", "cost", "J"),
        _sum("Velocity increment so far [m/s]", "/integrals", "delta_v", "delta-v"),
    ),
    look=LOOK,
)
