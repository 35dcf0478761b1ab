from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gainsay.errors import CertificateError
from gainsay.exact.ball import lower, upper
from gainsay.exact.matrix import Matrix
from gainsay.proof.formulas import constraint, evaluate
from gainsay.proof.scope import MappingTables, Reader

TABLES = MappingTables(
    numbers={"mass": "200", "rate": "1.13e-3"},
    printed={"L": [["1.2491", "0.0127"], ["-0.025", "1.2886"]]},
    designs={("repaired", "K"): np.array([[0.1, 2.0]])},
)


def value(text, **names):
    return evaluate(text, names, Reader(TABLES, "test"))


def number(text, **names):
    return value(text, **names).value()


def rows(matrix):
    return [[Fraction(int(x.p), int(x.q)) for x in row] for row in matrix.rows()]


def test_literals_are_exact():
    assert number("0.1 + 0.2") == Fraction(3, 10)  # in floats it is not
    assert number("1e-3 * 2.5E2") == Fraction(1, 4)
    assert number("1 / 3") == Fraction(1, 3)


def test_tables_are_read_exactly_and_recorded():
    reader = Reader(TABLES, "test")
    found = evaluate("number('rate')**2 * printed('L')[0, 1] / number('mass')", {}, reader)
    assert found.value() == Fraction("1.13e-3") ** 2 * Fraction("0.0127") / 200
    assert reader.data == {
        "number": {"mass": "200", "rate": "0.00113"},
        "printed": {"L": [["1.2491", "0.0127"], ["-0.025", "1.2886"]]},
    }


def test_a_box_holds_every_matrix_that_rounds_to_the_digits():
    box = value("box('L')").entry(1, 0)
    # half a unit of the last digit of -0.025 is 0.0005
    assert lower(box) <= Fraction("-0.0255")
    assert upper(box) >= Fraction("-0.0245")
    assert upper(box) - lower(box) < Fraction("0.0010001")


def test_designs_are_the_binary_numbers_as_they_are():
    assert rows(value("design('repaired', 'K')")) == [[Fraction(0.1), Fraction(2)]]


def test_blocks_fill_zeros_and_mirror_stars():
    found = value("[[eye(2), col(3, 4)], [..., 0]]")
    assert rows(found) == [[1, 0, 3], [0, 1, 4], [3, 4, 0]]
    assert rows(value("[[1, 2], [-2.5, 0]]")) == [[1, 2], [Fraction(-5, 2), 0]]
    assert rows(value("diag(2, eye(2))")) == [[2, 0, 0], [0, 1, 0], [0, 0, 1]]


def test_slices_and_selections_count_from_zero():
    m = "[[1,2,3],[4,5,6],[7,8,9]]"
    assert rows(value(f"({m})[1, 2]")) == [[6]]
    assert rows(value(f"({m})[0:2, 1:]")) == [[2, 3], [5, 6]]
    assert rows(value(f"take({m}, [2, 0], [1])")) == [[8], [2]]
    assert rows(value("col(7, 8, 9)[1]")) == [[8]]
    assert rows(value("unit(3, 2)")) == [[0], [0], [1]]


def test_functions_against_their_definitions():
    assert rows(value("sym([[1, 2], [0, 3]])")) == [[2, 2], [2, 6]]
    assert number("trace([[1, 2], [0, 3]])") == 4
    assert rows(value("inverse([[2, 0], [0, 4]])")) == [[Fraction(1, 2), 0], [0, Fraction(1, 4)]]
    assert rows(value("kron([[1, 2]], eye(2))")) == [[1, 0, 2, 0], [0, 1, 0, 2]]
    assert rows(value("[[0, 1], [1, 1]]**5")) == [[3, 5], [5, 8]]  # Fibonacci numbers
    assert number("sqrt(0.25)") == Fraction(1, 2)


def test_roots_and_functions_are_enclosed():
    for text, exact_low, exact_high in (
        ("sqrt(2)", "1.41421356237309504880", "1.41421356237309504881"),  # OEIS A002193
        ("pi", "3.14159265358979323846", "3.14159265358979323847"),  # OEIS A000796
        ("exp(1)", "2.71828182845904523536", "2.71828182845904523537"),  # OEIS A001113
        ("cos(0) + sin(0) + log(1)", "1", "1"),
    ):
        found = evaluate(f"({text}) + 0*pi", {}, Reader(TABLES, "test")).entry(0, 0)
        assert lower(found) <= Fraction(exact_high), text
        assert upper(found) >= Fraction(exact_low), text


entries = st.integers(-9, 9)
matrices = st.lists(st.lists(entries, min_size=3, max_size=3), min_size=3, max_size=3)


@given(matrices, matrices)
def test_evaluation_agrees_with_numpy(a, b):
    names = {"A": Matrix.of(a), "B": Matrix.of(b)}
    x, y = np.array(a), np.array(b)
    found = value("2*A@B - B.T/4 + A**2", **names)
    assert np.array_equal(np.array(rows(found), dtype=float), 2 * x @ y - y.T / 4 + x @ x)


def test_constraints():
    form, relation = constraint("A < 2*eye(2)", {"A": Matrix.of([[1, 0], [0, 1]])}, Reader(TABLES, "test"))
    assert (rows(form), relation) == ([[-1, 0], [0, -1]], "<")


@pytest.mark.parametrize(
    "text",
    [
        "__import__('os')",
        "(1).__class__",
        "A.real",
        "open('x')",
        "lambda: 1",
        "[x for x in A]",
        "A if A else A",
        "'text'",
        "True",
        "1j",
        "f'{A}'",
        "A @ B",
        "A * A",
        "A + 1",
        "1 / 0",
        "1 / A",
        "A[5, 0]",
        "A[-1, 0]",
        "A[::2, 0]",
        "A ** -1",
        "2 ** 1000",
        "eye(10**9)",
        "eye(100000)",
        "zeros(2)",
        "unknown",
        "number(mass)",
        "number('nothing')",
        "printed('nothing')",
        "[1, 2]",
        "[[1, 2], [3]]",
        "[[..., 1], [2, 3]]",
        "inverse([[1, 1], [1, 1]])",
        "sqrt(-1)",
        "1 < 2",
        "1,",
        "",
        ")(",
        "sym(A=1)",
        "interval(2, 1)",
        "(" * 500 + "1" + ")" * 500,
        "1e99999",
    ],
)
def test_what_is_no_formula_is_refused_in_one_line(text):
    names = {"A": Matrix.of([[1, 2], [3, 4]]), "B": Matrix.of([[1, 2, 3]])}
    with pytest.raises(CertificateError) as caught:
        value(text, **names)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("text", ["A", "1 < 2 < 3", "1 != 2", "A < B", "not A", "A in A"])
def test_what_is_no_constraint_is_refused(text):
    names = {"A": Matrix.of([[1, 2], [3, 4]]), "B": Matrix.of([[1, 2, 3]])}
    with pytest.raises(CertificateError):
        constraint(text, names, Reader(TABLES, "test"))


def test_plausible_values_are_a_ball_over_the_range_of_the_table_and_recorded():
    tables = MappingTables(ranges={"rate0": ("0.05", "0.2")})
    reader = Reader(tables, "test")
    found = evaluate("2*plausible('rate0')", {}, reader).entry(0, 0)
    # twice the ends, by hand
    assert Fraction("0.0999") < lower(found) <= Fraction("0.1") and Fraction("0.4") <= upper(found) < Fraction("0.4001")
    assert reader.data == {"plausible": {"rate0": "0.05..0.2"}}
    with pytest.raises(CertificateError, match="no plausible range 'mass'"):
        evaluate("plausible('mass')", {}, reader)
