"""Peaks of loops with a varying delay: closed forms, and what must be refused."""

import math
from fractions import Fraction

import numpy as np
import pytest
from flint import fmpq, fmpq_mat
from scipy.integrate import quad
from scipy.linalg import expm

from gainsay.exact.ball import lower, precision, upper
from gainsay.proof.kinds.delay_peak import Responses, kernel
from tests.gainsay.proof_examples import make, proved, refused

CELLS = {"step": "0.02", "cells": "600"}
#: x' = -x + w from x(0) = 1, nothing delayed
LAG = {
    **CELLS, "A": "-1", "Bd": "0", "Cd": "0", "delay": "1", "x0": "1", "rate": "0.5", "lag": "0.1", "B": "1", "w": "1/4"
}  # fmt: skip
#: x' = -x(t - d)
PURE = {"A": "0", "Bd": "-1", "Cd": "1", "x0": "1", "rate": "0", **CELLS}


def seen(bound: str, since: str = "0", row: str = "1") -> dict:
    return {"outputs": [{"of": "y", "row": row, "from": since, "bound": bound}]}


def test_a_lag_under_a_bounded_disturbance():
    # exp(-1) of the start is left after 1 s, and the peak gain of 1/(s + 1) is 1
    assert proved(make("delay_peak", {**LAG, **seen("0.62", "1")})) == {("y", "inside", "-0.62..0.62")}
    assert "at most 0.617" in refused("delay_peak", {**LAG, **seen("0.6178", "1")})  # 0.61788 and more
    refused("delay_peak", {**LAG, **seen("0.62", "0.9")})


@pytest.mark.parametrize("damping", ["0.1", "0.5"])
def test_the_peak_gain_of_an_oscillator(damping):
    # of 1/(s^2 + 2 z s + 1): coth(pi z / (2 sqrt(1 - z^2)))
    z = float(damping)
    gain = 1 / math.tanh(math.pi * z / (2 * math.sqrt(1 - z * z)))
    loop = {
        **LAG, "A": f"[[0, 1], [-1, -2*{damping}]]", "Bd": "zeros(2, 1)", "Cd": "zeros(1, 2)", "B": "col(0, 1)",
        "x0": "zeros(2, 1)", "w": "1", "rate": "0", "step": "0.05", "cells": "1500",
    }  # fmt: skip
    make("delay_peak", {**loop, **seen(f"{gain * 1.001:.6f}", row="row(1, 0)")})
    refused("delay_peak", {**loop, **seen(f"{gain * 0.999:.6f}", row="row(1, 0)")})


def test_a_pure_delay_is_proved_below_the_bound_at_which_it_is_lost():
    # x' = -x(t - d(t)) with 0 <= d <= D is stable for every such d exactly if D < 3/2 (Myshkis 1951)
    make("delay_peak", {**PURE, "delay": "0.5", "lag": "0.3", **seen("3")})
    for delay in ("1.5", "1.6", "3"):
        for lag in ("0.1", "0.3", "1"):
            assert "not proved" in refused("delay_peak", {**PURE, "delay": delay, "lag": lag, **seen("1000000")})


def test_the_same_is_proved_of_every_loop_and_start():
    both = {**LAG, "A": ["-1", "-2"], "Bd": ["0", "0"], "Cd": ["0", "0"], "x0": "row(1, -1/2)", **seen("0.62", "1")}
    make("delay_peak", both)
    refused("delay_peak", {**both, "A": ["-1", "-0.9"]})  # exp(-0.9) + 0.25/0.9
    refused("delay_peak", {**both, "x0": "row(1/2, -3/2)"})
    assert "equal length" in refused("delay_peak", {**both, "Bd": ["0"]})


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"A": "1"}, "Hurwitz"),
        ({"rate": "1.1"}, "Hurwitz"),
        ({"lag": "1"}, "multiple"),  # the pole of the lag at -1 too
        ({"A": "-sqrt(2)"}, "exact"),
        ({"A": "-eye(2)"}, "shape"),
        ({"B": "col(1, 1)"}, "shape"),
        ({"x0": "col(1, 1)"}, "shape"),
        ({"delay": "-1"}, "expected delay"),
        ({"lag": "0"}, "expected delay"),
        ({"lag": "3", "rate": "0.5"}, "expected delay"),
        ({"w": "-0.25"}, "not negative"),
        ({"cells": "1000000"}, "integer"),
        ({"cells": "10.5"}, "integer"),
        ({"step": "0"}, "expected delay"),
        ({"step": "0.0001"}, "within the cells"),
        ({"outputs": []}, "a list of of"),
        ({"outputs": [{"of": "y"}]}, "a list of of"),
        ({"outputs": [{"of": 1, "row": "1", "from": "0", "bound": "9"}]}, "a list of of"),
    ],
)
def test_what_does_not_fit_is_refused(changed, said):
    assert said in refused("delay_peak", {**LAG, **seen("0.62", "1"), **changed})


def test_two_outputs_have_two_names():
    # of x a bound of 0.4 is false, of x/2 it is true: under one name a conclusion would not say which is meant
    half = {"of": "half", "row": "1/2", "from": "1", "bound": "0.4"}
    outputs = [*seen("0.62", "1")["outputs"], half]
    assert ("half", "inside", "-0.4..0.4") in proved(make("delay_peak", {**LAG, "outputs": outputs}))
    assert "different name" in refused("delay_peak", {**LAG, "outputs": [outputs[0], {**half, "of": "y"}]})


def test_a_disturbance_comes_with_its_size():
    assert "without" in refused("delay_peak", {k: v for k, v in {**LAG, **seen("0.62", "1")}.items() if k != "w"})


@pytest.mark.parametrize(("delay", "lag", "rate"), [("0.03", "0.0188", "0.03"), ("1", "0.4", "0"), ("0.1", "2", "0.3")])
def test_the_kernel_is_largest_at_an_end(delay, lag, rate):
    """Against quadrature (SciPy) at delays in between."""
    D, T, r = map(float, (delay, lag, rate))

    def weighted(d: float) -> float:
        until = quad(lambda s: (1 - math.exp(-s / T)) * math.exp(r * s), 0, d)[0]
        return until + math.exp(-(1 / T - r) * d) / (1 / T - r)

    with precision(128):
        found = float(upper(kernel(*map(Fraction, (delay, lag, rate)))))
    values = [weighted(d) for d in np.linspace(0, D, 101)]
    assert max(values) == pytest.approx(found, rel=1e-9)
    assert max(values) <= found * (1 + 1e-12)


def test_sizes_of_responses_are_bounds_and_close():
    """Against the response of a matrix with a pole of each sort, summed on a fine grid (SciPy's exponential)."""
    F = np.array([[-0.2, 3.0, 0, 0], [-3.0, -0.2, 1, 0], [0, 0, -5.0, 1], [0, 0, 0, -0.5]])
    row, column, rate, since = np.array([[1.0, 0.5, 0, 2]]), np.array([[0.0], [1], [1], [-1]]), 0.1, 2.0
    exact = fmpq_mat([[_ratio(x) for x in line] for line in F])
    with precision(128):
        poles = tuple(p for p, _ in exact.charpoly().complex_roots() if not p.imag < 0)
        responses = Responses(exact, poles, Fraction(1, 10), Fraction(1, 50), 4000)
        size = responses.size(*(fmpq_mat([[_ratio(x) for x in line] for line in part]) for part in (row, column)))
        found = [float(upper(x)) for x in (size.integral, size.peak(), size.peak(100))]
        assert lower(size.integral) > 0
    step, count = 0.002, 40_000
    values, x, hold = [], column, expm(step * F)
    for _ in range(count):
        values.append((row @ x).item())
        x = hold @ x
    weighted = np.abs(values) * np.exp(rate * step * np.arange(count))
    wanted = [weighted.sum() * step, weighted.max(), weighted[int(since / step) :].max()]
    for bound, value in zip(found, wanted, strict=True):
        assert value * (1 - 1e-4) <= bound <= value * 1.01


def _ratio(value: float):
    exact = Fraction(str(value))
    return fmpq(exact.numerator, exact.denominator)
