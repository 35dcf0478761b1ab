"""Many flights at once: each as exact as closed forms and SciPy, peaks and crossings as closed forms give them."""

import numpy as np
import pytest
import scipy

from gainsay.errors import ComputationError, InputError
from gainsay.simulation.batch import polished_crossing, polished_peak, segments
from gainsay.simulation.radau import Radau

RATES = np.array([0.3, 1.0, 2.5])


#: damped oscillations x'' + 0.2 x' + w^2 x = 0; the rate w is each flight's own, and so no part of what is linear
LINEAR, ENTRY = np.array([[0.0, 1.0], [0.0, -0.2]]), np.array([[0.0], [1.0]])


def stiffness(times, states):
    return -(RATES**2)[:, None] * states[..., :1]


def closed_form(t):
    w = np.sqrt(RATES**2 - 0.01)
    return np.exp(-0.1 * t) * (np.cos(w * t) + 0.1 / w * np.sin(w * t))


STARTS = np.tile([1.0, 0.0], (3, 1))


def flights(**changes):
    given = {"rtol": 1e-11, "atol": np.full(2, 1e-12), "length": 7.0, **changes}
    return segments(LINEAR, ENTRY, stiffness, STARTS, 30.0, **given)


def test_every_flight_follows_its_closed_form_in_every_segment():
    last = 0.0
    for segment in flights():
        assert segment.steps[0] == last
        last = segment.steps[-1]
        for time in np.linspace(segment.steps[0], last, 9):
            np.testing.assert_allclose(segment([time])[0][:, 0], closed_form(time), atol=1e-9)
        np.testing.assert_allclose(
            segment.of(np.array([2, 0]), np.array([last, segment.steps[0]]))[:, 0],
            [closed_form(last)[2], closed_form(segment.steps[0])[0]],
            atol=1e-9,
        )
    assert last == 30.0


def test_chosen_flights_are_where_all_flights_are():
    for segment in flights():
        times = np.concatenate([segment.steps, segment.grid(5)])
        chosen = np.arange(len(times)) % 3
        all_flights = segment(times)[np.arange(len(times)), chosen]
        np.testing.assert_allclose(segment.of(chosen, times), all_flights, atol=1e-15)
        assert segment.of(chosen[:0], times[:0]).shape == (0, 2)
        assert segment(times[:0]).shape == (0, 3, 2)
        np.testing.assert_array_equal(segment(times[::-1]), segment(times)[::-1])


def test_outputs_of_chosen_flights_are_those_of_their_states_and_stay_within_bounds():
    C = np.array([[1.0, 0.0], [3.0, -2.0], [0.0, 0.5]])
    for segment in flights():
        times, chosen = segment.grid(9), np.array([2, 0])
        outputs = segment.outputs(C).chosen(chosen)
        np.testing.assert_allclose(outputs(times), segment(times)[:, chosen] @ C.T, atol=1e-14)
        largest = np.abs(outputs(times)).max(axis=0)
        assert (largest <= outputs.bounds()).all()
        # no wider than the longest way that the slopes allow
        way = np.diff(segment.steps)[:, None, None] * np.abs(outputs.slopes).max(axis=1)
        assert (outputs.bounds() <= largest + 1.02 * way.max(axis=0).T).all()


def test_the_bound_of_a_ramp_is_its_end():
    given = {"rtol": 1e-6, "atol": np.ones(1), "length": 2.0}
    (ramp,) = segments(np.zeros((1, 1)), np.eye(1), lambda t, x: np.ones_like(x), np.zeros((1, 1)), 2.0, **given)
    assert len(ramp.steps) == 2 and 2.0 <= ramp.bounds() <= 2.03


def test_a_slope_at_one_point_alone_bounds_the_state():
    # slopes 1 at one point and -1 at all others: the polynomial turns as much as it can
    for stages in (2, 3, 8):
        rule = Radau(stages)
        signs = 2 * np.eye(stages) - 1
        reach = np.abs(rule.integrals(np.linspace(0, 1, 997)) @ signs).max()
        assert 0.3 < reach <= rule.amplification


def test_peaks_and_crossings_lie_where_the_closed_form_has_them():
    tolerances = {"rtol": 1e-12, "atol": np.full(2, 1e-13)}
    (segment,) = segments(LINEAR, ENTRY, stiffness, STARTS, 12.0, **tolerances, length=20.0)
    w = np.sqrt(RATES**2 - 0.01)
    chosen = np.arange(3)
    # x' = 0 at multiples of pi/w: the first minimum is -exp(-0.1 pi/w)
    low, high = 0.8 * np.pi / w, 1.2 * np.pi / w
    peaks = polished_peak(segment, chosen, low, high, lambda x, t: -x[:, 0])
    np.testing.assert_allclose(peaks, np.exp(-0.1 * np.pi / w), rtol=1e-9)
    # the first zero: tan(w t) = -w / 0.1
    zero = (np.pi - np.arctan(w / 0.1)) / w
    found = polished_crossing(segment, chosen, 0.5 * zero, 1.3 * zero, lambda x, t: x[:, 0])
    np.testing.assert_allclose(found, zero, rtol=1e-9)


def test_a_stiff_linear_part_limits_no_step():
    # x' = -1000 (x - sin t) + cos t, solved by sin t + x(0) exp(-1000 t)
    def rest(times, states):
        return np.broadcast_to((1000 * np.sin(times) + np.cos(times))[:, None, None], (*states.shape[:2], 1))

    starts, given = np.array([[1.0], [-2.0]]), {"rtol": 1e-10, "atol": np.full(1, 1e-10), "length": 10.0}
    (segment,) = segments(np.array([[-1000.0]]), np.eye(1), rest, starts, 10.0, **given)
    times = np.concatenate([np.linspace(0.0, 0.01, 50), np.linspace(0.01, 10.0, 200)])
    wanted = np.sin(times)[:, None] + np.exp(-1000 * times)[:, None] * starts[:, 0]
    np.testing.assert_allclose(segment(times)[..., 0], wanted, atol=1e-9)
    assert np.diff(segment.steps).max() > 0.1  # an explicit method would be held below 0.007


def test_pendulums_fly_as_scipy_flies_them():
    # x'' = -sin x; at rtol 1e-12 DOP853 errs by some 1e-11 over two swings
    def rest(times, states):
        return states[..., :1] - np.sin(states[..., :1])

    starts = np.array([[0.1, 0.0], [2.0, 0.5], [-1.0, 1.9]])
    given = {"rtol": 1e-11, "atol": np.full(2, 1e-11), "length": 5.0}
    for segment in segments(np.array([[0.0, 1.0], [-1.0, 0.0]]), ENTRY, rest, starts, 12.0, **given):
        times = np.linspace(segment.steps[0], segment.steps[-1], 40)
        for flight, start in enumerate(starts):
            alone = scipy.integrate.solve_ivp(
                lambda t, x: [x[1], -np.sin(x[0])], (0, 12), start, "DOP853", rtol=1e-12, atol=1e-12, dense_output=True
            )
            np.testing.assert_allclose(segment(times)[:, flight], alone.sol(times).T, atol=2e-9)


@pytest.mark.parametrize("stages", range(2, 10))
def test_the_rule_is_exact_for_its_polynomials(stages):
    # s points integrate polynomials of degree s - 1 exactly up to every point, and of degree 2 s - 2 up to the end
    rule, theta = Radau(stages), np.linspace(0, 1, 7)
    for degree in range(stages):
        exact = theta ** (degree + 1) / (degree + 1)
        np.testing.assert_allclose(rule.integrals(theta) @ rule.nodes**degree, exact, atol=1e-14)
    whole = rule.integrals(np.ones(1))[0]
    for degree in range(2 * stages - 1):
        assert whole @ rule.nodes**degree == pytest.approx(1 / (degree + 1), abs=1e-14)
    # of slopes 3 P_{s-1} the mean of the product with P_{s-1} is 3 over 2 s - 1, and with P_{s-2} it is zero
    top = np.polynomial.legendre.legval(2 * rule.nodes - 1, [*np.zeros(stages - 1), 3.0])
    np.testing.assert_allclose(rule.highest @ top, [0.0, 3 / (2 * stages - 1)], atol=1e-14)


def test_bad_input_and_runaways_are_refused():
    with pytest.raises(InputError, match="flights"):
        next(segments(LINEAR, ENTRY, stiffness, np.zeros((0, 2)), 1.0, rtol=1e-6, atol=np.ones(2), length=1.0))
    with pytest.raises(InputError, match="above 0"):
        next(flights(length=0.0))
    with pytest.raises(ComputationError, match=r"too short at t = (0\.999|1\.000)"):  # the pole of x' = x^2 is at 1
        one, given = np.eye(1), {"rtol": 1e-8, "atol": np.full(1, 1e-8), "length": 5.0}
        list(segments(0 * one, one, lambda t, x: x**2, np.full((2, 1), 1.0), 2.0, **given))
