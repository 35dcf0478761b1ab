"""No claim is such that nothing could turn it: there is evidence under which it holds and evidence against it."""

from fractions import Fraction
from pathlib import Path

import pytest

from gainsay.scans.criterion import NUMERIC, criteria
from gainsay.scans.outcome import outcome
from gainsay.tables import paper_names, read_case
from gainsay.tables.models import PROVED
from gainsay.verdicts.evidence import ComputedQuantity, Concluded, Evidence
from gainsay.verdicts.judge import judge

ROOT = Path(__file__).parents[2]
CASES = {paper: read_case(ROOT, paper) for paper in paper_names(ROOT)}
CLAIMS = [(paper, claim) for paper, case in CASES.items() for claim in case.claims if case.claims[claim].comparator]


def proved(quantity: str, relation: str, low: Fraction | None = None, high: Fraction | None = None) -> Concluded:
    return Concluded(relation, low, high, f"{quantity} {relation}", "theorem")


def number(claim, value: float, quantity: str | None = None) -> Evidence:
    """Evidence of the kind that a claim needs, that its quantity has a value."""
    name, exact = quantity or claim.quantity, Fraction(value)
    if claim.kind in PROVED:
        said = [proved(name, "at_least", low=exact), proved(name, "at_most", high=exact)]
        return Evidence(concluded={name: said}, certificates={c.certificate: "s" for c in said})
    return Evidence(numbers={name: ComputedQuantity(value, value, value, "m", "s")})


def both(claim) -> tuple[Evidence, Evidence]:
    """Evidence under which a claim holds, and evidence under which it does not."""
    if claim.comparator in ("holds", "fails", "feasible", "infeasible"):
        said = {word: [proved(claim.quantity, word)] for word in ("holds", "fails")}
        right, wrong = ("holds", "fails") if claim.comparator in ("holds", "feasible") else ("fails", "holds")
        return tuple(
            Evidence(concluded={claim.quantity: said[word]}, certificates={said[word][0].certificate: "s"})
            for word in (right, wrong)
        )
    if claim.comparator == "less_than":
        found = []
        for value in (1.0, 3.0):
            of, other = number(claim, value), number(claim, 2.0, claim.published)
            found.append(
                Evidence(
                    {**of.numbers, **other.numbers},
                    {**of.concluded, **other.concluded},
                    {**of.certificates, **other.certificates},
                )
            )
        return tuple(found)
    strict, lenient = criteria(claim)[0], criteria(claim)[-1]
    ends = [end for end in (strict.floor, strict.ceiling) if isinstance(end, Fraction)]
    middle = float(sum(ends) / len(ends))
    step = 1.0 + abs(middle)
    inside = middle - step * (claim.comparator == "at_most") + step * (claim.comparator == "at_least")
    outside = float(lenient.floor) - step if lenient.ceiling == float("inf") else float(lenient.ceiling) + step
    return number(claim, inside), number(claim, outside)


@pytest.mark.parametrize(("paper", "name"), CLAIMS, ids=lambda value: value)
def test_there_is_evidence_for_and_against_every_claim(paper, name):
    case, claim = CASES[paper], CASES[paper].claims[name]
    if claim.comparator == "all_of":
        parts = claim.quantity.split()
        verdicts = dict.fromkeys(parts, "reproduced")
        assert judge(case, claim, Evidence(), verdicts).verdict == "reproduced"
        for part in parts:  # each part alone turns it
            assert judge(case, claim, Evidence(), {**verdicts, part: "contradicted"}).verdict == "contradicted"
        return
    right, wrong = both(claim)
    assert judge(case, claim, right, {}).verdict == "reproduced"
    # Of what can be, one number that does not bear it out refutes nothing.
    assert judge(case, claim, wrong, {}).verdict == ("undecided" if claim.holds_for == "some" else "contradicted")


SCANNED = [(p, c) for p, case in CASES.items() for c in dict.fromkeys(claim for claim, _ in case.recorded_scans)]


@pytest.mark.parametrize(("paper", "name"), SCANNED, ids=lambda value: value)
def test_one_sample_turns_every_scan(paper, name):
    """A scan of which every sample holds is undetermined as soon as one does not, and the other way round.

    Where one that holds is enough it still holds, and where none does others may.
    """
    claim = CASES[paper].claims[name]
    assert claim.comparator in NUMERIC
    inside, outside = (e.proved_range(claim.quantity)[0] if claim.kind in PROVED else e.numbers[claim.quantity].value
                       for e in both(claim))  # fmt: skip
    inputs = [{"name": "x", "unit": "1", "low": 0.0, "high": 1.0, "logarithmic": False, "parameter": "x"}]
    none, mixed = ("open", "holds") if claim.holds_for == "some" else ("fails", "depends")
    for values, word in (((inside,) * 3, "holds"), ((outside,) * 3, none), ((inside, inside, outside), mixed)):
        points = [[i / 3] for i in range(3)]
        found = {"quantity": claim.quantity, "inputs": inputs, "values": [float(v) for v in values], "points": points}
        assert outcome(claim, {**found, "crossings": []}).outcome == word
