"""The run of Section 4, logged in full; its quantities are read from its log alone."""

from gainsay.logs import Bound, LogWriter, Plot, default_layout, linear_run, lines
from gainsay.simulation.linear import Response
from gainsay.tables import Case
from papers.example.response import numbers, respond


def simulate(case: Case, steps: int) -> Response:
    """Return the response from the initial rate of the table."""
    return respond(case, case.number("rate0"), steps)


def signals(case: Case) -> dict:
    """State and torque, each as units and a matrix that the state is multiplied by."""
    state = {"angle": "rad", "rate": "rad/s"}
    return {"/satellite": (state, [[1, 0], [0, 1]]), "/torque": ({"u": "N m"}, -case.matrix("K"))}


def bounds(case: Case, log: LogWriter) -> None:
    """Log what the paper says of the torque."""
    log.bound("torque", "N m", lower=-0.05, upper=0.05)


RUNS = (linear_run("nominal", simulate, signals, numbers, also=bounds),)

#: what viewers show, and the figures: curves of the log with the bounds that it holds
PLOTS = (
    Plot("Angle [rad]", lines("/satellite", ["angle"])),
    Plot("Torque [N m]", lines("/torque", ["u"]), [Bound("torque", "bound")]),
)
LAYOUT = default_layout("example", "One axis of a satellite under the printed gain.", *PLOTS)
