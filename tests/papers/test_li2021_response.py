"""Runs of li2021 in time: against an adaptive integrator, redrawn gains, and the quaternions of the scene."""

from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from gainsay.dynamics.attitude import direction_cosines
from gainsay.tables import read_case
from papers.li2021 import plant, response, runs
from papers.li2021.response import FlexibleLoop

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def case():
    return read_case(ROOT, "li2021")


@pytest.fixture(scope="module")
def loop(case):
    return FlexibleLoop(case, plant.controller(case, "proposed"))


def direct(case, loop, end):
    """DOP853 on the equations as the paper writes them: disturbance and gains as functions of time."""
    k, gains = plant.constants(case), plant.controller(case, "proposed")
    full, n = plant.flexible(k), k.orbital_rate
    J = np.array(k.inertia)

    def rate(t, s):
        factor = 1 + 0.05 * np.sin(2 * np.pi * t)
        c, sn = np.cos(n * t), np.sin(n * t)
        d = 1.5e-5 * J * np.array([3 * c + 1, 1.5 * sn + 3 * c, 3 * sn + 1])
        u = factor * gains.C @ s[14:]
        return np.concatenate([full.A @ s[:14] + full.B @ (u + d), factor * (gains.A @ s[14:] + gains.B @ s[:3])])

    return solve_ivp(rate, (0, end), loop.start()[:20], method="DOP853", rtol=1e-10, atol=1e-13, dense_output=True)


def test_against_adaptive_integrator(case, loop):
    # oracle: scipy's DOP853 on an independent writing of the equations
    found, oracle = loop.solve(40), direct(case, loop, 6.0)
    keep = found.times <= 6.0
    assert np.abs(found.states[keep, :20] - oracle.sol(found.times[keep]).T).max() < 1e-8


@pytest.mark.slow
def test_peak_torque_against_adaptive_integrator(case, loop):
    # oracle: a dense grid over the same dense output; the located peak can only be larger, by the grid's resolution
    oracle = direct(case, loop, 60.0)
    t = np.linspace(0, 60, 600_001)
    size = (1 + 0.05 * np.sin(2 * np.pi * t)) * np.linalg.norm(oracle.sol(t)[14:].T @ loop.gains.C.T, axis=1)
    peak = loop.peak(loop.solve(40))
    assert peak.value == pytest.approx(size.max(), rel=1e-7)
    assert peak.time == pytest.approx(t[size.argmax()], abs=2e-4)


def test_constant_draw_is_one_loop(case):
    # identity: with the draw's own factors the run is that of a constant loop
    still = FlexibleLoop(case, plant.controller(case, "proposed"), amplitude=0.0)
    factors = 1 + np.random.default_rng((1, 2)).random((1, 12))[0]
    times, states = response.redrawn(still, "constant", [np.random.default_rng((1, 2))])
    states = states[:, 0]
    assert times[-1] == case.number("horizon")
    step = np.diff(states[:40], axis=0) / np.diff(times[:40])[:, None]
    assert np.isfinite(step).all()
    whole = still.nominal.copy()
    whole[:20, :20] = still.state_matrix(factors)
    oracle = solve_ivp(lambda t, s: whole @ s, (0, 5), still.start(), method="DOP853", rtol=1e-10, atol=1e-14)
    assert np.allclose(states[5], oracle.y[:, -1], rtol=1e-7, atol=1e-10)


def test_redrawn_nodes(case):
    still = FlexibleLoop(case, plant.controller(case, "proposed"), amplitude=0.0)
    alone = [response.redrawn(still, "0.1", [np.random.default_rng(seed)])[1] for seed in (0, 1)]
    times, states = response.redrawn(still, "0.1", [np.random.default_rng(seed) for seed in (0, 1)])
    assert len(times) == 3001 and states.shape == (3001, 2, 23)
    # the constant signal of the disturbance stays one
    assert np.allclose(states[..., 22], 1.0)
    # oracle: the exponentials that a run by itself goes by
    assert np.allclose(states, np.concatenate(alone, axis=1), rtol=1e-12, atol=1e-12 * np.abs(states).max())


def test_quaternions_are_the_rotation_of_the_angles():
    # identity: the rotation of the quaternion (body to LVLH) is the transpose of the direction cosines
    angles = np.array([[0.3, -0.5, 0.9], [0.0, 0.0, 0.0]])
    for (x, y, z, w), row in zip(runs.quaternions(angles), angles, strict=True):
        cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        rotation = np.eye(3) + 2 * w * cross + 2 * cross @ cross
        assert np.allclose(rotation, direction_cosines(row).T, atol=1e-14)
