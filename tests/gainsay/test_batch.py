"""Many flights at once: each as exact as one alone, peaks and crossings as closed forms give them."""

import numpy as np
import pytest

from gainsay.errors import ComputationError, InputError
from gainsay.simulation.batch import polished_crossing, polished_peak, segments

RATES = np.array([0.3, 1.0, 2.5])


def decay(t, states):
    """Damped oscillations x'' + 0.2 x' + w^2 x = 0, one rate a flight."""
    x, v = states.T
    return np.stack([v, -(RATES**2) * x - 0.2 * v], axis=1)


def closed_form(t):
    w = np.sqrt(RATES**2 - 0.01)
    return np.exp(-0.1 * t) * (np.cos(w * t) + 0.1 / w * np.sin(w * t))


STARTS = np.tile([1.0, 0.0], (3, 1))


def flights(**changes):
    given = {"rtol": 1e-11, "atol": np.full(2, 1e-12), "length": 7.0, **changes}
    return segments(decay, STARTS, 30.0, **given)


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
        np.testing.assert_array_equal(segment.of(chosen, times), segment(times)[np.arange(len(times)), chosen])
        assert segment.of(chosen[:0], times[:0]).shape == (0, 2)


def test_peaks_and_crossings_lie_where_the_closed_form_has_them():
    (segment,) = segments(decay, STARTS[1:2].repeat(3, axis=0), 12.0, rtol=1e-12, atol=np.full(2, 1e-13), length=20.0)
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


def test_bad_input_and_runaways_are_refused():
    with pytest.raises(InputError, match="flights"):
        next(segments(decay, np.zeros((0, 2)), 1.0, rtol=1e-6, atol=np.ones(2), length=1.0))
    with pytest.raises(InputError, match="above 0"):
        next(flights(length=0.0))
    with pytest.raises(ComputationError, match="flights"), np.errstate(all="ignore"):
        list(segments(lambda t, x: x**2, np.full((2, 1), 1.0), 2.0, rtol=1e-8, atol=np.ones(1), length=5.0))
