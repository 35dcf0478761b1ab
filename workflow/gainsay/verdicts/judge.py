"""The verdict on a claim, from the claim and the evidence alone."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

from gainsay.exact.digits import PrintedNumber
from gainsay.results.returned import FROM_DIGITS
from gainsay.scans.criterion import criteria
from gainsay.scans.outcome import Outcome
from gainsay.tables import Case
from gainsay.tables.lint import given_of
from gainsay.tables.models import PROVED, Claim
from gainsay.tables.sentences import of_sentence
from gainsay.tables.units import to_si
from gainsay.verdicts.evidence import ComputedQuantity, Evidence

#: kinds that a number alone does not decide, and what it needs
_BOUNDED = {"trajectory": "a numerical error bound", "parameter": "an enclosure", "gain": "an enclosure"}
#: kinds of which printed inputs may explain the printed value
_DIGITS = ("parameter", "gain")
#: verdict on a claim that a scan of its quantity speaks of
_OF_SCAN = {"holds": "reproduced", "fails": "contradicted", "depends": "undetermined", "open": "undecided"}
#: verdicts of a proof that what is said of every sample excludes
_AGAINST_SAMPLES = {"holds": ("contradicted",), "fails": ("reproduced",)}
#: relative rounding by which a double may lie outside the bounds proved for it
_ROUNDING = Fraction(1, 10**6)

Number = Fraction | float


@dataclass(frozen=True)
class Judgement:
    """A verdict with all that the table of verdicts says of it.

    Attributes
    ----------
    verdict : str
    recomputed : float or None
        In the claim's unit.
    tolerance : float or None
        In the claim's unit.
    evidence : str
        Kind of evidence, such as ``proved: farkas`` or ``simulated``.
    range_low, range_high : float or None
        Proved, numerical or scanned range, in the claim's unit.
    witness, certificate, note : str
    """

    verdict: str
    recomputed: float | None = None
    tolerance: float | None = None
    evidence: str = "none"
    range_low: float | None = None
    range_high: float | None = None
    witness: str = ""
    certificate: str = ""
    note: str = ""


def _in_unit(claim: Claim, value: Fraction | float | None) -> float | None:
    if value is None or value in (math.inf, -math.inf):
        return None
    factor = to_si(claim.unit)[1]
    return float(value) if factor == 1 else float(Fraction(value) / factor)


def _missing(case: Case, claim: Claim, evidence: Evidence) -> Judgement:
    step = case.quantities[claim.quantity].step
    broken = [f"{f['where']}: {f['message']}" for f in evidence.failures if f["step"] == step]
    reason = "; ".join(broken) or f"the step {step} did not compute {claim.quantity}"
    return Judgement("failed", note=f"{reason}; attempts in attempts/{step}.json")


def _unproved(case: Case, claim: Claim, evidence: Evidence) -> Judgement:
    """Judge what was computed and not proved: undecided, unless a computation of that step or a certificate broke."""
    number, step = evidence.numbers.get(claim.quantity), case.quantities[claim.quantity].step
    lost = evidence.lost.get(claim.quantity) or evidence.lost.get("")
    if lost:
        return Judgement("failed", certificate=" ".join(lost), note=f"refused: {evidence.refused[lost[0]]}")
    if number is None or any(failure["step"] == step for failure in evidence.failures):
        return _missing(case, claim, evidence)
    return Judgement("undecided", note=f"computed as {number.value!r}, and no certificate says so ({number.method})")


def _judge_yes_or_no(case: Case, claim: Claim, evidence: Evidence) -> Judgement:
    """Judge what either holds or fails; only an accepted certificate decides."""
    conclusions = [c for c in evidence.concluded.get(claim.quantity, []) if c.relation in ("holds", "fails")]
    number = evidence.numbers.get(claim.quantity)
    if not conclusions:
        return _unproved(case, claim, evidence)
    relations = {c.relation for c in conclusions}
    certificates = " ".join(c.certificate for c in conclusions)
    proved = f"proved: {', '.join(sorted({c.theorem for c in conclusions}))}"
    if len(relations) > 1:
        return Judgement("failed", evidence=proved, certificate=certificates, note="certificates contradict each other")
    holds = relations == {"holds"}
    if number is not None and number.value != holds:
        note = f"computed as {number.value!r}, but the certificate says {conclusions[0].relation}"
        return Judgement("failed", evidence=proved, certificate=certificates, note=note)
    wanted = claim.comparator in ("holds", "feasible")
    witness = "" if holds == wanted else evidence.certificates[conclusions[0].certificate]
    return Judgement(
        "reproduced" if holds == wanted else "contradicted",
        recomputed=float(holds),
        evidence=proved,
        certificate=certificates,
        witness=witness,
    )


def _decides(claim: Claim, scan: Outcome, evidence: Evidence) -> bool:
    """Say whether a scan decides a claim, and no proof: samples that nothing bears out leave room for one."""
    if scan.outcome == "open" and claim.quantity in evidence.concluded:
        return False
    return claim.kind not in PROVED or scan.outcome == "depends"


def _judge_scan(claim: Claim, scan: Outcome, number: ComputedQuantity | None) -> Judgement:
    """Judge a claim over the plausible values of what the paper leaves out.

    The value at our own filling is one plausible value more: it must bear out what the samples say.
    """
    if number is not None and scan.outcome != "depends" and not (scan.one_is_enough and scan.outcome == "holds"):
        strict, lenient = (readings := criteria(claim))[0], readings[-1]
        agrees = strict.holds(number.value) if scan.outcome == "holds" else not lenient.holds(number.value)
        if not agrees:
            note = f"every sample of the scan {scan.outcome}, our own filling, {number.value!r}, does not"
            return Judgement("failed", note=note)
    verdict = _OF_SCAN[scan.outcome]
    ends = [_in_unit(claim, value) for value, _ in (scan.least, scan.greatest)]
    return Judgement(
        verdict,
        evidence=scan.evidence,
        range_low=ends[0],
        range_high=ends[1],
        witness=scan.witness,
        note=scan.note,
    )


def _kind_of_evidence(claim: Claim, number: ComputedQuantity | None) -> str:
    """Name what a number rests on: an enclosure, a run with its error bound, or doubles alone."""
    if claim.kind == "trajectory" or (number is not None and number.source.startswith("logs/")):
        return "simulated"
    bounded = number is None or (number.lower is not None and number.upper is not None)
    return "enclosed" if bounded else "computed"


def _ends(number: ComputedQuantity) -> tuple[Fraction, Fraction]:
    low, high = (Fraction(number.value if end is None else end) for end in (number.lower, number.upper))
    return low, high


def _contradictory(low: Number, high: Number, number: ComputedQuantity | None) -> bool:
    """Say whether proofs exclude each other, or what was computed lies outside them by more than rounding."""
    if low > high:
        return True
    if number is None:
        return False
    bottom, top = _ends(number)
    slack = _ROUNDING * max(abs(bottom), abs(top))
    return top + slack < low or bottom - slack > high


def contradictions(evidence: Evidence) -> Iterator[tuple[str, str]]:
    """Yield every quantity that certificates say otherwise than it was written, claimed or not, and how."""
    for quantity, concluded in evidence.concluded.items():
        if not quantity:
            continue  # certificates that conclude on none have nothing in common
        number = evidence.numbers.get(quantity)
        relations = {c.relation: c.certificate for c in concluded if c.relation in ("holds", "fails")}
        low, high, used = evidence.proved_range(quantity)
        if len(relations) > 1:
            yield quantity, f"certificates contradict each other: {' '.join(relations.values())}"
        elif relations and number is not None and number.value != float("holds" in relations):
            relation, certificate = relations.popitem()
            yield quantity, f"written as {number.value!r}, but the certificate {certificate} says that it {relation}"
        elif used and _contradictory(low, high, number):
            names = " ".join(dict.fromkeys(c.certificate for c in used))
            written = "" if number is None else f"written as {number.value!r}, "
            yield quantity, f"{written}outside of what certificates prove: {names}"


def _narrowed(low: Number, high: Number, number: ComputedQuantity | None) -> tuple[Number, Number]:
    """Narrow a proved range by what was computed, in order even where rounding parts the two."""
    if number is None:
        return low, high
    bottom, top = _ends(number)
    low, high = max(low, bottom), min(high, top)
    return (low, high) if low <= high else (high, low)


def _strict(claim: Claim, evidence: Evidence) -> bool:
    """Say whether the bound of a claim is proved with room to spare or by a strict inequality."""
    if claim.comparator not in ("at_most", "at_least"):
        return True
    bound = PrintedNumber(claim.published).value * to_si(claim.unit)[1]
    conclusions = evidence.concluded.get(claim.quantity, [])
    if claim.comparator == "at_most":
        ends = [(bound - c.high, c.relation == "less_than") for c in conclusions if c.high is not None]
    else:
        ends = [(c.low - bound, c.relation == "greater_than") for c in conclusions if c.low is not None]
    return any(room > 0 or (room == 0 and strict) for room, strict in ends)


def _within_digits(claim: Claim, number: ComputedQuantity | None, tolerance: Fraction) -> bool:
    """Say whether what encloses a number is the rounding of printed digits, and leaves it a digit: else all fits."""
    if claim.kind not in _DIGITS or number is None or not number.method.startswith(FROM_DIGITS):
        return False
    low, high = _ends(number)
    return (high - low) / 2 < max(abs(low + high) / 2, tolerance)


def _judge_number(case: Case, claim: Claim, evidence: Evidence) -> Judgement:
    """Judge a number by the range that its evidence gives it."""
    number = evidence.numbers.get(claim.quantity)
    low, high, used = evidence.proved_range(claim.quantity)
    if number is None and not used:
        return _missing(case, claim, evidence)
    if claim.kind in PROVED and not used:
        return _unproved(case, claim, evidence)
    if _contradictory(low, high, number):
        return Judgement("failed", note=f"the evidence on {claim.quantity} contradicts itself")
    certificate = " ".join(dict.fromkeys(c.certificate for c in used))
    if claim.kind in PROVED:
        kind = f"proved: {', '.join(sorted({c.theorem for c in used}))}" if used else "none"
    else:
        kind = _kind_of_evidence(claim, number)
        if claim.kind in _BOUNDED and (number is None or number.lower is None or number.upper is None):
            return Judgement("failed", note=f"a {claim.kind} needs {_BOUNDED[claim.kind]}, and none was computed")
        low, high = _narrowed(low, high, number)
    value = number.value if number is not None else None
    shared: dict[str, Any] = {
        "recomputed": _in_unit(claim, value),
        "evidence": kind,
        "range_low": _in_unit(claim, low),
        "range_high": _in_unit(claim, high),
        "certificate": certificate,
    }
    if claim.comparator == "less_than":
        return _judge_order(case, claim, evidence, low, high, shared)
    readings = criteria(claim)
    outcomes = [reading.holds_on(low, high) for reading in readings]
    shared["tolerance"] = _in_unit(claim, readings[0].tolerance)
    if outcomes[0] and claim.kind == "stability" and not _strict(claim, evidence):
        return Judgement("undecided", note="proved up to the boundary: stability needs a strict inequality", **shared)
    if outcomes[0]:
        return Judgement("reproduced", **shared)
    bounds = f"{shared['range_low']!r}..{shared['range_high']!r}" if low != high else f"{shared['recomputed']!r}"
    text = f"{claim.quantity} = {bounds} {claim.unit}".strip()
    if outcomes[-1] is False:
        return Judgement("contradicted", witness=text, **shared)
    if outcomes[0] is False and outcomes[-1]:
        witness = f"depends on the threshold, {claim.published} {claim.unit}: turns at {text}"
        return Judgement("undetermined", witness=witness, **shared)
    if _within_digits(claim, number, readings[0].tolerance) and outcomes[-1] is None:
        note = "within the rounding of the digits that the paper prints, of its inputs and of this value"
        return Judgement("reproduced", note=note, **shared)
    if claim.kind in PROVED:
        reason = f"no certificate decides it: proved {bounds}" if used else "no certificate decides it"
    else:
        reason = "its error bound is too wide to decide"
    return Judgement("undecided", note=reason, **shared)


def _left_open(case: Case, claim: Claim, evidence: Evidence, judged: Judgement) -> bool:
    """Say whether inputs are left at which a sentence that says `can` was not looked at.

    None are where every certificate covers a plausible range, and nothing that the paper leaves out has a value of ours
    in the condition of the claim or in what the certificates read.
    """
    used = [c for c in evidence.concluded.get(claim.quantity, []) if c.certificate in judged.certificate.split()]
    fixed = set(given_of(case, claim)).union(*(evidence.read.get(c.certificate, set()) for c in used))
    return not used or not all(c.over for c in used) or bool(fixed & set(case.assumed))


def _one_is_enough(case: Case, claim: Claim, evidence: Evidence, judged: Judgement) -> Judgement:
    """Judge a number under a sentence that says `can`: one input bears it out, and all of them refute it."""
    at = f" at {claim.given}" if claim.given else ""
    if judged.verdict == "reproduced":
        value = f"{judged.recomputed!r} {claim.unit}".removesuffix(" 1")
        return replace(judged, witness=f"borne out by {claim.quantity} = {value}{at}")
    if judged.verdict == "contradicted" and _left_open(case, claim, evidence, judged):
        note = f"not borne out{at}, which does not say that nothing bears it out: {judged.witness}"
        return replace(judged, verdict="undecided", witness="", note=note)
    return judged


def _judge_order(case: Case, claim: Claim, evidence: Evidence, low: Number, high: Number, shared: dict) -> Judgement:
    """Judge whether a quantity is less than another."""
    other = evidence.numbers.get(claim.published)
    floor, ceiling, _ = evidence.proved_range(claim.published)
    if _contradictory(floor, ceiling, other):
        return Judgement("failed", note=f"the evidence on {claim.published} contradicts itself", **shared)
    if claim.kind not in PROVED:
        floor, ceiling = _narrowed(floor, ceiling, other)
    if other is None and floor == -math.inf and ceiling == math.inf:
        return _missing(case, claim.model_copy(update={"quantity": claim.published}), evidence)
    if high < floor:
        return Judgement("reproduced", **shared)
    if low >= ceiling:
        compared = None if other is None else _in_unit(claim, other.value)
        witness = f"{claim.quantity} = {shared['recomputed']!r}, {claim.published} = {compared!r} {claim.unit}"
        return Judgement("contradicted", witness=witness, **shared)
    return Judgement("undecided", note="the ranges of the two quantities overlap", **shared)


def judge(case: Case, claim: Claim, evidence: Evidence, verdicts: dict[str, str]) -> Judgement:
    """Return the verdict on a claim.

    Parameters
    ----------
    case : Case
    claim : Claim
    evidence : Evidence
    verdicts : dict
        Verdicts so far, for claims that join others.
    """
    if claim.kind == "remark":
        return Judgement("uncheckable", note="nothing in the text to hold it against")
    if claim.comparator == "all_of":
        parts = claim.quantity.split()
        joined = of_sentence((case.claims[part], verdicts[part]) for part in parts)
        at_fault = [part for part in parts if verdicts[part] == joined]
        witness = "" if joined == "reproduced" else f"{joined}: {' '.join(at_fault)}"
        return Judgement(joined, evidence="joined", witness=witness)
    scan = evidence.scans.get(claim.id)
    if scan is not None and _decides(claim, scan, evidence):
        return _judge_scan(claim, scan, evidence.numbers.get(claim.quantity))
    given_up = evidence.undecided.get(claim.quantity)
    if given_up is not None and claim.quantity not in evidence.concluded:
        return Judgement("undecided", note=given_up)
    if claim.comparator in ("holds", "fails", "feasible", "infeasible"):
        return _judge_yes_or_no(case, claim, evidence)
    judged = _judge_number(case, claim, evidence)
    if scan is not None and judged.verdict in _AGAINST_SAMPLES.get(scan.outcome, ()):
        note = f"the certificate says {judged.verdict}, and the scan: {scan.note}"
        return Judgement("failed", evidence=judged.evidence, certificate=judged.certificate, note=note)
    return _one_is_enough(case, claim, evidence, judged) if claim.holds_for == "some" else judged
