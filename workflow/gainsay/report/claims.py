"""A claim as the page shows it: the way from the text to the number to the proof."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from markupsafe import Markup, escape

from gainsay.report.numbers import digits_apart, enclosure, number, span, typeset, with_unit
from gainsay.report.reading import CertificateFile, PaperResults, Row
from gainsay.tables.models import VERDICTS, Claim
from gainsay.tables.units import to_si
from gainsay.verdicts.outcome import Outcome

#: order in which a reader wants them: what broke and what does not hold come first
ORDER = ("failed", "contradicted", "undetermined", "reproduced", "uncheckable")
#: a claim without a verdict yet
NONE_YET = "none yet"
_TRUTH = {"1.0": "holds", "1": "holds", "0.0": "fails", "0": "fails"}
_NUMERIC = ("equal", "at_most", "at_least")
_FEASIBLE = {"1.0": "feasible", "0.0": "infeasible"}


@dataclass(frozen=True)
class QuantityView:
    """A quantity: what is computed, its value, and how it was obtained; row None where it was not."""

    id: str
    meaning: str
    unit: str
    step: str
    row: Row | None
    file: str = ""

    @property
    def value(self) -> Markup:
        """Value in short, with its unit."""
        return Markup("") if self.row is None else number(self.row["value"], self.unit)

    @property
    def enclosure(self) -> Markup:
        """Proved or numerical range, never narrower than it is."""
        return (
            Markup("")
            if self.row is None
            else enclosure(self.row["value"], self.row["lower"], self.row["upper"], self.unit)
        )


@dataclass(frozen=True)
class ScanView:
    """A scan over what the paper leaves out."""

    samples: int
    holding: int
    criterion: str
    inputs: tuple[Markup, ...]
    values: Markup
    boundary: Markup
    holds_at: Markup
    fails_at: Markup


@dataclass(frozen=True)
class ClaimView:
    """Everything the page says of a claim.

    Attributes
    ----------
    claim : Claim
    verdict : str
        A verdict, or `NONE_YET`.
    row : mapping
        Its row of verdicts.csv; empty texts where there is none.
    published, recomputed, tolerance : Markup
        As shown.
    range : str
        Range of the recomputed value in the claim's unit, all digits; empty where it is the quantity's own.
    quantities : tuple of QuantityView
        Those it compares.
    joins : tuple of str
        Claims that it joins.
    certificates : tuple of CertificateFile
    scan : ScanView or None
    """

    claim: Claim
    verdict: str
    row: Row
    published: Markup
    recomputed: Markup
    range: str
    tolerance: Markup
    quantities: tuple[QuantityView, ...] = ()
    joins: tuple[str, ...] = ()
    certificates: tuple[CertificateFile, ...] = ()
    scan: ScanView | None = None

    @property
    def truth(self) -> bool:
        """Whether what is computed is a truth, 1 or 0."""
        return _truth(self.claim) is not None

    @property
    def surprising(self) -> bool:
        """Whether the verdict is not the one on record."""
        return self.verdict != self.claim.expected

    @property
    def evidence(self) -> str:
        """Kind of evidence, without the theorem that it names."""
        return self.row["evidence"].partition(":")[0].replace("none", "")


@dataclass(frozen=True)
class Verdicts:
    """All claims of a paper with their counts."""

    claims: tuple[ClaimView, ...]
    counts: Mapping[str, int] = field(default_factory=dict)

    def grouped(self) -> list[tuple[str, list[ClaimView]]]:
        """Claims by verdict, those that do not hold first, each group in the order of the paper."""
        groups = [(v, [c for c in self.claims if c.verdict == v]) for v in (*ORDER, NONE_YET)]
        return [(verdict, claims) for verdict, claims in groups if claims]

    @property
    def surprising(self) -> list[ClaimView]:
        """Claims whose verdict is not the one on record."""
        return [claim for claim in self.claims if claim.surprising]


def _truth(claim: Claim) -> Mapping[str, str] | None:
    """Words for a claim whose value is a truth, not a number."""
    if claim.comparator in ("feasible", "infeasible"):
        return _FEASIBLE
    if claim.comparator == "equal" and claim.kind in ("identity", "definiteness", "feasibility"):
        return _TRUTH
    return None


def _published(claim: Claim) -> Markup:
    printed = typeset(claim.published)
    if claim.comparator in ("feasible", "infeasible"):
        return escape(claim.comparator)
    if claim.comparator == "less_than":
        return Markup("less than <code>{}</code>").format(claim.published)
    if claim.comparator == "all_of":
        return Markup("{} claims together").format(len(claim.quantity.split()))
    if _truth(claim):
        return escape(_TRUTH.get(claim.published, claim.published))
    if claim.comparator == "inside":
        low, _, high = claim.published.partition("..")
        printed = Markup("{} to {}").format(typeset(low), typeset(high))
    sign = {"at_most": "≤\u00a0", "at_least": "≥\u00a0"}.get(claim.comparator, "")
    return with_unit(sign + printed, claim.unit) if claim.published else Markup("")


def _recomputed(claim: Claim, row: Row) -> Markup:
    truth = _truth(claim)
    if truth:
        return escape(truth.get(row["recomputed"], row["recomputed"]))
    if not row["recomputed"]:
        return span(row["range_low"], row["range_high"], claim.unit)
    # where a bound is nearly met, or an equality missed, as many digits as tell the two numbers apart
    near = claim.comparator in ("at_most", "at_least", "inside") or row["verdict"] != "reproduced"
    ends = claim.published.split("..") if near and claim.comparator != "less_than" else ()
    _, _, power = claim.published.lower().partition("e") if claim.comparator in _NUMERIC else ("", "", "")
    digits = digits_apart(row["recomputed"], ends)
    return number(row["recomputed"], claim.unit, digits=digits, power=int(power) if power else None)


def _range(row: Row, quantities: Sequence[QuantityView]) -> str:
    low, high = row["range_low"], row["range_high"]
    if quantities and quantities[0].row and (low, high) == (quantities[0].row["lower"], quantities[0].row["upper"]):
        return ""  # said with the number already
    if low == high == row["recomputed"]:
        return ""  # nothing but the value itself
    if low and high:
        return low if low == high else f"{low} to {high}"
    return f"at least {low}" if low else f"at most {high}" if high else ""


def _at(found: tuple[float, Mapping] | None, of: str, units: Mapping[str, str]) -> Markup:
    """Say the value of a quantity and the inputs at which it was found."""
    if not found:
        return Markup("")
    value, point = found
    inputs = Markup(", ").join(
        Markup("<code>{}</code> = {}").format(name, _input(at, units.get(name, ""))) for name, at in point.items()
    )
    return Markup("{} at {}").format(number(repr(value), of), inputs)


def _input(value: object, of: str) -> Markup:
    return escape(value) if isinstance(value, str) else number(repr(value), of)


def scan_view(scan: Outcome, of: str) -> ScanView:
    """Return a scan as the page shows it; `of` is the unit of its quantity."""
    units = {entry.name: entry.unit for entry in scan.inputs}
    inputs = []
    for entry in scan.inputs:
        if entry.values:
            shown = Markup(", ").join(_input(value, entry.unit) for value in entry.values)
        else:
            shown = span(repr(entry.low), repr(entry.high), entry.unit)
        inputs.append(Markup("<code>{}</code>: {}").format(entry.name, shown))
    boundary, turns = scan.boundary, Markup("")
    if boundary:
        ends = [_input(end, units[boundary.input]) for end in (boundary.holds, boundary.fails)]
        turns = Markup("<code>{}</code>: holds at {}, fails at {}").format(boundary.input, *ends)
    return ScanView(
        scan.samples, scan.holding, scan.criterion, tuple(inputs),
        span(repr(scan.least[0]), repr(scan.greatest[0]), of), turns,
        _at(scan.holds_at, of, units), _at(scan.fails_at, of, units),
    )  # fmt: skip


def quantity_view(found: PaperResults, quantity: str) -> QuantityView:
    """Return a declared quantity with what was computed of it."""
    declared = found.case.quantities[quantity]
    row = found.quantities.get(quantity)
    file = found.existing(row["source"]) if row else ""
    return QuantityView(quantity, declared.meaning, declared.unit, declared.step, row, file)


def _claim_view(found: PaperResults, claim: Claim) -> ClaimView:
    row = found.verdicts.get(claim.id)
    verdict = row["verdict"] if row and row["verdict"] in VERDICTS else NONE_YET
    row = row or dict.fromkeys(("recomputed", "range_low", "range_high", "tolerance", "evidence", "witness",
                                "certificate", "note"), "")  # fmt: skip
    joined = claim.comparator == "all_of"
    named = [] if joined else [claim.quantity, claim.published if claim.comparator == "less_than" else ""]
    quantities = tuple(quantity_view(found, name) for name in named if name in found.case.quantities)
    scan = found.scans.get(claim.id)
    declared = found.case.quantities.get(claim.quantity)
    return ClaimView(
        claim=claim,
        verdict=verdict,
        row=row,
        published=_published(claim),
        recomputed=_recomputed(claim, row),
        range=_range(row, quantities),
        tolerance=Markup("") if row["tolerance"] in ("", "0.0") else number(row["tolerance"], claim.unit),
        quantities=quantities,
        joins=tuple(claim.quantity.split()) if joined else (),
        certificates=tuple(
            found.certificates.get(name, CertificateFile(name, False, "the certificate is not on file"))
            for name in row["certificate"].split()
        ),
        scan=scan_view(scan, to_si(declared.unit)[0] if declared else "1") if scan else None,
    )


def verdicts_of(found: PaperResults) -> Verdicts:
    """Return all claims of a paper in the order of its table, with the count of every verdict."""
    claims = tuple(_claim_view(found, claim) for claim in found.case.claims.values())
    counted = Counter(claim.verdict for claim in claims)
    return Verdicts(claims, {v: counted[v] for v in (*ORDER, NONE_YET) if v in VERDICTS or counted[v]})
