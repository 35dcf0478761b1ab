"""The regulator from a displaced mass."""

import numpy as np
from scipy.optimize import minimize_scalar

from gainsay.logs import Log, LogWriter, Measured, Plot, RunSpec, default_layout, lines
from gainsay.simulation.linear import Response
from gainsay.tables import Case
from papers.double_integrator.plant import closed_loop, cost


def respond(case: Case, v0: float, steps: int = 400) -> Response:
    """Return the response from the printed displacement and a velocity in m/s."""
    return Response(closed_loop(case), np.array([case.number("x0"), v0]), case.number("horizon"), steps)


def undershoot(case: Case, v0: float, steps: int = 400) -> tuple[float, float]:
    """Return when the mass is farthest on the other side, s, and how far, m."""
    found = respond(case, v0, steps)
    lowest = int(np.argmin(found.states[:, 0]))
    around = (found.time[lowest - 1], found.time[lowest + 1])
    best = minimize_scalar(lambda t: found.at(t)[0], bounds=around, method="bounded", options={"xatol": 1e-10})
    return float(best.x), -float(best.fun)


def simulate(case: Case, designs: dict, log: LogWriter) -> None:
    """Log states and control, the largest excursion to the other side, and the cost of the start."""
    found = respond(case, case.number("v0"))
    log.signal("/mass", {"x": "m", "v": "m/s"}, found.time, found.states)
    log.signal("/control", {"u": "N"}, found.time, -found.states @ case.matrix("K").T)
    time, value = undershoot(case, case.number("v0"))
    log.extreme("undershoot", time, value, "m")
    log.summary("second_undershoot", undershoot(case, case.number("v0"), 700)[1], "m")
    log.summary("cost", cost(case, case.number("v0")), "1")


def measure(case: Case, log: Log) -> dict[str, Measured]:
    """Read the numbers of the run from its log."""
    value = log.extremes["undershoot"][1]
    band = abs(value - log.summaries["second_undershoot"]) + 1e-12
    spent = log.summaries["cost"]
    return {
        "run.undershoot": Measured(value, "least displacement of the exact response; band: another mesh", value - band,
                                   value + band),
        "run.cost": Measured(spent, "x' P x with the printed P"),
    }  # fmt: skip


RUNS = (RunSpec("nominal", simulate, measure),)
PLOTS = Plot("Displacement [m]", lines("/mass", ("x",))), Plot("Control [N]", lines("/control", ("u",)))
LAYOUT = default_layout("double_integrator", "A mass brought to rest by the printed regulator.", *PLOTS)
