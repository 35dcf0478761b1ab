"""Integrations against the best that scipy's integrators do at equal error."""

from collections.abc import Iterator
from importlib import import_module
from typing import Any

import numpy as np

from gainsay.bench.measure import Row, cpu_of
from gainsay.tables import Case

_METHODS = ("DOP853", "LSODA")  # the others take minutes, and are far from the best
_TOLERANCES = (1e-9, 1e-10, 1e-11, 1e-12)


def rendezvous(case: Case) -> Iterator[Row]:
    """Measure the two-body run of wan2014 as logged against every integrator and tolerance that errs no more."""
    from scipy.integrate import solve_ivp

    plant = import_module("papers.wan2014.plant")
    runs = import_module("papers.wan2014.runs")
    loop = plant.ClosedLoop(case, case.matrix("K"), case.matrix("L"))
    start, end = plant.observer_start(case), case.number("horizon")
    times = runs.sample_times(end)
    reference = loop.simulate(start, end, rtol=1e-13)(times)[:, :6]
    state = loop.simulate(start, 1e-3)(0.0)
    slope = loop.right_hand_side()
    # the absolute tolerances of the runs, state by state
    size = np.concatenate([np.full(3, 1.0), np.full(3, 1e-2), np.full(3, 1.0), np.full(3, 1e-2), [1, 1e6, 1, 1e3]])

    def error(states: np.ndarray) -> float:
        return float(np.max(np.abs(states[:, :6] - reference)))

    flights: list[Any] = []
    ours = min(cpu_of(lambda: flights.append(loop.simulate(start, end, rtol=runs.RTOL))) for _ in range(3))
    ours_error = error(flights[-1](times))
    best, name = np.inf, "none errs as little"
    for method in _METHODS:
        for rtol in _TOLERANCES:
            flown: list[Any] = []

            def bare(method: str = method, rtol: float = rtol, flown: list[Any] = flown) -> None:
                flown.append(solve_ivp(slope, (0, end), state, method, rtol=rtol, atol=rtol * size, dense_output=True))

            seconds = cpu_of(bare)
            if seconds < best and error(flown[0].sol(times).T) <= 1.2 * ours_error:
                best, name = seconds, f"{method} at {rtol:g}"
    against = f"scipy's best at equal error ({name})"
    yield Row(
        f"wan2014: two-body run, error {ours_error:.1e} m", against, ours, best if np.isfinite(best) else ours, 1.0
    )
