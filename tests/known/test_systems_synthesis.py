"""Synthesis against closed forms, python-control and laws: what a controller reaches, and what none reaches."""

import math

import control
import numpy as np
import pytest

from gainsay.errors import ComputationError, InputError
from gainsay.systems.synthesis import (
    StandardPlant,
    h2_output_feedback,
    h2_state_feedback,
    hinf_least_level,
    hinf_output_feedback,
    hinf_state_feedback,
)


def scalar(a: float) -> StandardPlant:
    """x' = a x + w1 + u, z = (x, u), y = x + w2."""
    return StandardPlant([[a]], [[1, 0]], [[1]], [[1], [0]], [[1]], D12=[[0], [1]], D21=[[0, 1]])


def drawn(seed: int, n: int) -> StandardPlant:
    rng = np.random.default_rng(seed)
    return StandardPlant(
        rng.normal(size=(n, n)), rng.normal(size=(n, 2)), rng.normal(size=(n, 1)), rng.normal(size=(2, n)),
        rng.normal(size=(1, n)), D12=[[0], [1]], D21=[[0, 1]],
    )  # fmt: skip


@pytest.mark.parametrize("a", [-0.5, -1.0, -3.0])
def test_state_feedback_of_one_state(a):
    # closed form: |(1, k)/(s - a - k)| at s = 0 is least for k = 1/a, where it is 1/sqrt(1 + a^2)
    found = hinf_state_feedback(scalar(a))
    least = 1 / math.sqrt(1 + a**2)
    assert found.least <= least * (1 + 1e-9) and found.least == pytest.approx(least, rel=1e-6)
    assert least <= found.norm.upper <= least * 1.002


@pytest.mark.parametrize("a", [-1.0, 0.0, 1.0, 2.0])
def test_output_feedback_of_one_state(a):
    # closed form by the Riccati equations of Doyle, Glover, Khargonekar, Francis (1989), X = Y by symmetry and
    # spectral radius gamma^2 at the optimum: X = gamma in 2 a X + X^2 (1/gamma^2 - 1) + 1 = 0 gives a + sqrt(a^2 + 2)
    found = hinf_output_feedback(scalar(a))
    least = a + math.sqrt(a**2 + 2)
    assert found.least <= least * (1 + 1e-8) and found.least == pytest.approx(least, rel=1e-5)
    assert least <= found.norm.upper * (1 + 1e-12)
    assert found.norm.upper <= least * 1.01


@pytest.mark.parametrize("a", [-1.0, 0.0, 1.0, 2.0])
def test_h2_of_one_state(a):
    # closed form: 2 a X - X^2 + 1 = 0 for regulator and filter; the squares are X, and X + X^3 with the filter
    X = a + math.sqrt(a**2 + 1)
    assert h2_state_feedback(scalar(a)).norm.upper == pytest.approx(math.sqrt(X), rel=1e-12)
    assert h2_output_feedback(scalar(a)).norm.upper == pytest.approx(math.sqrt(X + X**3), rel=1e-12)


@pytest.mark.parametrize("seed", range(4))
def test_h2_gains_are_those_of_python_control(seed):
    # independent implementation: control.lqr and control.lqe
    plant = drawn(seed, 3)
    K, _, _ = control.lqr(plant.A, plant.B2, plant.C1.T @ plant.C1, [[1.0]], plant.C1.T @ plant.D12)
    np.testing.assert_allclose(h2_state_feedback(plant).controller, -K, rtol=1e-7)
    simple = StandardPlant(
        plant.A, np.hstack([plant.B1, np.zeros((3, 1))]), plant.B2, plant.C1, plant.C2, D12=plant.D12, D21=[[0, 0, 1]]
    )
    L, _, _ = control.lqe(plant.A, np.eye(3), plant.C2, plant.B1 @ plant.B1.T, [[1.0]])
    np.testing.assert_allclose(h2_output_feedback(simple).controller.B, L, rtol=1e-7)


@pytest.mark.parametrize("seed", range(3))
def test_what_is_promised_is_kept_and_more_knowledge_helps(seed):
    plant = drawn(seed, 3)
    state, output = hinf_state_feedback(plant), hinf_output_feedback(plant)
    # law: a static gain of the state does at least as well as a controller of one output
    assert state.least <= output.norm.upper
    for found, loop in ((state, plant.with_gain(state.controller)), (output, plant.with_controller(output.controller))):
        assert found.least <= found.norm.upper <= found.least * 1.2
        # second computation: the response in double precision, at the frequency named and on a grid
        assert np.linalg.norm(loop.response(found.norm.frequency), 2) == pytest.approx(found.norm.lower, rel=1e-9)
        gains = [np.linalg.norm(loop.response(w), 2) for w in np.append(0.0, np.geomspace(1e-4, 1e6, 2000))]
        assert max(gains) <= found.norm.upper * (1 + 1e-9)


def test_plants_without_an_answer_are_refused():
    with pytest.raises(InputError, match="D12"):
        h2_state_feedback(StandardPlant([[1]], [[1]], [[1]], [[1]], [[1]]))
    with pytest.raises(InputError, match="D21"):
        h2_output_feedback(StandardPlant([[1]], [[1]], [[1]], [[1], [0]], [[1]], D12=[[0], [1]]))
    with pytest.raises(InputError, match="D11"):
        h2_state_feedback(StandardPlant([[1]], [[1]], [[1]], [[1], [0]], [[1]], D11=[[1], [0]], D12=[[0], [1]]))
    with pytest.raises(InputError, match=r"C2.*expected shape \(1, 2\)|C2"):
        StandardPlant(np.eye(2), np.ones((2, 1)), np.ones((2, 1)), np.eye(2), [[1.0]])
    with pytest.raises(InputError, match="B1"):
        StandardPlant([[1]], [[math.nan]], [[1]], [[1]], [[1]])
    # an unstable state that no input moves
    fixed = StandardPlant(
        [[1, 0], [0, -1]], np.eye(2), [[0], [1]], np.eye(3, 2), [[1, 0]], D12=[[0], [0], [1]], D21=[[0, 1]]
    )
    for design in (hinf_state_feedback, hinf_output_feedback, h2_state_feedback, h2_output_feedback):
        with pytest.raises((InputError, ComputationError)):
            design(fixed)


@pytest.mark.parametrize("a", [-2.0, 0.0, 1.5])
def test_the_least_level_of_one_state(a):
    """X = Y solve 2 a X + 1 = (1 - 1/g^2) X^2; X^2 = g^2 gives (1 - 1/g^2) g^2 - 2 a g = 1: g = a + sqrt(a^2 + 2)."""
    low, high = hinf_least_level(scalar(a))
    assert low < a + math.sqrt(a**2 + 2) <= high * (1 + 1e-9)
    assert high - low <= 1e-10 * high


def test_the_least_level_lies_between_what_none_and_what_one_reaches():
    """Another method: linear matrix inequalities, with a proved lower end and a controller whose norm is proved."""
    plant = drawn(5, 3)
    found, (low, high) = hinf_output_feedback(plant), hinf_least_level(plant)
    assert found.least <= high * (1 + 1e-9)
    assert low <= found.norm.upper <= high * 1.2


@pytest.mark.parametrize(
    ("plant", "said"),
    [
        (StandardPlant([[0.0]], [[1, 0]], [[1]], [[1], [0]], [[1]], D12=[[0], [0]], D21=[[0, 1]]), "D12"),
        (StandardPlant([[0.0]], [[1, 0]], [[1]], [[1], [0]], [[1]], D12=[[0], [1]]), "D21"),
        (StandardPlant([[0.0]], [[1]], [[1]], [[1], [0]], [[1]], [[1], [0]], [[0], [1]], [[1]]), "D11"),
    ],
)
def test_a_plant_outside_the_two_equations_is_refused(plant, said):
    with pytest.raises(InputError, match=said):
        hinf_least_level(plant)


def test_no_level_is_reached_where_the_plant_cannot_be_stabilised():
    plant = StandardPlant(
        np.diag([1.0, -1.0]), [[1, 0], [0, 0]], [[0], [1]], [[1, 0], [0, 0]], [[1, 1]], D12=[[0], [1]], D21=[[0, 1]]
    )
    with pytest.raises(ComputationError, match="no controller reaches"):
        hinf_least_level(plant)
