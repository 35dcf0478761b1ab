"""The regulator from a displaced mass."""

from gainsay.logs import Plot, default_layout, linear_run, lines
from gainsay.simulation.linear import Response
from gainsay.tables import Case
from papers.double_integrator.plant import numbers, respond


def simulate(case: Case, steps: int) -> Response:
    """Return the response from the initial velocity of the table."""
    return respond(case, case.number("v0"), steps)


def signals(case: Case) -> dict:
    """State and control, each as units and a matrix that the state is multiplied by."""
    return {"/mass": ({"x": "m", "v": "m/s"}, [[1, 0], [0, 1]]), "/control": ({"u": "N"}, -case.matrix("K"))}


RUNS = (linear_run("nominal", simulate, signals, numbers),)
PLOTS = (Plot("Displacement [m]", lines("/mass", ["x"])), Plot("Control [N]", lines("/control", ["u"])))
LAYOUT = default_layout("double_integrator", "A mass brought to rest by the printed regulator.", *PLOTS)
