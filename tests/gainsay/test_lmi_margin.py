"""The largest common margin of a program: a point as far inside as can be, or multipliers with room."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gainsay.lmi import Infeasible, Program, Solved, Undecided, by_margin, equal, scalar, sym, symmetric
from gainsay.lmi.common_margin import MARGIN, raised

x, y = scalar("x"), scalar("y")


def between(low, high):
    return Program(None, [(x - low > 0).named("low"), (high - x > 0).named("high")])


@given(st.integers(-20, 20), st.integers(1, 12))
@settings(max_examples=15, deadline=None)
def test_the_point_lies_in_the_middle(start, eighths):
    # closed form: min(x - low, high - x) is largest at the mean of the ends, while half the width is below the cap 1;
    # the solver is asked for a margin of 1e-6 and moves the point by as much
    low, high = start / 8, (start + eighths) / 8
    found = by_margin(between(low, high))
    assert isinstance(found, Solved)
    assert found["x"] == pytest.approx((low + high) / 2, abs=1e-5)


def test_a_margin_of_one_is_enough():
    # x > 0 alone has margins without end: the cap ends them, and the margin is not an unknown of the point
    found = by_margin(Program(None, [x > 0]))
    assert isinstance(found, Solved)
    assert found["x"] >= 1 - 1e-5
    assert set(found.values) == {"x"}


@given(st.integers(-20, 20), st.integers(1, 16))
@settings(max_examples=15, deadline=None)
def test_multipliers_of_an_empty_interval_weigh_both_ends_alike(start, eighths):
    # x - low > 0 and high - x > 0 with high < low: x cancels under equal weights alone, whose sum is high - low < 0
    low, high = start / 8, (start - eighths) / 8
    found = by_margin(between(low, high))
    assert isinstance(found, Infeasible)
    weights = {label: float(np.squeeze(z)) for label, z in found.farkas.multipliers.items()}
    assert weights["low"] == pytest.approx(weights["high"], rel=1e-9)
    assert weights["low"] > 0
    assert found.farkas.value < 0
    assert MARGIN not in weights


@pytest.mark.parametrize(("A", "stable"), [([[0, 1], [-2, -3]], True), ([[0, 1], [-2, 3]], False)])
def test_lyapunovs_inequality_is_decided_by_the_spectrum(A, stable):
    # Lyapunov 1892: poles -1, -2, and 1, 2
    A, P = np.array(A, dtype=float), symmetric("P", 2)
    found = by_margin(Program(None, [(sym(P @ A) < 0).named("decay"), (P - np.eye(2) > 0).named("P > I")]))
    if stable:
        assert isinstance(found, Solved)
        value = found["P"]
        assert np.linalg.eigvalsh(value).min() > 1e-3
        assert np.linalg.eigvalsh(A.T @ value + value @ A).max() < -1e-3
    else:
        assert isinstance(found, Infeasible)
        Z, S = (found.farkas.multipliers[label] for label in ("decay", "P > I"))
        # both with room inside their cones, and P cancels: A Z + Z A' = S (the weighted sum is linear in P alone)
        assert min(np.linalg.eigvalsh(Z).min(), np.linalg.eigvalsh(S).min()) > 0
        assert A @ Z + Z @ A.T == pytest.approx(S, abs=1e-7 * np.abs(S).max())


def test_an_equation_is_no_inequality_with_a_margin():
    # on x + y = 1 the margins of x > 0 and y > 0 are largest at a half each
    found = by_margin(Program(None, [x > 0, y > 0, equal(x + y, 1, "sum")]))
    assert isinstance(found, Solved)
    assert (found["x"], found["y"]) == pytest.approx((0.5, 0.5), abs=1e-5)


def test_an_edge_decides_nothing():
    # x > 0 and x < 0: the largest margin is zero, and no point and no multipliers with room are there
    assert isinstance(by_margin(between(0.0, 0.0)), Undecided | Infeasible)
    # P = 0 has margin 0 in Lyapunov's inequality and P > 0, the plant unstable: no multipliers with room either
    P = symmetric("P", 1)
    assert isinstance(by_margin(Program(None, [(2 * P < 0).named("decay"), (P > 0).named("P > 0")])), Undecided)
    # 0 <= x <= 0 has the point 0, which is not to be refuted; it lies on the edge
    held = Program(None, [(x >= 0).named("low"), (-x >= 0).named("high")])
    assert not isinstance(by_margin(held), Infeasible)


def test_the_raised_program_has_a_point_wherever_the_equations_have_one():
    program = raised(between(1.0, 0.0))
    point = {"x": 0.5, MARGIN: -2.0}
    assert min(np.linalg.eigvalsh(np.atleast_2d(c.expression.value(point))).min() for c in program.constraints) > 0
