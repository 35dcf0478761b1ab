import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from gainsay.errors import InputError
from gainsay.simulation.linear import Consecutive, Response, with_harmonics


@given(st.floats(0.05, 0.9), st.floats(0.2, 3.0), st.integers(40, 400))
@settings(max_examples=30)
def test_peaks_of_an_oscillator_have_their_closed_form(damping, w, steps):
    A = np.array([[0, 1], [-(w**2), -2 * damping * w]])
    response = Response(A, np.array([0.0, 1.0]), 20 / w, steps)
    # Closed form: x = e^(-d w t) sin(v t)/v peaks at v t = acos d, at e^(-d acos(d)/sqrt(1 - d^2))/w.
    v = np.sqrt(1 - damping**2)
    peak = response.peak(np.array([1.0, 0.0]))
    assert peak.value == pytest.approx(np.exp(-damping * np.arccos(damping) / v) / w, rel=1e-10)
    assert peak.time == pytest.approx(np.arccos(damping) / (v * w), rel=1e-6)


@given(st.floats(0.05, 0.7), st.floats(0.2, 3.0), st.integers(40, 400))
@settings(max_examples=30, deadline=None)
def test_the_largest_value_of_either_sign_has_its_closed_form(damping, w, steps):
    A = np.array([[0, 1], [-(w**2), -2 * damping * w]])
    response, x = Response(A, np.array([1.0, 0.0]), 20 / w, steps), np.array([1.0, 0.0])
    # from rest at 1 it swings to -e^(-pi d/sqrt(1 - d^2)) on the other side, half a period later
    v = np.sqrt(1 - damping**2)
    assert response.largest(x) == response.peak(x)
    assert response.largest(x).value == 1
    assert response.largest(-x).value == pytest.approx(np.exp(-np.pi * damping / v), rel=1e-10)
    assert response.largest(-x).time == pytest.approx(np.pi / (v * w), rel=1e-6)


def test_largest_of_what_is_always_negative_lies_between_samples():
    # Closed form: cos t - 3 is largest at 2 pi, which is no sample of 0.5..12.5 in steps of 0.8.
    swing = np.array([[0, 1, 0], [-1, 0, 0], [0, 0, 0]], dtype=float)
    response = Response(swing, np.array([np.cos(0.5), -np.sin(0.5), 1.0]), 7.2, 9)
    largest = response.largest(np.array([1.0, 0.0, -3.0]))
    assert largest.value == pytest.approx(-2.0, abs=1e-12)
    assert largest.time + 0.5 == pytest.approx(2 * np.pi, abs=1e-6)


@given(st.integers(0, 10_000), st.lists(st.integers(1, 60), min_size=1, max_size=5))
@settings(max_examples=30, deadline=None)
def test_what_is_cut_into_pieces_has_the_peaks_of_the_whole(seed, cuts):
    # identity: with the same steps the samples are the same, wherever it is cut
    generator = np.random.default_rng(seed)
    A, start = generator.standard_normal((4, 4)) - np.eye(4), generator.standard_normal(4)
    whole, pieces, begin, state = Response(A, start, 0.05 * sum(cuts), sum(cuts)), [], 0.0, start
    for steps in cuts:
        pieces.append((begin, Response(A, state, 0.05 * steps, steps)))
        begin, state = begin + 0.05 * steps, pieces[-1][1].states[-1]
    parts, output = Consecutive(pieces), generator.standard_normal(4)
    for found, expected in ((parts.peak(output), whole.peak(output)), (parts.largest(output), whole.largest(output))):
        assert found.value == pytest.approx(expected.value, rel=1e-9)
        assert found.time == pytest.approx(expected.time, abs=1e-6)


@given(st.floats(0.05, 0.9), st.floats(0.2, 3.0), st.integers(40, 400))
@settings(max_examples=30)
def test_rise_times_have_their_closed_form(damping, w, steps):
    """The error -e^(-d w t) (cos v w t + d/v sin v w t) of a unit step is zero first at v w t = pi - acos d."""
    A = np.array([[0, 1], [-(w**2), -2 * damping * w]])
    response, error = Response(A, np.array([-1.0, 0.0]), 20 / w, steps), np.array([1.0, 0.0])
    v = np.sqrt(1 - damping**2)
    assert response.first_crossing(error, 0.0) == pytest.approx((np.pi - np.arccos(damping)) / (v * w), rel=1e-8)
    assert response.first_crossing(-error, 0.0) == response.first_crossing(error, 0.0)
    assert response.first_crossing(error, -1.0) == 0.0
    assert response.first_crossing(error, 1.0) == response.end  # it overshoots by less than the step


def test_settling_of_a_first_order_lag():
    # Closed form: e^(-t/3) falls below 0.02 at 3 ln 50.
    response = Response(np.array([[-1 / 3]]), np.array([1.0]), 30.0, 50)
    assert response.last_above(np.array([1.0]), 0.02) == pytest.approx(3 * np.log(50), rel=1e-9)
    assert response.last_above(np.array([1.0]), 1e-9) == 30.0
    assert response.last_above(np.array([1.0]), 2.0) == 0.0


def test_harmonics_agree_with_an_integrator():
    A, shape = np.array([[0, 1], [-0.5, -0.4]]), np.array([0.0, 0.7])
    rates = (0.3, 0.6)
    whole, extra = with_harmonics(A, shape, rates, 0.2, constant=0.1)
    response = Response(whole, np.concatenate([[1.0, 0.0], extra]), 25.0, 77)

    def slope(t, x):
        return A @ x + shape * (0.2 * sum(np.sin(r * t) for r in rates) + 0.1)

    # Independent method: an adaptive integrator at 1e-11.
    other = solve_ivp(slope, (0, 25), [1.0, 0.0], rtol=1e-11, atol=1e-13, t_eval=response.time).y.T
    assert response.states[:, :2] == pytest.approx(other, abs=1e-9)
    assert response.at(13.37)[:2] == pytest.approx(
        solve_ivp(slope, (0, 13.37), [1.0, 0.0], rtol=1e-11, atol=1e-13).y[:, -1], abs=1e-9
    )


def test_bad_starts_are_refused():
    with pytest.raises(InputError, match=r"start .*\(3,\)"):
        Response(np.eye(3), np.ones(2), 1.0, 10)
    with pytest.raises(InputError, match="positive end"):
        Response(np.eye(3), np.ones(3), 0.0, 10)


@pytest.mark.parametrize("steps", [7, 20, 100])
@pytest.mark.parametrize("offset", [-5.0, -1.0, 5.0])
def test_the_largest_value_lies_between_samples_where_it_is_negative_too(offset, steps):
    # closed form: offset + cos(t - 0.3) and its negative
    A, start = with_harmonics(np.zeros((1, 1)), np.zeros(1), [1.0], 1.0)
    response = Response(A, np.concatenate([[0.0], start]), 20.0, steps)
    output = np.array([0.0, np.sin(0.3), np.cos(0.3), offset])
    assert response.largest(output).value == pytest.approx(offset + 1, abs=1e-12)
    assert -response.largest(-output).value == pytest.approx(offset - 1, abs=1e-12)


@pytest.mark.parametrize("second", [1e-12, 1e-6, 1.0, 1e9])
def test_crossings_do_not_depend_on_the_unit_of_time(second):
    # closed form: exp(-t) passes a half at ln 2
    response, x = Response(np.array([[-1 / second]]), np.array([1.0]), 3 * second, 7), np.array([1.0])
    for time in (response.last_above(x, 0.5), response.first_crossing(x, 0.5)):
        assert time / second == pytest.approx(np.log(2), abs=1e-9)


@pytest.mark.parametrize("steps", [5, 9, 17, 1000])
def test_a_level_that_is_passed_between_samples_alone_is_seen(steps):
    # closed form: cos t + 2 is above 2.999 within acos(0.999) of every turn, and 2 - cos t falls below 1.001 likewise
    A, start = with_harmonics(np.zeros((1, 1)), np.zeros(1), [1.0], 1.0)
    response = Response(A, np.concatenate([[0.0], start]), 15.0, steps)
    late, near = np.array([0.0, np.sin(1.0), np.cos(1.0), 2.0]), np.arccos(0.999)  # 2 + cos(t - 1)
    assert response.last_above(late, 2.999) == pytest.approx(1 + 4 * np.pi + near, abs=1e-7)
    assert response.first_crossing(late, 2.999) == pytest.approx(1 - near, abs=1e-7)
    assert response.first_crossing(late, 1.001) == pytest.approx(1 + np.pi - near, abs=1e-7)
    assert response.last_above(late, 3.001) == 0.0 and response.first_crossing(late, 3.001) == 15.0
    first = Response(A, np.concatenate([[0.0], start]), 7.5, steps)
    both = Consecutive([(0.0, first), (7.5, Response(A, first.states[-1], 7.5, steps))])
    assert both.last_above(late, 2.999) == pytest.approx(1 + 4 * np.pi + near, abs=1e-7)
    assert both.last_above(late, 3.001) == 0.0
