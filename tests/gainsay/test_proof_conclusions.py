"""What conclusions imply of each other, and how eigenvalues are matched."""

from fractions import Fraction
from itertools import product

import pytest

from gainsay.proof import Conclusion
from gainsay.proof.checker import ends, implied
from gainsay.proof.kinds import Proved, eigenvalues

RELATIONS = ("at_most", "less_than", "at_least", "greater_than")


def meaning(relation, value):
    """Numbers of a small grid for which it holds."""
    test = {"at_most": lambda x: x <= value, "less_than": lambda x: x < value, "at_least": lambda x: x >= value,
            "greater_than": lambda x: x > value}[relation]  # fmt: skip
    return {x / 2 for x in range(-12, 13) if test(x / 2)}


@pytest.mark.parametrize(("proved", "stated"), list(product(RELATIONS, RELATIONS)))
def test_a_bound_implies_another_exactly_when_its_set_is_smaller(proved, stated):
    for a, b in product(range(-2, 3), repeat=2):
        follows = implied([Proved("norm", proved, str(a))], Conclusion("q", stated, str(b), "norm"))
        assert follows == (meaning(proved, a) <= meaning(stated, b)), (a, b)
        assert not implied([Proved("norm", proved, str(a))], Conclusion("q", stated, str(b), "other"))


def test_intervals_imply_what_they_hold():
    found = [Proved("value", "inside", "1..2")]
    for relation, value, follows in (
        ("inside", "1..2", True), ("inside", "0..3", True), ("inside", "1.1..2", False), ("inside", "1..1.9", False),
        ("at_most", "2", True), ("less_than", "2", False), ("less_than", "2.1", True), ("at_most", "1.9", False),
        ("at_least", "1", True), ("greater_than", "1", False), ("greater_than", "0.9", True),
           ("at_least", "1.1", False),
        ("holds", None, False), ("at_most", None, False), ("inside", None, False),
    ):  # fmt: skip
        assert implied(found, Conclusion("q", relation, value, "value")) is follows, (relation, value)
    both = [Proved("v", "at_least", "1"), Proved("v", "less_than", "2")]
    assert implied(both, Conclusion("q", "inside", "1..2", "v"))
    assert not implied(both[:1], Conclusion("q", "inside", "1..2", "v"))
    assert not implied(both[1:], Conclusion("q", "inside", "1..2", "v"))
    assert not implied([], Conclusion("q", "inside", "1..2", "v"))
    assert ends("1..2") == (1, 2)
    with pytest.raises(ValueError, match="not an interval"):
        ends("1")


def test_truths_imply_themselves_alone():
    for proved, stated in product(("holds", "fails"), repeat=2):
        found = [Proved("stable", proved)]
        assert implied(found, Conclusion("q", stated, None, "stable")) == (proved == stated)
        assert not implied(found, Conclusion("q", stated, "1", "stable"))
        assert not implied(found, Conclusion("q", stated, None, "feasible"))


def test_the_best_matching_is_found():
    """Against the closed form of small cases: the smallest possible largest cost."""
    for costs, best in (
        ([[1]], 1), ([[1, 2], [2, 1]], 1), ([[1, 1], [3, 9]], 3), ([[5, 1], [1, 5]], 1), ([[4, 4], [4, 4]], 4),
        ([[1, 9, 9], [9, 9, 1], [9, 1, 9]], 1), ([[1, 2, 3], [1, 5, 6], [1, 8, 9]], 5),
    ):  # fmt: skip
        assert eigenvalues.matched([[Fraction(x) for x in row] for row in costs]) == best
