"""Synthesis in discrete time against closed forms, python-control and the bilinear transformation."""

import math

import control
import numpy as np
import pytest

from gainsay.errors import ComputationError, InputError
from gainsay.systems.synthesis import (
    StandardPlant,
    h2_output_feedback,
    h2_state_feedback,
    hinf_output_feedback,
    hinf_state_feedback,
)

DESIGNS = (h2_state_feedback, h2_output_feedback, hinf_state_feedback, hinf_output_feedback)


def scalar(a: float) -> StandardPlant:
    """x+ = a x + w1 + u, z = (x, u), y = x + w2."""
    return StandardPlant([[a]], [[1, 0]], [[1]], [[1], [0]], [[1]], D12=[[0], [1]], D21=[[0, 1]])


def drawn(seed: int, n: int) -> StandardPlant:
    """Unstable, with all of D11, D12, D21."""
    rng = np.random.default_rng(seed)
    A = rng.normal(size=(n, n))
    A *= 1.2 / np.abs(np.linalg.eigvals(A)).max()
    shapes = ((n, 2), (n, 1), (2, n), (1, n), (2, 2), (2, 1), (1, 2))
    return StandardPlant(A, *(rng.normal(size=shape) for shape in shapes))


def sampled(plant: StandardPlant) -> StandardPlant:
    """The discrete plant whose response at z = (1 + s)/(1 - s) is that of a plant at s, its D22 taken out.

    K. Zhou, J. C. Doyle, K. Glover, Robust and Optimal Control, 1996, sections 17.2 (loop shifting) and 21.2.
    """
    inverse = np.linalg.inv(np.eye(len(plant.A)) - plant.A)
    B, C = np.hstack([plant.B1, plant.B2]), np.vstack([plant.C1, plant.C2])
    z, w = plant.D11.shape
    D = C @ inverse @ B
    D[:z, :w] += plant.D11
    D[:z, w:] += plant.D12
    D[z:, :w] += plant.D21
    B, C = math.sqrt(2) * inverse @ B, math.sqrt(2) * C @ inverse
    A = (np.eye(len(plant.A)) + plant.A) @ inverse
    return StandardPlant(A, B[:, :w], B[:, w:], C[:z], C[z:], D[:z, :w], D[:z, w:], D[z:, :w])


@pytest.mark.parametrize("a", [0.0, 0.5, 1.0, -2.0])
def test_h2_of_one_state(a):
    # closed form: P = 1 + a^2 P / (1 + P) for regulator and filter; the squares are P and P + a^2 P^3 / (1 + P)^2,
    # where the measurement of an instant may be used at that instant
    P = (a**2 + math.sqrt(a**4 + 4)) / 2
    state, output = (design(scalar(a), sample=1.0) for design in (h2_state_feedback, h2_output_feedback))
    assert state.norm.upper == pytest.approx(math.sqrt(P), rel=1e-12)
    assert state.controller[0, 0] == pytest.approx(-a * P / (1 + P), abs=1e-12)
    assert output.norm.upper == pytest.approx(math.sqrt(P + a**2 * P**3 / (1 + P) ** 2), rel=1e-12)


@pytest.mark.parametrize("a", [0.0, 0.5, 1.0, -2.0])
def test_hinf_state_feedback_of_one_state(a):
    # closed form: |(1, k)/(z - a - k)| is largest at z = 1 or -1, sqrt(1 + k^2)/(1 - |a + k|), least at k = -a
    found = hinf_state_feedback(scalar(a), sample=1.0)
    least = math.sqrt(1 + a**2)
    assert found.least <= least * (1 + 1e-9) and found.least == pytest.approx(least, rel=1e-6)
    assert least * (1 - 1e-12) <= found.norm.upper <= least * 1.002


@pytest.mark.parametrize("a", [-1.5, 0.0, 0.5, 2.0])
def test_hinf_output_feedback_of_one_state(a):
    # a + sqrt(a^2 + 2) in continuous time (see the tests there), which the bilinear transformation keeps
    found = hinf_output_feedback(sampled(scalar(a)), sample=1.0)
    least = a + math.sqrt(a**2 + 2)
    assert found.least <= least * (1 + 1e-8) and found.least == pytest.approx(least, rel=1e-5)
    assert least <= found.norm.upper * (1 + 1e-12)
    assert found.norm.upper <= least * 1.01


@pytest.mark.parametrize("seed", range(3))
def test_the_bilinear_transformation_keeps_the_least_norm(seed):
    rng = np.random.default_rng(seed)
    plant = StandardPlant(*(rng.normal(size=shape) for shape in ((3, 3), (3, 2), (3, 1), (2, 3), (1, 3))),
                          D12=[[0], [1]], D21=[[0, 1]])  # fmt: skip
    here, there = hinf_output_feedback(plant), hinf_output_feedback(sampled(plant), sample=1.0)
    assert max(here.least, there.least) <= min(here.norm.upper, there.norm.upper)
    assert here.least == pytest.approx(there.least, rel=1e-3)


@pytest.mark.parametrize("seed", range(4))
def test_h2_gains_are_those_of_python_control(seed):
    # independent implementation: control.dlqr, and control.dlqe for the gain of the prediction
    plant = drawn(seed, 3)
    K, _, _ = control.dlqr(plant.A, plant.B2, plant.C1.T @ plant.C1, plant.D12.T @ plant.D12, plant.C1.T @ plant.D12)
    np.testing.assert_allclose(h2_state_feedback(plant, sample=1.0).controller, -K, rtol=1e-7)
    driven = np.hstack([plant.B1, np.zeros((3, 1))])
    simple = StandardPlant(plant.A, driven, plant.B2, plant.C1, plant.C2, D12=plant.D12, D21=[[0, 0, 1]])
    L, _, _ = control.dlqe(plant.A, np.eye(3), plant.C2, plant.B1 @ plant.B1.T, [[1.0]])
    controller = h2_output_feedback(simple, sample=1.0).controller
    # the estimate's own part, before the input is added
    np.testing.assert_allclose(controller.A - plant.B2 @ controller.C, plant.A - L @ plant.C2, rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(controller.B - plant.B2 @ controller.D, L, rtol=1e-6, atol=1e-9)


@pytest.mark.parametrize("seed", range(2))
def test_what_is_promised_is_kept(seed):
    plant, sample = drawn(seed, 3), 0.5
    h2, hinf = h2_output_feedback(plant, sample=sample), hinf_output_feedback(plant, sample=sample)
    angles = np.linspace(0, np.pi, 2001)
    for found in (h2, hinf):
        loop = plant.with_controller(found.controller)
        responses = np.moveaxis(control.ss(loop.A, loop.B, loop.C, loop.D, sample)(np.exp(1j * angles)), 2, 0)
        # second computations: Parseval's integral, and the peak on a grid
        mean = np.trapezoid(np.abs(responses) ** 2, dx=1 / 2000, axis=0).sum()
        peak = np.linalg.norm(responses, 2, axis=(1, 2)).max()
        assert math.sqrt(mean) >= h2.norm.lower * (1 - 1e-6) and peak >= hinf.least * 0.999
        if found is h2:
            assert math.sqrt(mean) == pytest.approx(found.norm.upper, rel=1e-6)
        else:
            assert found.norm.lower * 0.999 <= peak <= found.norm.upper * (1 + 1e-9)
    # law: knowing the state and not its output helps, where y tells nothing of the present disturbance
    blind = StandardPlant(plant.A, plant.B1, plant.B2, plant.C1, plant.C2, D12=plant.D12)
    assert h2_state_feedback(blind, sample=sample).least <= h2_output_feedback(blind, sample=sample).least


def test_a_plant_and_its_deadbeat_gain():
    # x+ = x + u + w, z = x: u = -x leaves z+ = w, and no gain that sees x alone does better: both norms are one
    plant = StandardPlant([[1.0]], [[1.0]], [[1.0]], [[1.0]], [[1.0]])
    found = h2_state_feedback(plant, sample=1.0)
    assert found.controller[0, 0] == pytest.approx(-1.0) and found.norm.upper == pytest.approx(1.0, rel=1e-12)
    assert hinf_state_feedback(plant, sample=1.0).least == pytest.approx(1.0, rel=1e-6)


def test_plants_without_an_answer_are_refused():
    fixed = StandardPlant(
        [[1.1, 0], [0, 0.5]], np.eye(2), [[0], [1]], np.eye(3, 2), [[1, 0]], D12=[[0], [0], [1]], D21=[[0, 1]]
    )
    for design in DESIGNS:
        with pytest.raises((InputError, ComputationError)):
            design(fixed, sample=1.0)  # an unstable state that no input moves
        for sample in (0.0, -1.0, math.nan, math.inf):
            with pytest.raises(InputError, match="sample"):
                design(scalar(0.5), sample=sample)
