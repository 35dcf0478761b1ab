"""Audit under random gains: Figures 8 and 9 in the three readings of how often the gains are drawn."""

import numpy as np

from gainsay.results import Results, task
from gainsay.scans import over_choice
from gainsay.tables import Case
from papers.li2021 import plant, response
from papers.li2021.response import FlexibleLoop

#: draws of a whole simulation behind Figures 8 and 9, by how the gains are held
SIMULATED = {"constant": 150, "fast": 20, "slow": 40}


def residuals(case: Case, reading: str, name: str) -> np.ndarray:
    """Largest angle in the last 100 s of each draw of a campaign, rad; the draws are common to both controllers."""
    loop, seed = FlexibleLoop(case, plant.controller(case, name)), int(case.number("seed"))
    generators = [np.random.default_rng((seed, number)) for number in range(SIMULATED[reading])]
    times, states = response.redrawn(loop, response.HOLDS[reading], generators)
    return np.abs(states[times >= times[-1] - response.WINDOW][..., response.ANGLES]).max(axis=(0, 2))


@task("Figures 8 and 9")
def random_gains(case: Case, results: Results) -> None:
    """Residual angles under random gains, in the three readings of how often they are drawn."""
    source, ratio = "Figures 8 and 9", {}
    for reading, hold in response.HOLDS.items():
        residual = {name: residuals(case, reading, name) for name in ("proposed", "comparison")}
        for name, residual_of in residual.items():
            shared = f"of {len(residual_of)} runs, largest angle in the last 100 s"
            results.quantity(
                f"draws.{reading}.{name}.residual",
                float(np.median(residual_of)),
                source=source,
                method=f"median {shared}",
            )
            results.quantity(
                f"draws.{reading}.{name}.diverged",
                float(np.mean(residual_of > 1.0)),
                source=source,
                method=f"share {shared} above 1 rad",
            )
        ratio[hold] = float(np.median(residual["proposed"]) / np.median(residual["comparison"]))
        better = float(np.mean(residual["proposed"] < residual["comparison"]))
        results.quantity(
            f"draws.{reading}.proposed_smaller",
            better,
            source=source,
            method="share of the common draws with the smaller residual",
        )
        results.say(f"Figures 8 and 9, {reading}", f"proposed has the smaller residual in {better:.0%} of the draws")
    method = "ratio of the medians, proposed over [39], gains drawn once"
    over = over_choice(case, results, "draws.residual_ratio", "draw_hold", ratio, method=method, source=source)
    results.say(source, over.note)
