"""The run of Section 4, logged in full; its quantities are read from its log alone."""

from gainsay.logs import Bound, Log, LogWriter, Measured, Plot, RunSpec, default_layout, lines
from gainsay.tables import Case
from papers.example.response import numbers, respond


def simulate(case: Case, designs: dict, log: LogWriter) -> None:
    """Log states and torque, and the numbers of the run by two meshes."""
    rate0 = case.number("rate0")
    found = respond(case, rate0)
    log.signal("/satellite/state", {"angle": "rad", "rate": "rad/s"}, found.time, found.states)
    log.signal("/torque", {"u": "N m"}, found.time, -found.states @ case.matrix("K").T)
    log.bound("torque", "N m", lower=-0.05, upper=0.05)
    log.event(0.0, "start", f"at rest at {case.number('angle0'):g} rad")
    for name, steps in (("first", 300), ("second", 500)):
        for quantity, value in numbers(case, rate0, steps).items():
            log.summary(f"{name}_{quantity.removeprefix('run.')}", value, case.quantities[quantity].unit)


def measure(case: Case, log: Log) -> dict[str, Measured]:
    """Read the quantities of the run from its log; the other mesh gives the band."""
    found = {}
    for name in ("settling", "torque", "final_angle"):
        value, other = log.summaries[f"first_{name}"], log.summaries[f"second_{name}"]
        band = abs(value - other) + 1e-12
        found[f"run.{name}"] = Measured(value, "matrix exponentials; band: another mesh", value - band, value + band)
    return found


RUNS = (RunSpec("nominal", simulate, measure),)

#: what viewers show, and the figures: curves of the log with the bounds that it holds
PLOTS = (
    Plot("Angle [rad]", lines("/satellite/state", ("angle",))),
    Plot("Torque [N m]", lines("/torque", ("u",)), (Bound("torque", "bound"),)),
)
LAYOUT = default_layout("example", "One axis of a satellite under the printed gain.", *PLOTS)
