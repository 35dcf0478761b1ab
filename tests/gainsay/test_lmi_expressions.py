"""Affine expressions and block matrices against plain numpy."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gainsay.errors import InputError
from gainsay.lmi import (
    BlockMatrix,
    Program,
    affine,
    block_diagonal,
    diagonal,
    equal,
    matrix,
    positive,
    scalar,
    sym,
    symmetric,
    trace,
    within,
)


def _values(seed, *variables):
    rng = np.random.default_rng(seed)
    return {v.name: v.matrix(rng.normal(size=v.size)) for v in variables}


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 10**6))
def test_value_is_what_numpy_computes(seed):
    rng = np.random.default_rng(seed)
    a, b = rng.normal(size=(3, 3)), rng.normal(size=(3, 2))
    x, y, s, eps = symmetric("X", 3), matrix("Y", 2, 3), diagonal("S", 3), scalar("eps")
    v = _values(seed, x, y, s, eps)
    expression = sym(a @ x - b @ y) + eps * (b @ b.T) - 2 * s / 4 + (x @ a.T).T @ np.eye(3)
    half = a @ v["X"] - b @ v["Y"]
    expected = half + half.T + v["eps"] * b @ b.T - v["S"] / 2 + a @ v["X"]
    np.testing.assert_allclose(expression.value(v), expected, atol=1e-12)
    np.testing.assert_allclose(expression[0:2, 1].value(v), expected[0:2, 1:2], atol=1e-12)
    np.testing.assert_allclose(trace(expression).value(v), [[np.trace(expected)]], atol=1e-12)


@settings(max_examples=15, deadline=None)
@given(st.integers(0, 10**6), st.sampled_from(["symmetric", "full", "diagonal"]))
def test_coordinates_and_matrix_are_inverse(seed, kind):
    v = {"symmetric": symmetric("V", 4), "full": matrix("V", 4, 3), "diagonal": diagonal("V", 4)}[kind]
    x = np.random.default_rng(seed).normal(size=v.size)
    np.testing.assert_array_equal(v.coordinates(v.matrix(x)), x)


def test_product_of_unknowns_is_refused_where_written():
    x, y = symmetric("X", 2), matrix("Y", 2, 2)
    with pytest.raises(InputError, match="not affine 'Y, X': expected a change of variables"):
        y @ x
    with pytest.raises(InputError, match="not affine"):
        positive("eps") * x


@pytest.mark.parametrize(
    "wrong",
    [
        lambda: symmetric("X", 2) + np.eye(3),
        lambda: symmetric("X", 2) @ np.eye(3),
        lambda: symmetric("X", 2) * np.eye(2),
        lambda: affine(np.ones(3)),
        lambda: trace(matrix("Y", 2, 3)),
        lambda: matrix("Y", 2, 2) < 0,
        lambda: matrix("Y", 2, 3) < 0,
        lambda: symmetric("X", 2).value({}),
        lambda: symmetric("X", 2).value({"X": np.eye(3)}),
        lambda: Program(subject_to=[symmetric("X", 2) > 0, symmetric("X", 2) < 1 * np.eye(2)]).variables,
        lambda: Program(minimise=symmetric("X", 2)),
        lambda: Program(subject_to=[3]),
    ],
)
def test_wrong_statements_raise_typed_errors(wrong):
    with pytest.raises(InputError):
        wrong()


def _block(x, y):
    f = BlockMatrix("(9)", "state", "input", "weight", weight=1)
    f["state", "state"] = -x
    f["input", "state"] = y
    f["input", "input"] = -4 * np.eye(1)
    f["weight", "weight"] = -np.eye(1)
    return f


def test_block_matrix_completes_by_symmetry_and_cuts_by_name():
    x, y = symmetric("X", 2), matrix("Y", 1, 2)
    f, v = _block(x, y), {"X": np.array([[2.0, 1.0], [1.0, 3.0]]), "Y": np.array([[5.0, 6.0]])}
    # written out by hand
    expected = np.array([[-2, -1, 5, 0], [-1, -3, 6, 0], [5, 6, -4, 0], [0, 0, 0, -1.0]])
    np.testing.assert_array_equal(f.value(v), expected)
    np.testing.assert_array_equal((-f).value(v), -expected)
    np.testing.assert_array_equal(f["state", "input"].value(v), [[5], [6]])
    np.testing.assert_array_equal(f.sub("input", "state").value(v), expected[np.ix_([2, 0, 1], [2, 0, 1])])
    assert f.sizes == (("state", 2), ("input", 1), ("weight", 1))


def test_block_matrices_are_compared_block_by_block():
    x, y = symmetric("X", 2), matrix("Y", 1, 2)
    f, g = _block(x, y), _block(x, y)
    assert f.differences(g) == ()
    g["input", "input"] = -8 * np.eye(1)
    g["state", "weight"] = y.T
    assert f.differences(g) == (("state", "weight", 1.0), ("input", "input", 4.0))


def test_block_matrix_names_the_block_at_fault():
    f = BlockMatrix("(9)", "state", "input")
    f["state", "state"] = np.eye(2)
    with pytest.raises(InputError, match=r"block state,input \(9\).*expected state=2"):
        f["state", "input"] = np.ones((3, 1))
    with pytest.raises(InputError, match=r"'weight'.*state \| input"):
        f["weight", "state"] = np.eye(2)
    with pytest.raises(InputError, match="size of a block row"):
        f < 0  # noqa: B015 (the comparison itself raises)


def test_constraints_read_both_ways():
    x = symmetric("X", 2)
    v = {"X": np.diag([1.0, 2.0])}
    eye = np.eye(2)
    for constraint, expected in [
        (x > 0, v["X"]),
        (x < 3 * eye, 3 * eye - v["X"]),
        (3 * eye > x, 3 * eye - v["X"]),
        (-x <= 0, v["X"]),
    ]:
        np.testing.assert_array_equal(constraint.expression.value(v), expected)
    assert (x > 0).strict and not (x >= 0).strict
    check = Program(subject_to=[within(x, np.zeros((2, 2)), 3 * np.ones((2, 2)), "box"), equal(trace(x), 3, "tr")])
    assert check.check(v).holds
    assert not check.check({"X": np.diag([1.0, 2.1])}).holds
    assert not check.check({"X": np.diag([4.0, -1.0])}).holds


def test_block_diagonal():
    x = symmetric("X", 2)
    value = block_diagonal(x, [[7.0]]).value({"X": np.eye(2)})
    np.testing.assert_array_equal(value, np.diag([1.0, 1.0, 7.0]))
