"""Plants over a box of uncertain numbers, and what the checker makes of them, on matrices whose poles are known."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gainsay.errors import CertificateError, ComputationError, InputError
from gainsay.proof import build, check
from gainsay.proof.scope import MappingTables
from gainsay.systems.uncertain_plant import UncertainPlant

CASE = MappingTables(numbers={"most": "3"}, printed={"B": [["0"], ["1"]]})
RANGES = {"a": ("1", "number('most')"), "b": ("1", "3")}
#: poles -a and -b
TRIANGLE = UncertainPlant(CASE, {"A": "[[-a, 1], [0, -b]]", "C": "row(1, 0)"}, RANGES)
PARTS = {"id": "a", "statement": "s"}


def concluded(certificate):
    assert check(certificate, CASE)
    return {(c.of, c.relation): c.value for c in certificate.conclusions}


def test_a_box_is_proved_left_of_the_first_line_that_one_matrix_shows():
    """With a and b in 1..3 no pole lies right of -1."""
    proof = TRIANGLE.left_of("A", ("-1.1", "-0.5"), quantities={"abscissa": "q"}, **PARTS)
    assert concluded(proof) == {("abscissa", "less_than"): "-0.5"}
    with pytest.raises(ComputationError, match="one Lyapunov matrix for 4 corners"):
        TRIANGLE.left_of("A", ("-1.1",), **PARTS)


def test_a_box_is_proved_inside_a_disk():
    """The poles lie in -3..-1, within 1 of -2."""
    proof = TRIANGLE.in_disk("A", "2", ("0.9", "1.3"), quantities={"radius": "q"}, **PARTS)
    assert concluded(proof) == {("radius", "less_than"): "1.3"}


def test_a_gain_is_bounded_over_a_box():
    """1 / ((s + a)(s + b)) has its largest gain 1 at rest, for a = b = 1."""
    system = {"A": "A", "B": "printed('B')", "C": "C"}
    proof = TRIANGLE.norm_below(system, ("0.99", "1.1"), quantities={"norm": "q"}, **PARTS)
    assert concluded(proof) == {("norm", "less_than"): "1.1"}
    through = {**system, "D": "1"}
    assert concluded(TRIANGLE.norm_below(through, ("1.99", "2.1"), quantities={"norm": "q"}, **PARTS))


def test_corners_samples_and_hull():
    """Products of two numbers are largest and smallest at corners: a b over 1..3 times -1..2 lies in -3..6."""
    plant = UncertainPlant(CASE, {"M": "[[a*b, a]]"}, {"a": ("1", "3"), "b": ("-1", "2")})
    assert plant.at_corners("M")[:, 0].tolist() == [[-1, 1], [2, 1], [-3, 3], [6, 3]]
    assert plant.hull("M") == ([[Fraction(-3), Fraction(1)]], [[Fraction(6), Fraction(3)]])
    samples = plant.samples("M", 50, seed=1)
    assert samples.shape == (50, 1, 2)
    assert np.all((samples[:, 0] >= [-3, 1]) & (samples[:, 0] <= [6, 3]))
    assert plant.at("M", a="0.5", b=4).tolist() == [[2.0, 0.5]]


@settings(max_examples=20)
@given(st.lists(st.floats(-2, 2), min_size=8, max_size=8), st.floats(0, 1), st.floats(0, 1))
def test_a_matrix_in_the_box_lies_in_the_hull_of_its_entries(c, s, t):
    # Law: what is affine in each number is largest and smallest at corners.
    entry = "{!r} + {!r}*a + {!r}*b + {!r}*a*b"
    plant = UncertainPlant(CASE, {"M": f"[[{entry.format(*c[:4])}, {entry.format(*c[4:])}]]"}, RANGES)
    (low,), (high,) = plant.hull("M")
    value = plant.at("M", a=1 + 2 * s, b=1 + 2 * t)[0]
    assert np.all((np.array(low, dtype=float) - 1e-12 <= value) & (value <= np.array(high, dtype=float) + 1e-12))


@pytest.mark.parametrize(
    ("change", "match"),
    [
        (lambda: UncertainPlant(CASE, {}, {}), "expected an uncertain number"),
        (lambda: UncertainPlant(CASE, {}, {"a": ("2", "1")}), "2..1': expected low <= high"),
        (lambda: UncertainPlant(CASE, {}, {"a": ("b", "1")}), "'b'"),
        (lambda: TRIANGLE.at("A", a=1), "a value of each of a, b"),
        (lambda: TRIANGLE.at("A", a=1, b=1, aa=2), "'aa': expected"),
        (lambda: TRIANGLE.left_of("A", (), **PARTS), "expected at least one"),
        (lambda: TRIANGLE.left_of("C", ("0",), **PARTS), "shape"),
    ],
)  # fmt: skip
def test_what_is_no_plant_or_no_point_of_it_is_refused(change, match):
    with pytest.raises((InputError, CertificateError), match=match) as caught:
        change()
    assert "\n" not in str(caught.value)


def certificate(matrix, ranges, alpha="0", **definitions):
    fields = {"matrix": matrix, "alpha": alpha, "ranges": ranges}
    return build.certificate(
        "lyapunov", tables=CASE, definitions=definitions, fields=fields, witness={"P": [["1"]]}, **PARTS
    )


def test_the_checker_proves_a_box_by_its_corners():
    assert concluded(certificate("-a", [["a", "1", "3"]])) == {
        ("abscissa", "less_than"): "0", ("stable", "holds"): None,
    }  # fmt: skip
    assert concluded(certificate("m - 2", [["a", "1", "2"], ["b", "-1", "0.9"]], m="a*b"))


@pytest.mark.parametrize(
    ("matrix", "ranges", "match"),
    [
        # negative at both ends, and not between them
        ("1/2 - a*a", [["a", "-1", "1"]], r"a\*\*2: expected a matrix affine"),
        ("1/2 - a**2", [["a", "-1", "1"]], r"a\*\*2"),
        ("-1/a", [["a", "1", "2"]], ""),
        ("inverse([[a]])", [["a", "1", "2"]], ""),
        ("a", [["a", "-2", "1"]], "vertex 2"),
        ("-a", [["a", "2", "1"]], "low <= high"),
        ("-a", [["a", "1", "2"], ["a", "1", "3"]], "each number once"),
        ("-a", [["a", "1"]], "two ends"),
        ("-a", [["a", 1, 2]], "two ends"),
        ("-a", {"a": ["1", "2"]}, "two ends"),
        ("-a", [["a", "1", "sqrt(2)"]], "rational"),
        ("-a", [["a", "1", "a"]], "'a'"),
        ("-a", [["pi", "1", "2"]], "belongs to the formula language"),
        ("-a*sqrt(2)", [["a", "1", "2"]], "balls and indeterminates"),
        (["-a", "-2*a"], [["a", "1", "2"]], "not both"),
        ("-b0", [[f"b{i}", "1", "2"] for i in range(13)], "at most 12"),
    ],
)
def test_what_is_no_box_or_not_affine_is_refused(matrix, ranges, match):
    with pytest.raises(CertificateError, match=match) as caught:
        certificate(matrix, ranges)
    assert "\n" not in str(caught.value)


def test_an_uncertain_number_is_defined_nowhere_else_and_stands_in_no_level():
    with pytest.raises(CertificateError, match="defined twice"):
        certificate("-a", [["a", "1", "2"]], a="1")
    with pytest.raises(CertificateError, match="polynomial"):
        certificate("-2*a", [["a", "1", "2"]], alpha="-a")
