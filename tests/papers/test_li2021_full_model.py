"""The linear fractional form of the full model and the torque bound over the box of what the paper leaves out."""

from pathlib import Path

import numpy as np
import pytest

from gainsay.errors import CertificateError
from gainsay.proof import check
from gainsay.tables import read_case
from papers.li2021 import plant
from papers.li2021 import proofs_full_model as full_model
from papers.li2021.response import INERTIAS, FlexibleLoop

CASE = read_case(Path(__file__).resolve().parents[2], "li2021")
CONSTANTS = plant.constants(CASE)
A, H, CZ, DW = full_model.linear_fractional(CASE)


def closed(delta: np.ndarray) -> np.ndarray:
    """State matrix with the uncertainty closed: A + H Delta (I - Dw Delta)^-1 Cz."""
    D = np.diag(delta)
    return A + H @ D @ np.linalg.solve(np.eye(len(D)) - DW @ D, CZ)


@pytest.mark.parametrize("inertia", INERTIAS.values())
@pytest.mark.parametrize("seed", range(3))
def test_a_vertex_of_the_form_is_the_plant_with_its_gains_varied(inertia, seed):
    """`plant.closed_loop` builds the same loop without the form: other inertia, gains times 1 + 0.05 F."""
    F = np.random.default_rng(seed).uniform(-1, 1, 12)
    order = plant.uncertainty_factors(CONSTANTS)
    parts = [*F, *inertia, *(inertia[i] for i in order.order_G), *(inertia[i] for i in order.order_D), 0, 0, 0]
    gains, factors = plant.controller(CASE, "proposed"), 1 + 0.05 * F
    wanted = plant.closed_loop(plant.flexible(CONSTANTS, inertia), gains, factors[:6], factors[6:9], factors[9:])
    found = closed(np.array(parts, dtype=float))
    # The third block of H carries B u, whose rows of the mass matrix are those of the nominal inertia in the form.
    assert found[:20, :20] == pytest.approx(wanted, abs=1e-12)


def test_the_disturbance_channel_is_above_table_1_up_to_the_horizon():
    """Every value of d over the horizon, for every inertia, lies within d_max c(t)."""
    times = np.linspace(0, CASE.number("horizon"), 3001)
    n = CONSTANTS.orbital_rate
    shapes = np.stack([np.cos(n * times), np.sin(n * times), np.ones_like(times)])
    decay = full_model.start(CASE, 0.0)[20] * np.exp(-float(full_model.DECAY) * times)
    bound = CZ[27:30, 20][:, None] * decay
    torque = np.abs(plant.disturbance(CASE, CONSTANTS) @ shapes) * 1.05
    assert (torque <= bound * (1 + 1e-12)).all()
    assert bound.min() < 10 * torque.max()  # and not far above it


@pytest.mark.slow
def test_the_bound_is_certified_and_what_runs_exceed_is_refused(monkeypatch):
    P, multipliers = full_model.witness(CASE)
    proof = check(full_model.certificate(CASE, P, multipliers), CASE)
    assert [(c.quantity, c.relation, c.value) for c in proof.conclusions] == [
        ("audit.torque_over_inputs", "at_most", full_model.BOUND)
    ]
    peaks = []
    for inertia in INERTIAS.values():
        for modes in (0.0, 0.04):
            loop = FlexibleLoop(CASE, plant.controller(CASE, "proposed"), phase=1.0, delta=inertia, modes=modes)
            peaks.append(loop.peak(loop.solve(20)).value)
    assert 0.4 < max(peaks) < float(full_model.BOUND)
    with pytest.raises(CertificateError):
        full_model.certificate(CASE, P, 3 * multipliers)
    monkeypatch.setattr(full_model, "BOUND", f"{max(peaks):.3f}")
    with pytest.raises(CertificateError):
        full_model.certificate(CASE, P, multipliers)
