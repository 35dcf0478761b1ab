"""What the figures and sentences of zhang2013 say, over every plausible value of what the paper leaves out."""

from collections.abc import Callable, Mapping
from functools import partial

from gainsay.results import Results, task
from gainsay.tables import Case
from gainsay.verdicts.scan import plausible, scan
from papers.zhang2013 import response as flight


def _number_of(numbers: Callable[[Mapping], dict[str, float]], quantity: str, point: Mapping) -> float:
    return numbers(point)[quantity]


SCANNED = (
    "delay_mean",
    "delay_amplitude",
    "delay_frequency",
    "w1_frequency",
    "horizon",
    "delay_mode",
    "observer_start",
)


SCANNED_QUANTITIES = (
    "audit.convergence",
    "run.theta_end",
    "run.rate_end",
    "audit.rejection",
    "audit.vibration_ratio",
)


@task("Figures 1 to 3")
def figures(case: Case, results: Results) -> None:
    """What the text says of Figures 1 to 3, over every plausible value of what it leaves out."""
    inputs = [plausible(case, name) for name in SCANNED]
    seen: dict[tuple, dict[str, float]] = {}

    def numbers(point: Mapping) -> dict[str, float]:
        key = tuple(point[name] for name in SCANNED)
        if key not in seen:
            seen[key] = flight.scan_numbers(case, point)
        return seen[key]

    here = {name: case.choice(name) if name.endswith(("mode", "start")) else case.number(name) for name in SCANNED}
    for quantity in SCANNED_QUANTITIES:
        if quantity.startswith("audit."):
            results.quantity(quantity, numbers(here)[quantity], method="Gauss collocation", source="Figures 1 to 3")
        results.scan(
            scan(
                case,
                quantity,
                inputs,
                partial(_number_of, numbers, quantity),
                samples=200,
                admissible=lambda point: flight.admissible(case, point),
            )
        )
    results.say("Figures 1 to 3", f"{len(seen)} plausible readings simulated")
