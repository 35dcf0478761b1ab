"""What the figures and sentences of zhang2013 say, over every plausible value of what the paper leaves out."""

from functools import partial

from gainsay.results import Results, task
from gainsay.scans import plausible, scans
from gainsay.tables import Case
from papers.zhang2013 import response as flight

SCANNED = (
    "delay_mean",
    "delay_amplitude",
    "delay_frequency",
    "w1_frequency",
    "horizon",
    "delay_mode",
    "observer_start",
)


SCANNED_QUANTITIES = ("audit.convergence", "run.theta_end", "run.rate_end", "audit.rejection", "audit.vibration_ratio")


@task("Figures 1 to 3")
def figures(case: Case, results: Results) -> None:
    """What the text says of Figures 1 to 3, over every plausible value of what it leaves out."""
    inputs = [plausible(case, name) for name in SCANNED]
    here = {name: case.choice(name) if name.endswith(("mode", "start")) else case.number(name) for name in SCANNED}
    numbers = flight.scan_numbers(case, here)
    for quantity in SCANNED_QUANTITIES:
        if quantity.startswith("audit."):
            results.quantity(quantity, numbers[quantity], method="Gauss collocation", source="Figures 1 to 3")
    evaluate = partial(flight.scan_numbers, case)
    for scan in scans(
        case, SCANNED_QUANTITIES, inputs, evaluate, samples=200, admissible=partial(flight.admissible, case)
    ):
        results.scan(scan)
    results.say("Figures 1 to 3", "simulated over the plausible readings")
