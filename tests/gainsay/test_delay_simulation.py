import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import expm

from gainsay.errors import ComputationError, InputError
from gainsay.simulation.delay import DelayLaw, delay_mesh, simulate_delay
from gainsay.simulation.delay_steps import Collocation

A = np.array([[0, 1.0], [-40, -0.3]])
BD = np.array([[0], [1.0]])
CD = np.array([[-5.0, -4.0]])


def touching(mean: float = 0.015, frequency: float = 6.0) -> DelayLaw:
    """d(t) = mean (1 + sin(frequency t)): touches zero and 2 mean."""
    return DelayLaw(lambda t: mean * (1 + np.sin(frequency * t)), 2 * mean, mean * frequency * (1 + 1e-9))


def exact_state(t: np.ndarray) -> np.ndarray:
    """A manufactured solution: constant before 0, with a kink there."""
    t = np.maximum(np.asarray(t, dtype=float), 0)
    return np.stack([0.3 + t * np.sin(2 * t), np.cos(3 * t) + t], axis=-1)


def manufactured(law: DelayLaw):
    """Forcing under which `exact_state` solves the equation, by substitution."""

    def forcing(t: np.ndarray) -> np.ndarray:
        slope = np.stack([np.sin(2 * t) + 2 * t * np.cos(2 * t), 1 - 3 * np.sin(3 * t)], axis=-1)
        return slope - exact_state(t) @ A.T - exact_state(t - law(t)) @ CD.T @ BD.T

    return forcing


def error(stages: int, step: float) -> float:
    law = touching()
    found = simulate_delay(A, BD, CD, law, exact_state(0.0), 3.0, forcing=manufactured(law), step=step, stages=stages)
    times = np.linspace(0, 3, 997)
    return float(np.abs(found(times) - exact_state(times)).max())


def test_error_is_below_1e_8_where_the_delay_touches_zero():
    assert error(5, 0.02) < 1e-10


@pytest.mark.parametrize("stages", [1, 2, 3, 4])
def test_uniform_order_is_one_more_than_the_number_of_points(stages):
    coarse, fine = error(stages, 0.04), error(stages, 0.02)
    assert math.log2(coarse / fine) == pytest.approx(stages + 1, abs=0.35)


def test_constant_delay_follows_the_method_of_steps():
    # x' = -x(t - 1), x = 1 before 0: 1 - t on [0, 1], then 1 - t + (t - 1)^2/2, then - (t - 2)^3/6 more
    law = DelayLaw(lambda t: np.ones_like(t), 1.0, 0.0)
    found = simulate_delay([[0.0]], [[-1.0]], [[1.0]], law, [1.0], 3.0, step=0.3)
    t = np.linspace(0, 3, 61)
    expected = 1 - t + np.where(t > 1, (t - 1) ** 2 / 2, 0) - np.where(t > 2, (t - 2) ** 3 / 6, 0)
    np.testing.assert_allclose(found(t)[:, 0], expected, atol=1e-13)


def test_vanishing_delay_is_the_ordinary_equation():
    law = DelayLaw(lambda t: np.zeros_like(t), 0.0, 0.0)
    found = simulate_delay(A, BD, CD, law, [0.3, 1.0], 2.0, step=0.02)
    np.testing.assert_allclose(found(np.array([2.0]))[0], expm(2 * (A + BD @ CD)) @ [0.3, 1.0], atol=1e-10)


@given(st.floats(0.05, 0.9), st.floats(-2, 2), st.floats(-2, 2))
@settings(max_examples=10)
def test_solutions_superpose(mean, a, b):
    law = touching(mean, 0.5)
    one, two, both = (
        simulate_delay(A, BD, CD, law, x, 1.5, step=0.1)(np.array([0.7, 1.5])) for x in ([1.0, 0.0], [0.0, 1.0], [a, b])
    )
    np.testing.assert_allclose(both, a * one + b * two, atol=1e-10)


def test_integral_is_that_of_the_polynomial():
    law = touching()
    found = simulate_delay(A, BD, CD, law, exact_state(0.0), 3.0, forcing=manufactured(law), step=0.02)
    # int of x1 = 0.3 t + (sin 2t - 2 t cos 2t)/4
    times = np.array([0.013, 1.0, 3.0])
    expected = 0.3 * times + (np.sin(2 * times) - 2 * times * np.cos(2 * times)) / 4
    np.testing.assert_allclose(found.integral(lambda t, x: x[:, 0], times), expected, atol=1e-11)


def test_integral_from_a_start_is_a_difference_of_integrals_and_does_not_cancel():
    law = DelayLaw(lambda t: 0 * t, 0.0, 0.0)
    found = simulate_delay([[-1.0]], [[0.0]], [[1.0]], law, [1.0], 20.0, step=0.1)
    tail = found.integral(lambda t, x: x[:, 0] ** 2, [19.05, 20.0], start=18.03)
    closed = (np.exp(-2 * 18.03) - np.exp(-2 * np.array([19.05, 20.0]))) / 2  # 1e-16 of the integral from the start
    np.testing.assert_allclose(tail, closed, rtol=1e-9)


def test_derivative_and_history():
    law = touching()
    found = simulate_delay(A, BD, CD, law, exact_state(0.0), 3.0, forcing=manufactured(law), step=0.02)
    times = np.array([0.5, 2.5])
    expected = np.sin(2 * times) + 2 * times * np.cos(2 * times)
    np.testing.assert_allclose(found.derivative(times)[:, 0], expected, atol=1e-8)
    np.testing.assert_allclose(found(np.array([-1.0]))[0], exact_state(0.0))
    assert found.derivative(np.array([-1.0]))[0, 0] == 0
    with pytest.raises(InputError, match="at most 3 s"):
        found(np.array([3.1]))


def test_breakpoints_are_mesh_points():
    law = touching()
    points = law.breakpoints(0.0, 4)
    before = 0.0
    for point in points:
        assert point - float(law(point)) == pytest.approx(before, abs=1e-15)
        before = point
    mesh, steps = delay_mesh(law, 0.0, 1.0, 0.05, 3)
    assert set(points) <= set(mesh)
    np.testing.assert_allclose(np.diff(mesh), steps, atol=1e-15)


@pytest.mark.parametrize(
    ("law", "message", "time"),
    [
        (DelayLaw(lambda t: 0.02 + 0.02 * np.sin(t), 0.03, 0.1), "delay at t", math.asin(0.5)),
        (DelayLaw(lambda t: 0.01 * np.cos(t), 0.03, 0.1), "delay at t", math.pi / 2),
        (DelayLaw(lambda t: 0.02 + 0.01 * np.sin(20 * (t - 1)) * (t > 1), 0.03, 0.1), "delay rate near t", 1.0),
    ],
)
def test_a_law_that_leaves_its_bounds_is_refused_with_the_time(law, message, time):
    with pytest.raises(InputError, match=message) as refused:
        simulate_delay(A, BD, CD, law, [0, 0], 5.0)
    said = float(str(refused.value).split("t = ")[1].split(" s")[0])
    assert said == pytest.approx(time, abs=0.02 if "rate" in message else 1e-6)


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        ({"end": 0.0}, "start < end"),
        ({"step": -1.0}, "step > 0"),
        ({"stages": 9}, "1..8"),
        ({"initial": [0.0]}, "shapes"),
        ({"law": DelayLaw(lambda t: 0 * t + math.nan, 1.0, 0.0)}, "finite time"),
    ],
)
def test_bad_input_is_refused(change, expected):
    given = {"law": touching(), "initial": [0.0, 0.0], "end": 1.0} | change
    with pytest.raises(InputError, match=expected.replace(".", r"\.")):
        simulate_delay(A, BD, CD, given.pop("law"), given.pop("initial"), given.pop("end"), **given)


@pytest.mark.parametrize(("high", "rate", "expected"), [(1.0, 1.0, "below 1"), (math.inf, 0.0, "finite")])
def test_bounds_that_no_law_keeps_are_refused(high, rate, expected):
    with pytest.raises(InputError, match=expected):
        DelayLaw(lambda t: 0 * t, high, rate)


def test_overflow_is_reported():
    law = DelayLaw(lambda t: 0 * t, 0.0, 0.0)
    with pytest.raises(ComputationError, match="double precision"), np.errstate(all="ignore"):
        simulate_delay([[800.0]], [[0.0]], [[1.0]], law, [1.0], 30.0, step=0.01)


def test_gauss_weights_are_those_of_quadrature():
    rule = Collocation.gauss(4)
    for power in range(8):  # exact to degree 2 s - 1
        assert rule.weights @ rule.nodes**power == pytest.approx(1 / (power + 1), abs=1e-15)


@pytest.mark.parametrize("second", [1e-12, 1e-6, 1.0, 1e9])
def test_breakpoints_do_not_depend_on_the_unit_of_time(second):
    # closed forms by steps: x' = -x(t - 1) from 1 is -1/6 at 3; a pulse from 0.4 to 0.9 leaves 0.5 - 0.175 of it at 2
    law = DelayLaw(lambda t: np.full_like(t, second), second, 0.0)
    parts = ([[0.0]], [[-1 / second]], [[1.0]], law)
    free = simulate_delay(*parts, [1.0], 3 * second, step=0.31 * second, stages=2)
    assert free(3 * second)[0, 0] == pytest.approx(-1 / 6, abs=1e-14)

    def pulse(t):
        return ((t > 0.4 * second) & (t < 0.9 * second))[:, None] / second

    jumps = (0.4 * second, 0.9 * second)
    pushed = simulate_delay(*parts, [0.0], 2 * second, forcing=pulse, jumps=jumps, step=0.31 * second, stages=2)
    assert pushed(2 * second)[0, 0] == pytest.approx(0.325, abs=1e-14)


@pytest.mark.slow
def test_an_independent_integrator_agrees():
    jitcdde = pytest.importorskip("jitcdde")
    pytest.importorskip("sympy")  # jitcdde writes its C code with it
    import symengine

    law = touching()
    found = simulate_delay(A, BD, CD, law, [0.3, 1.0], 4.0, step=0.02)
    t, y = jitcdde.t, jitcdde.y
    late = t - 0.015 * (1 + symengine.sin(6 * t))
    right = [y(1), -40 * y(0) - 0.3 * y(1) - 5 * y(0, late) - 4 * y(1, late)]
    other = jitcdde.jitcdde(right, max_delay=0.03)
    other.constant_past([0.3, 1.0])
    other.set_integration_parameters(atol=1e-12, rtol=1e-11, first_step=1e-4, max_step=5e-3)
    other.adjust_diff()
    times = np.linspace(0.5, 4, 8)
    reached = np.array([other.integrate(time) for time in times])
    np.testing.assert_allclose(reached, found(times), atol=1e-8)
