"""A claim as the page shows it: the way from the text to the number to the proof."""

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from markupsafe import Markup

from gainsay.report.certificates import CertificateFile
from gainsay.report.numbers import enclosure, number, span
from gainsay.report.reading import PaperResults, Row
from gainsay.report.sentences import said
from gainsay.report.wording import (
    condition,
    input_name,
    input_value,
    is_truth,
    published_value,
    reason,
    recomputed_value,
    turning_point,
)
from gainsay.scans.outcome import Outcome
from gainsay.tables import Case
from gainsay.tables.models import VERDICTS, Claim
from gainsay.tables.sentences import of_sentence, sentences
from gainsay.tables.units import to_si

#: order in which a reader wants them: what broke and what does not hold come first
ORDER = ("failed", "contradicted", "undetermined", "undecided", "reproduced", "uncheckable")
#: what a reader is told first
AGAINST = ("failed", "contradicted", "undetermined", "undecided")
#: kinds of claim whose sentence does not name the number that it is held against
UNNAMED = ("ordering", "figure", "trajectory")
#: verdicts whose number is told even where it is none
ALWAYS = ("contradicted", "reproduced")
#: a claim without a verdict yet
NONE_YET = "none yet"
#: weights of a contradiction, the weightiest first; a claim without one stands last
WEIGHTS = ("result", "gap", "misprint", "")
_NOTHING = Markup("")
_ANCHOR = re.compile(r"[^A-Za-z0-9_.-]")


@dataclass(frozen=True)
class QuantityView:
    """A quantity: what is computed, its value, and how it was obtained; row None where it was not."""

    id: str
    meaning: str
    unit: str
    step: str
    row: Row | None
    file: str = ""
    recorded: str | None = None

    @property
    def value(self) -> Markup:
        """Value in short, with its unit; a truth in a word."""
        if self.row is None:
            return Markup("")
        if self.meaning.startswith("whether") and self.row["value"] in ("0.0", "1.0"):
            return Markup("yes" if self.row["value"] == "1.0" else "no")
        return number(self.row["value"], self.unit)

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
    turns: Markup
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
    reason : Markup
        A sentence on what is not simply reproduced.
    range : Markup
        Range of the recomputed value in the claim's unit; empty where it is the quantity's own.
    quantities : tuple of QuantityView
        Those it compares.
    joins : tuple of str
        Claims that it joins.
    certificates : tuple of CertificateFile
    scan : ScanView or None
    truth : bool
        Whether what is computed is a truth, not a number.
    given : Markup
        Condition under which the verdict stands, in words; empty where there is none.
    """

    claim: Claim
    verdict: str
    row: Row
    published: Markup
    recomputed: Markup
    reason: Markup
    range: Markup
    tolerance: Markup
    quantities: tuple[QuantityView, ...] = ()
    joins: tuple[str, ...] = ()
    certificates: tuple[CertificateFile, ...] = ()
    scan: ScanView | None = None
    truth: bool = False
    given: Markup = _NOTHING

    @property
    def surprising(self) -> bool:
        """Whether the verdict is not the one on record."""
        return self.verdict != self.claim.expected

    @property
    def weight(self) -> str:
        """How much a contradiction weighs: ``result``, ``gap``, ``misprint``; empty where that is not said."""
        return self.claim.weight

    @property
    def compared(self) -> Markup:
        """What is compared, where the sentence alone does not tell; of a scan, without where its own value lies."""
        named = self.claim.kind not in UNNAMED or self.claim.unit != "1"
        if self.truth or not self.quantities or (named and self.verdict not in AGAINST):
            return _NOTHING
        return said(self.quantities[0].meaning.partition(";")[0])

    @property
    def as_read(self) -> Markup:
        """How it reads a sentence that can be read in several ways, and what the readings come to where they differ."""
        whole = self.row["of_sentence"]
        differs = f"; its readings together: {whole}" if whole and whole != self.verdict else ""
        return said(self.claim.as_read) + differs if self.claim.as_read else _NOTHING

    @property
    def sort(self) -> str:
        """Sort of the evidence, in one word: `proved`, `sampled`."""
        return re.split(r"\W", self.row["evidence"], maxsplit=1)[0]

    @property
    def evidence(self) -> str:
        """Kind of evidence, without the theorem that it names; distinct samples where some are equal."""
        kind = self.row["evidence"].partition(":")[0].replace("none", "")
        samples = re.fullmatch(r"sampled (\d+) \(distinct (\d+)\)", kind)
        if samples is None:
            return kind
        return f"{samples[1]} samples" + (f", {samples[2]} of them distinct" if samples[1] != samples[2] else "")


@dataclass(frozen=True)
class Verdicts:
    """All claims of a paper, and the number of its sentences by verdict."""

    claims: tuple[ClaimView, ...]
    counts: Mapping[str, int] = field(default_factory=dict)

    @property
    def spoken(self) -> int:
        """How many sentences of the paper the claims speak of."""
        return sum(self.counts.values())

    def grouped(self) -> list[tuple[str, list[ClaimView]]]:
        """Claims by verdict, those that do not hold first, the weightiest first, else in the order of the paper."""
        groups = []
        for verdict in (*ORDER, NONE_YET):
            claims = [claim for claim in self.claims if claim.verdict == verdict]
            claims.sort(key=lambda claim: WEIGHTS.index(claim.weight) if claim.weight in WEIGHTS else len(WEIGHTS))
            groups.append((verdict, claims))
        return [(verdict, claims) for verdict, claims in groups if claims]

    @property
    def weightiest(self) -> list[ClaimView]:
        """What broke, what is contradicted, what hangs on an input, misprints: in this order, a claim a sentence."""
        against = [c for verdict, group in self.grouped() if verdict in AGAINST for c in group]
        against.sort(key=lambda claim: claim.weight == "misprint")
        names = {claim.id: together[0].id for together in sentences(c.claim for c in self.claims) for claim in together}
        first = {names[c.claim.id]: c for c in reversed(against)}
        return [c for c in against if first[names[c.claim.id]] is c]

    @property
    def surprising(self) -> list[ClaimView]:
        """Claims whose verdict is not the one on record."""
        return [claim for claim in self.claims if claim.surprising]


def claim_link(paper: str, claim: str) -> Markup:
    """Return a link to a claim on the same page."""
    return Markup('<a href="#{}-claim-{}">{}</a>').format(paper, _ANCHOR.sub("-", claim), claim)


def _range(claim: Claim, row: Row, quantities: Sequence[QuantityView], truth: bool) -> Markup:
    low, high = row["range_low"], row["range_high"]
    if quantities and quantities[0].row and (low, high) == (quantities[0].row["lower"], quantities[0].row["upper"]):
        return Markup("")  # said with the number already
    if low == high == row["recomputed"] or truth:
        return Markup("")  # nothing but the value itself
    return span(low, high, claim.unit)


def _at(pair: tuple[float, Mapping] | None, of: str, units: Mapping[str, str]) -> Markup:
    """Say the value of a quantity and the inputs at which it was found."""
    if not pair:
        return Markup("")
    value, point = pair
    inputs = Markup(", ").join(
        Markup("<i>{}</i> = {}").format(name.replace("_", " "), input_value(at, units.get(name, "")))
        for name, at in point.items()
    )
    return Markup("{} at {}").format(number(repr(value), of), inputs)


def scan_view(case: Case, scan: Outcome, of: str) -> ScanView:
    """Return a scan as the page shows it; `of` is the unit of its quantity."""
    units = {entry.name: entry.unit for entry in scan.inputs}
    inputs = []
    for entry in scan.inputs:
        if entry.values:
            shown = Markup(", ").join(input_value(value, entry.unit) for value in entry.values)
        else:
            shown = span(repr(entry.low), repr(entry.high), entry.unit)
        inputs.append(Markup("<i>{}</i>: {}").format(input_name(case, entry.name), shown))
    return ScanView(
        scan.samples,
        scan.holding,
        scan.criterion,
        tuple(inputs),
        span(repr(scan.least[0]), repr(scan.greatest[0]), of),
        turning_point(scan),
        _at(scan.holds_at, of, units),
        _at(scan.fails_at, of, units),
    )


def quantity_view(results: PaperResults, quantity: str) -> QuantityView:
    """Return a declared quantity with what was computed of it, and what is on record where that differs."""
    declared = results.case.quantities[quantity]
    row = results.quantities.get(quantity)
    differing = {d["item"]: d["expected"] for d in results.differences if d["what"] == "quantity"}
    file = results.existing(row["source"]) if row else ""
    return QuantityView(quantity, declared.meaning, declared.unit, declared.step, row, file, differing.get(quantity))


def _claim_view(results: PaperResults, claim: Claim) -> ClaimView:
    row = results.verdicts.get(claim.id)
    verdict = row["verdict"] if row and row["verdict"] in VERDICTS else NONE_YET
    row = row or dict.fromkeys(
        (
            "recomputed",
            "range_low",
            "range_high",
            "tolerance",
            "evidence",
            "witness",
            "verdict",
            "certificate",
            "note",
            "digits",
            "of_sentence",
        ),
        "",
    )
    joins = tuple(claim.quantity.split()) if claim.comparator == "all_of" else ()
    named = [] if joins else [claim.quantity, claim.published if claim.comparator == "less_than" else ""]
    quantities = tuple(quantity_view(results, name) for name in named if name in results.case.quantities)
    at_fault = [other for other in joins if results.verdicts.get(other, {}).get("verdict") == verdict]
    scan = results.scans.get(claim.id)
    declared, truth = results.case.quantities.get(claim.quantity), is_truth(claim)
    return ClaimView(
        claim=claim,
        verdict=verdict,
        row=row,
        published=published_value(results, claim),
        recomputed=recomputed_value(results, claim, row),
        reason=reason(results, claim, row, [claim_link(results.case.name, other) for other in at_fault]),
        range=_range(claim, row, quantities, truth),
        tolerance=Markup("") if row["tolerance"] in ("", "0.0") else number(row["tolerance"], claim.unit),
        quantities=quantities,
        joins=joins,
        certificates=tuple(
            results.certificates.get(name, CertificateFile(name, False, "the certificate is not on file"))
            for name in row["certificate"].split()
        ),
        scan=scan_view(results.case, scan, to_si(declared.unit)[0] if declared else "1") if scan else None,
        truth=truth,
        given=condition(results, claim.given) if claim.given else Markup(""),
    )


def _of_sentence(together: Sequence[ClaimView]) -> str:
    """Return the verdict on a sentence that several claims may speak of."""
    if any(view.verdict == NONE_YET for view in together):
        return NONE_YET
    return of_sentence((view.claim, view.verdict) for view in together)


def verdicts_of(results: PaperResults) -> Verdicts:
    """Return all claims of a paper in the order of its table, and how many sentences have which verdict."""
    claims = {claim.id: _claim_view(results, claim) for claim in results.case.claims.values()}
    spoken = sentences(results.case.claims.values())
    counted = Counter(_of_sentence([claims[claim.id] for claim in together]) for together in spoken)
    counts = {v: counted[v] for v in (*ORDER, NONE_YET) if counted[v] or v in ALWAYS}
    return Verdicts(tuple(claims.values()), counts)
