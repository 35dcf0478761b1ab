"""No controller does better: lower bounds on H2 norms against closed forms, other loops and what breaks them."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gainsay.errors import CertificateError, ComputationError, GainsayError
from gainsay.proof import MappingTables, build
from gainsay.systems.norms import h2_enclosure
from gainsay.systems.statespace import StateSpace
from gainsay.systems.synthesis import StandardPlant, h2_least, h2_output_feedback, h2_state_feedback

TABLES = MappingTables(name="toy")


def made(plant, lower, witness, output=False):
    """Certificate of a plant of rational numbers."""
    names = ("A", "B1", "B2", "C1", "D12", *(("C2", "D21") if output else ()))
    fields = {name: str(getattr(plant, name).tolist()) for name in names}
    return build.certificate(
        "h2_least", id="c", statement="S.", tables=TABLES, fields={**fields, "lower": lower}, witness=witness
    )


def scalar(a, noise=0.5):
    """x' = a x + w1 + u, z = (x, u), y = x + noise w2."""
    return StandardPlant([[a]], [[1, 0]], [[1]], [[1], [0]], [[1]], D12=[[0], [1]], D21=[[0, noise]])


def oscillator(damping=0.1):
    return StandardPlant(
        [[0, 1], [-1, -damping]], [[0, 0], [1, 0]], [[0], [1]], [[1, 0], [0, 0]], [[1, 0]], D12=[[0], [1]], D21=[[0, 1]]
    )


@pytest.mark.parametrize("a", [-2.0, -0.5, 0.0, 0.5, 3.0])
def test_the_scalar_regulator(a):
    # 2 a p + 1 - p^2 = 0, and the squared norm is p: closed form
    least = math.sqrt(a + math.sqrt(a**2 + 1))
    lower, witness = h2_least(scalar(a))
    assert least * (1 - 1e-8) <= lower <= least
    made(scalar(a), f"{least * (1 - 1e-7):.15f}", witness)
    with pytest.raises(CertificateError, match="not proved"):
        made(scalar(a), f"{least * (1 + 1e-12):.15f}", witness)


@pytest.mark.parametrize("a", [-1.0, 0.0, 1.0])
@pytest.mark.parametrize("noise", [0.25, 1.0])
def test_the_scalar_regulator_on_a_filter(a, noise):
    # with the filter's 2 a s + 1 - s^2 / noise^2 = 0 the squared norm is p + p^2 s: closed form
    p = a + math.sqrt(a**2 + 1)
    s = noise**2 * (a + math.sqrt(a**2 + 1 / noise**2))
    least = math.sqrt(p + p**2 * s)
    lower, witness = h2_least(scalar(a, noise), output=True)
    assert least * (1 - 1e-8) <= lower <= least
    made(scalar(a, noise), f"{least * (1 - 1e-7):.15f}", witness, output=True)
    with pytest.raises(CertificateError, match="not proved"):
        made(scalar(a, noise), f"{least * (1 + 1e-12):.15f}", witness, output=True)


def test_the_double_integrator_from_a_start():
    # x1'' = u from (1, 0) with the cost x1^2 + u^2: sqrt(2), P = [[sqrt 2, 1], [1, sqrt 2]] (Anderson and Moore, 1990)
    plant = StandardPlant([[0, 1], [0, 0]], [[1], [0]], [[0], [1]], [[1, 0], [0, 0]], [[1, 0]], D12=[[0], [1]])
    lower, witness = h2_least(plant)
    assert lower == pytest.approx(2**0.25, rel=1e-8)
    assert witness["P"] == pytest.approx(np.array([[math.sqrt(2), 1], [1, math.sqrt(2)]]), rel=1e-6)


@pytest.mark.parametrize("damping", [0.1, -0.5, 1e-6])
@pytest.mark.parametrize("output", [False, True])
def test_the_best_loop_reaches_the_bound(damping, output):
    plant = oscillator(damping)
    found = (h2_output_feedback if output else h2_state_feedback)(plant)
    lower, _ = h2_least(plant, output=output)
    assert lower <= found.norm.upper <= lower * (1 + 1e-7)


@given(st.integers(0, 10_000))
@settings(max_examples=8)
def test_no_stable_loop_is_below_the_bound(seed):
    rng = np.random.default_rng(seed)
    plant = oscillator(rng.uniform(-1, 1))
    state, output = h2_least(plant)[0], h2_least(plant, output=True)[0]
    assert state <= output
    loops = [(plant.with_gain(rng.normal(size=(1, 2)) * 2), state)]
    controller = StateSpace(rng.normal(size=(2, 2)) - 2 * np.eye(2), rng.normal(size=(2, 1)), rng.normal(size=(1, 2)))
    loops.append((plant.with_controller(controller), output))
    for loop, bound in loops:
        try:
            norm = h2_enclosure(loop.A, loop.B, loop.C, loop.D)
        except GainsayError:  # not stable
            continue
        assert bound <= norm.upper


def test_what_a_bound_needs():
    plant = oscillator()
    lower, witness = h2_least(plant, output=True)
    said = f"{lower * (1 - 1e-6):.12f}"
    made(plant, said, witness, output=True)
    bad = [
        {**witness, "P": witness["P"] * (1 + 1e-6)},
        {**witness, "S": witness["S"] * (1 + 1e-6)},
        {**witness, "R": witness["R"] * (1 + 1e-6)},
        {**witness, "F": witness["F"] * 1.01},
        {**witness, "P": witness["P"] + [[0, 1e-6], [0, 0]]},
        {name: value for name, value in witness.items() if name != "S"},
    ]
    for changed in bad:
        with pytest.raises(CertificateError):
            made(plant, said, changed, output=True)
    for text in ("-0.1", "1/0", "sqrt(2)", "pi", "x"):
        with pytest.raises(CertificateError):
            made(plant, text, witness, output=True)


def test_singular_weights_are_refused_for_a_controller_from_an_output():
    # without noise in y, or without a cost of u, a controller may pass w on: the bound would not hold
    plant, (_, witness) = oscillator(), h2_least(oscillator(), output=True)
    for changed in ({"D21": [[0, 0]]}, {"D12": [[0], [0]]}):
        parts = {name: getattr(plant, name) for name in ("A", "B1", "B2", "C1", "C2", "D11", "D12", "D21")}
        with pytest.raises(CertificateError, match="> 0 is not proved"):
            made(StandardPlant(**{**parts, **changed}), "0.1", witness, output=True)


def test_one_of_two_fields_is_refused():
    plant, (_, witness) = oscillator(), h2_least(oscillator())
    fields = {name: str(getattr(plant, name).tolist()) for name in ("A", "B1", "B2", "C1", "D12", "C2")}
    with pytest.raises(CertificateError, match="D21"):
        build.certificate(
            "h2_least", id="c", statement="S.", tables=TABLES, fields={**fields, "lower": "0"}, witness=witness
        )


def test_a_plant_that_no_controller_stabilises_is_refused():
    with pytest.raises(ComputationError, match="H2 synthesis"):
        h2_least(StandardPlant([[1]], [[1]], [[0]], [[1], [0]], [[1]], D12=[[0], [1]]))
