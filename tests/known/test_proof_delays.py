"""Proofs of loops with constant delays, and the margin of several: closed forms, others' numbers, another method.

A loop x' = a x + b x(t - d) + c x(t - e) is stable whatever the delays are where |b| + |c| < -a: on the axis
|j w - a| >= -a.
"""

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.special import lambertw

from gainsay.errors import ComputationError, InputError
from gainsay.systems.delay import DelaySystem
from gainsay.systems.delay_spectrum import unstable_root_count
from gainsay.systems.scaled_margin import scaled_delay_margin
from tests.gainsay.proof_examples import make, proved, refused

STABLE, UNSTABLE = ("stable", "holds", None), ("stable", "fails", None)


def fields(a, late, delays, **more):
    return {"A": str(a), "delayed": [str(x) for x in late], "delays": [*map(str, delays)], **more}


def text(matrix):
    return f"[{', '.join('[' + ', '.join(repr(float(x)) for x in row) + ']' for row in matrix)}]"


def signals(a, late):
    """x' = a x + sum_k late_k x(t - d_k), a number."""
    return DelaySystem([[a]], [late], [[1]] * len(late))


@pytest.mark.parametrize(
    ("late", "delays", "critical"),
    [
        # s = j w, one delay: w d = pi/2 and w = b
        ([-1], [1], math.pi / 2),
        ([-2.5], [1], math.pi / 5),
        # d and 2 d with equal weights: cos + cos 2 = 0 at pi/3, w = sin + sin 2 = sqrt 3 (times the weight)
        ([-1, -1], [1, 2], math.pi / 3 / math.sqrt(3)),
        ([-0.25, -0.25], [1, 2], 4 * math.pi / 3 / math.sqrt(3)),
        # d and 3 d: cos + cos 3 = 0 at pi/4, w = sin + sin 3 = sqrt 2
        ([-1, -1], [1, 3], math.pi / 4 / math.sqrt(2)),
        # d, 2 d, 3 d: cos 1 + cos 2 + cos 3 = cos 2 (1 + 2 cos 1), zero at pi/4: w = 1 + sqrt 2
        ([-1, -1, -1], [1, 2, 3], math.pi / 4 / (1 + math.sqrt(2))),
    ],
)
def test_margins_of_a_number_in_closed_form(late, delays, critical):
    found = scaled_delay_margin(signals(0, late), delays, 20)
    assert found.lower < critical < found.upper < found.lower * (1 + 2e-6)
    below, above = f"{0.9999 * critical:.12g}", f"{1.0001 * critical:.12g}"
    assert ("scale", "at_least", below) in proved(make("delays", fields(0, late, delays, scale=below)))
    assert "not excluded" in refused("delays", fields(0, late, delays, scale=above))
    for factor, expected in ((0.9999, STABLE), (1.0001, UNSTABLE)):
        scaled = [Fraction(d * factor * critical) for d in delays]
        assert proved(make("delays", fields(0, late, scaled))) == {expected}


def test_a_chain_of_delays_is_that_of_its_loop():
    """x1' = x2(t - d1), x2' = -2 x2 - x1(t - d2): s (s + 2) + exp(-s (d1 + d2)) = 0; only the sum counts.

    w^4 + 4 w^2 = 1, so w^2 = sqrt 5 - 2, and w (d1 + d2) = pi/2 - arctan(w/2).
    """
    frequency = math.sqrt(math.sqrt(5) - 2)
    critical = (math.pi / 2 - math.atan(frequency / 2)) / frequency
    loop = DelaySystem([[0, 0], [0, -2]], [[1, 0], [0, -1]], [[0, 1], [1, 0]])
    for share in (0.5, 0.1, 1 / math.pi):
        found = scaled_delay_margin(loop, [share, 1 - share], 10)
        assert found.lower <= critical * (1 + 1e-12) and critical * (1 - 1e-12) <= found.upper
        assert found.frequency == pytest.approx(frequency, rel=1e-6)


@pytest.mark.parametrize("delay", [0.7, 2.9])
@pytest.mark.parametrize(("position", "rate"), [(0.3, 0.2), (0.6, 0.0), (0.9, 0.4)])
def test_the_margin_along_one_delay_is_that_of_the_quasi_polynomial(delay, position, rate):
    loop = DelaySystem([[0, 1], [-1, -0.5]], [[0], [1]], [[-position, -rate]])
    exact = loop.quasi_polynomial.margin()  # Walton and Marshall's crossings, isolated
    found = scaled_delay_margin(loop, delay, 12)
    if exact.delay > 12 * delay:
        assert (found.lower, found.upper) == (12, math.inf)
    else:
        assert found.lower * delay < exact.delay < found.upper * delay


# DDEBifurcationKit.jl, documentation, tutorial "(Another) Neuron model": Hopf points of the equilibrium 0 along a, each
# within a bracket, of x1' = -x1 - 2 a x1(t - 12.7) + 18/29 x2(t - 20.2), x2' likewise.
HOPF = [(0.29853073, 0.29890362), (0.34523499, 0.34537483), (0.36662946, 0.36830746)]


@pytest.mark.parametrize(("low", "high"), HOPF)
def test_two_neurons_are_stable_up_to_their_first_hopf_point(low, high):
    def neurons(a):
        cross = "[[0, 18/29], [18/29, 0]]"
        return fields("-1*eye(2)", [f"-2*{a}*eye(2)", cross], ["12.7", "20.2"])

    first = (low, high) == HOPF[0]
    assert proved(make("delays", neurons(low))) == {STABLE if first else UNSTABLE}
    assert proved(make("delays", neurons(high))) == {UNSTABLE}


def test_stable_whatever_the_delays_are():
    """|b| + |c| < 2 = -a; with b = -1.5, d up to 4 and e = 0 the loop is -1.1 x - 1.5 x(t - d), unstable for some d."""
    ranges = {"A": "-2", "delayed": ["-1", "0.9"], "delays": [["0", "1.5"], ["0", "1.5"]]}
    assert proved(make("delays", ranges)) == {STABLE}
    assert "not excluded" in refused("delays", {**ranges, "delayed": ["-1.5", "0.9"], "delays": [["0", "4"], "0"]})
    found = scaled_delay_margin(signals(-2, [-1, 0.9]), [1, math.sqrt(2)], 20)
    assert (found.lower, found.upper) == (20, math.inf)


@given(st.floats(-2, 1), st.floats(-3, 1), st.floats(0.01, 3), st.floats(-2, 1), st.floats(-3, 1), st.floats(0.01, 3))
@settings(max_examples=12, deadline=None)
def test_mixed_loops_are_what_lambert_says_of_each(a, b, d, p, q, e):
    """Two loops of one delay each in mixed states: s = a + b exp(-s d) by Lambert's W, principal branch rightmost."""
    right = [(lambertw(y * t * np.exp(-x * t), 0) / t + x).real for x, y, t in ((a, b, d), (p, q, e))]
    if min(map(abs, right)) < 1e-3:
        return
    mix, back = np.array([[1.0, 2.0], [1.0, 3.0]]), np.array([[3.0, -2.0], [-1.0, 1.0]])
    whole, first, second = (mix @ np.diag(x) @ back for x in ([a, p], [b, 0], [0, q]))
    found = proved(make("delays", fields(text(whole), [text(first), text(second)], [Fraction(d), Fraction(e)])))
    assert found == {STABLE if max(right) < 0 else UNSTABLE}


@pytest.mark.parametrize("seed", range(6))
def test_random_loops_have_the_roots_that_double_precision_counts(seed):
    rng = np.random.default_rng(seed)
    n = 2 + seed % 3
    undelayed = (rng.normal(size=(n, n)) - 1.5 * np.eye(n)).round(3)
    late, delays = rng.normal(scale=0.5, size=(2, n, n)).round(3), rng.uniform(0.1, 3, 2).round(3)
    loop = DelaySystem(undelayed, np.hstack(late), np.vstack([np.eye(n)] * 2))
    count = unstable_root_count(loop, np.repeat(delays, n))
    assert proved(make("delays", fields(text(undelayed), map(text, late), delays))) == {UNSTABLE if count else STABLE}


@pytest.mark.parametrize(("gamma", "accepted"), [("1.001", True), ("0.999", False)])
def test_the_norm_of_a_positive_loop_is_its_gain_at_zero(gamma, accepted):
    # 1 / (2 - 0.5 - 0.5); with a second output that is the input: sqrt(1 + 1)
    given = fields(-2, [0.5, 0.5], [1, 2.5], B="1", C="1", gamma=gamma)
    both = {**given, "C": "col(1, 0)", "D": "col(0, 1)", "gamma": f"sqrt({gamma}**2 + 1)"}
    both["gamma"] = str(round(math.hypot(float(gamma), 1), 6))
    for parts in (given, both, {**given, "delays": [["1", "1.5"], "2.5"]}):
        if accepted:
            assert proved(make("delays", parts)) == {STABLE, ("norm", "less_than", parts["gamma"])}
        else:
            assert "c:" in refused("delays", parts)


def test_a_loop_without_a_norm_and_a_norm_at_infinity():
    """x' = -x - 3 x(t - 1.5) is unstable (w^2 = 8, w d = pi - arctan w at d = 0.68); D bounds a norm from below."""
    assert "it has no norm" in refused("delays", fields(-1, [-3], [1.5], B="1", C="1", gamma="100"))
    far = fields(-2, [0.5], [1], B="1", C="0.001", D="3", gamma="3")
    assert "at infinity" in refused("delays", far)
    make("delays", {**far, "gamma": "3.01"})


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"delays": ["-1"]}, "not negative"),
        ({"delays": [["2", "1"]]}, "least of a range first"),
        ({"delays": ["1", "2"]}, "a delay for each matrix"),
        ({"delays": "1"}, "a delay for each matrix"),
        ({"delays": [["1"]]}, "pairs"),
        ({"delays": [["0", "1", "2"]]}, "pairs"),
        ({"delays": [1]}, "pairs"),
        ({"delays": ["sqrt(2)"]}, "rational"),
        ({"delayed": []}, "list of formulas"),
        ({"delayed": ["eye(2)"]}, "square and of one size"),
        ({"A": "row(1, 2)"}, "square and of one size"),
        ({"scale": "-1"}, "negative"),
        ({"gamma": "1"}, "given without"),
        ({"gamma": "-1", "B": "1", "C": "1"}, "positive"),
        ({"gamma": "1", "B": "col(1, 1)", "C": "1"}, "do not fit"),
        ({"gamma": "1", "B": "1", "C": "1", "D": "row(1, 1)"}, "do not fit"),
        ({"A": "0", "delayed": ["0"]}, "not excluded"),  # a root at zero
        ({"A": "1", "delayed": ["-1"]}, "not excluded"),
        ({"A": "interval(-1, 1)"}, ""),
    ],
)
def test_what_is_no_such_loop_or_cannot_be_settled_is_refused(change, message):
    assert message in refused("delays", {**fields(-1, [-2], [1]), **change})


def test_every_datum_of_a_ball_is_meant():
    """x' = a x - x(t - 1) with a from -0.5 to -0.1 is stable; up to 1.1 it has a root at zero for a = 1."""
    assert proved(make("delays", fields("interval(-0.5, -0.1)", [-1], [1]))) == {STABLE}
    assert "not excluded" in refused("delays", fields("interval(-0.5, 1.1)", [-1], [1]))


def test_a_margin_that_is_none():
    loop = signals(1, [-0.5])  # unstable without delay
    assert scaled_delay_margin(loop, 1, 5).upper == 0
    for delay, largest in ((0, 1), (-1, 1), (1, 0), (1, math.nan), (1, math.inf)):
        with pytest.raises(InputError):
            scaled_delay_margin(loop, delay, largest)
    with pytest.raises(ComputationError, match="too large"):
        scaled_delay_margin(signals(0, [-1]), 1, 1e9)
