"""Checks between the tables of a paper: what one row names must stand in another."""

import math
import re
from collections.abc import Iterable, Iterator

from gainsay.errors import InputError, nearest, one_of
from gainsay.exact.digits import PrintedNumber, double
from gainsay.tables.campaigns import faults as campaign_faults
from gainsay.tables.case import Case
from gainsay.tables.models import PROVED, Claim, Erratum, Toleranced
from gainsay.tables.thresholds import published_ends, reading_faults, thresholds
from gainsay.tables.units import to_si

#: kinds of which a claim may be a yes or no
YES_OR_NO = frozenset({"identity", "definiteness", "feasibility", "stability", "pole-region"})
_STATES = {"holds": "holds", "fails": "fails", "feasible": "is feasible", "infeasible": "is infeasible"}
_ROW_OF_FIRST = 2
#: words by which a sentence says that something is possible, and no more
_POSSIBLE = re.compile(r"\b(can|may|might|could|able to)\b", re.IGNORECASE)


def _tolerance_faults(claim: Claim) -> Iterator[tuple[str, str, str]]:
    if not claim.tolerance:
        return
    if claim.comparator not in ("equal", "at_most", "at_least", "inside"):
        yield "tolerance", claim.tolerance, f"nothing, since {claim.comparator or 'a remark'} knows no tolerance"
    elif PrintedNumber(claim.tolerance).value < 0:
        yield "tolerance", claim.tolerance, "a tolerance of at least 0"
    elif not claim.note:
        yield "note", claim.note, "the reason of the stated tolerance"


def _yes_or_no_faults(claim: Claim) -> Iterator[tuple[str, str, str]]:
    """Yield the faults of a claim on what holds or fails."""
    if claim.comparator == "equal" and claim.published in ("0", "1") and claim.unit == "1" and claim.kind in YES_OR_NO:
        word = "holds" if claim.published == "1" else "fails"
        yield "comparator", "equal", f"{word}, without a published value, since a {claim.kind} is no number"
    if claim.comparator in ("holds", "fails", "feasible", "infeasible"):
        if claim.published:
            yield "published", claim.published, f"nothing, since what {_STATES[claim.comparator]} has no value"
        if claim.kind not in PROVED:
            yield "kind", claim.kind, f"a kind that needs a proof, since only a proof says what {claim.comparator} is"


def _holds_for_faults(claim: Claim) -> Iterator[tuple[str, str, str]]:
    """Yield the faults in what a claim holds for: a sentence that says `can` says for which inputs it is judged."""
    possibility = _POSSIBLE.search(re.sub(r"\$[^$]*\$", "", claim.statement))
    if possibility and not claim.holds_for and claim.kind != "remark":
        yield "holds_for", "", f"some or every, since the sentence says {possibility[0]!r}"
    if claim.holds_for == "some" and claim.comparator not in ("equal", "at_most", "at_least", "inside"):
        yield "holds_for", "some", f"nothing or every, since {claim.comparator or 'a remark'} compares no number"


def _weight_faults(claim: Claim) -> Iterator[tuple[str, str, str]]:
    """Yield the faults in the weight of what does not hold."""
    for field in ("weight", "ocr"):
        value = getattr(claim, field)
        if claim.expected == "contradicted" and not value:
            expected = "misprint, gap or result" if field == "weight" else "possible, excluded or open"
            yield field, value, f"{expected}, since the claim does not hold"
        if value and claim.expected in ("reproduced", "uncheckable"):
            yield field, value, f"nothing, since the claim is {claim.expected}"


def rests_on_samples(case: Case, claim: Claim) -> bool:
    """Say whether the verdict on record holds at every sample of a range, and is proved nowhere between them."""
    if claim.expected != "reproduced" or claim.kind in PROVED or (claim.id, "samples") not in case.recorded_scans:
        return False
    reads = case.recorded_reads.items()
    scanned = [name for (of, name), row in reads if of == claim.quantity and row.how == "scanned"]
    return any(".." in case.parameters[name].plausible for name in scanned if name in case.parameters)


def _sampled_faults(case: Case, claim: Claim) -> Iterator[tuple[str, str, str]]:
    """Yield the fault of a claim that holds at samples and does not say why it is not proved between them."""
    if rests_on_samples(case, claim) and claim.holds_for != "some" and "sampled: " not in claim.note:
        yield "note", claim.note, "`sampled: ` and the reason why it is not proved over the plausible values"


def given_of(case: Case, claim: Claim) -> dict[str, str]:
    """Return the condition of a claim: name of what the paper leaves out -> value, as text.

    Raises
    ------
    InputError
        If it is no list of `name=value`.
    """
    values: dict[str, str] = {}
    for part in claim.given.split(";") if claim.given else ():
        name, sign, value = (word.strip() for word in part.partition("="))
        if not sign or not value or name in values or name not in case.parameters:
            expected = "`name=value; name=value`, each name once and in parameters.csv"
            raise InputError("given", value=part.strip(), expected=expected)
        values[name] = value
    return values


def _given_faults(case: Case, claim: Claim) -> Iterator[tuple[str, str, str]]:
    """Yield the faults of a condition: it names what the paper leaves out and a plausible value of it, or a print."""
    try:
        given = given_of(case, claim)
    except InputError as error:
        yield "given", str(error.value), error.expected
        return
    for name, value in given.items():
        row = case.parameters[name]
        if row.status == "printed" and not _same(value, row.value):
            yield "given", f"{name}={value}", f"{row.value}, which the paper prints"
        elif row.status not in ("assumed", "printed"):
            yield "given", name, "a parameter that the paper leaves out, or prints"
        elif row.status == "printed":
            continue
        elif row.type == "choice" and value not in row.plausible.split("|"):
            yield "given", f"{name}={value}", f"one of {row.plausible}"
        elif row.type == "number" and not _is_plausible(value, row.plausible):
            yield "given", f"{name}={value}", f"a number among the plausible values {row.plausible}"


def _unsaid_faults(case: Case, claim: Claim) -> Iterator[tuple[str, str, str]]:
    """Yield what a claim's quantities hang on, where the claim is not conditioned on it."""
    quantities = {claim.quantity, claim.published if claim.comparator == "less_than" else claim.quantity}
    try:
        given = given_of(case, claim)
    except InputError:
        return  # said already
    read = {key[1] for key, row in case.recorded_reads.items() if key[0] in quantities and row.how != "scanned"}
    unsaid = [f"{name}={case.parameters[name].value}" for name in sorted(read - set(given)) if name in case.parameters]
    if unsaid:
        wanted = f"{'; '.join(unsaid)} too, since {claim.quantity} rests on it; or a scan over its plausible values"
        yield "given", claim.given, wanted
    for name in sorted(read & set(given)):
        value = case.parameters[name].value
        if not _same(given[name], value):
            yield "given", f"{name}={given[name]}", f"{value}, at which {claim.quantity} is computed"


def _same(one: str, other: str) -> bool:
    try:
        return PrintedNumber(one).value == PrintedNumber(other).value
    except InputError:
        return one == other


def _is_plausible(value: str, plausible: str) -> bool:
    low, dots, high = plausible.partition("..")
    try:
        number = PrintedNumber(value).value
    except InputError:
        return False
    if dots:
        return PrintedNumber(low).value <= number <= PrintedNumber(high).value
    return number in {PrintedNumber(part).value for part in plausible.split("|")}


def _sentence_faults(case: Case) -> Iterator[tuple[int, Claim, str, str]]:
    """Yield row, claim, field and expectation where claims of one sentence do not go together."""
    first: dict[str, Claim] = {}
    readings: dict[str, set[str]] = {}
    earlier: dict[tuple[str, str], Claim] = {}
    for claim in case.claims.values():
        readings.setdefault(claim.sentence, set()).add(claim.as_read)
    for row, claim in enumerate(case.claims.values(), start=_ROW_OF_FIRST):
        if claim.as_read and (not claim.sentence or len(readings[claim.sentence] - {""}) < 2):
            yield row, claim, "as_read", "nothing, or a name in `sentence` shared with a claim that reads it otherwise"
        alike = earlier.setdefault((claim.where, claim.statement), claim)
        if alike is not claim and (not claim.sentence or alike.sentence != claim.sentence):
            yield row, claim, "sentence", f"a name shared with {alike.id}, which says the same of the same place"
        if not claim.sentence:
            continue
        before = first.setdefault(claim.sentence, claim)
        if before.where != claim.where:
            yield row, claim, "where", f"the place of {before.id}, {before.where}, since both speak of one sentence"


def _joined_faults(case: Case, claim: Claim) -> Iterator[tuple[str, str, str]]:
    others = claim.quantity.split()
    if not others:
        yield "quantity", "", "the claims that it joins, separated by blanks"
    for other in others:
        if other not in case.claims or other == claim.id or case.claims[other].comparator == "all_of":
            yield "quantity", other, "another claim of this table that joins none itself"
        elif claim.kind in PROVED and case.claims[other].kind not in PROVED:
            yield "quantity", other, f"a claim that needs a proof, as a {claim.kind} does"


def _claim_faults(case: Case, claim: Claim) -> Iterator[tuple[str, str, str]]:
    """Yield field, value and expectation of every fault of a claim."""
    yield from _tolerance_faults(claim)
    yield from reading_faults(case, claim)
    yield from _holds_for_faults(claim)
    yield from _weight_faults(claim)
    yield from _given_faults(case, claim)
    if claim.expected == "failed":
        yield "expected", claim.expected, "a verdict: a computation that broke is never on record"
    if claim.kind == "remark":
        if claim.comparator or claim.quantity:
            yield "comparator", claim.comparator, "nothing, since a remark is held against nothing"
        if claim.expected != "uncheckable":
            yield "expected", claim.expected, "uncheckable, since a remark is held against nothing"
        return
    if not claim.comparator:
        yield "comparator", "", f"a comparator, since a {claim.kind} is held against something"
        return
    if claim.comparator == "all_of":
        yield from _joined_faults(case, claim)
        return
    if claim.quantity not in case.quantities:
        near = nearest(claim.quantity, case.quantities)
        known = f", such as {near}" if near else ""
        yield "quantity", claim.quantity, f"a quantity declared in quantities.csv{known}"
        return
    yield from _yes_or_no_faults(claim)
    yield from _unsaid_faults(case, claim)
    yield from _sampled_faults(case, claim)
    unit = case.quantities[claim.quantity].unit
    if to_si(claim.unit)[0] != unit:
        yield "unit", claim.unit, f"{unit}, the unit of {claim.quantity}, or one that converts to it"
    try:
        if claim.comparator == "inside":
            low, high = published_ends(claim.published)
            if low.value > high.value:
                yield "published", claim.published, "the smaller end first"
        elif claim.comparator == "less_than":
            other = case.quantities.get(claim.published)
            if other is None or other.unit != unit:
                yield "published", claim.published, f"a quantity in {unit} declared in quantities.csv"
        elif claim.comparator in ("equal", "at_most", "at_least"):
            low, high = thresholds(claim)
            if low.value > high.value:
                yield "published", claim.published, "the smaller end first"
    except InputError as error:
        yield "published", claim.published, error.expected


def lint(case: Case) -> None:
    """Check every reference between a paper's tables, and that what is computed is in SI.

    Raises
    ------
    InputError
        At the first fault, naming file, row, field, value and what was expected.
    """
    for row, declared in enumerate(case.quantities.values(), start=_ROW_OF_FIRST):
        if to_si(declared.unit) != (declared.unit, 1):
            raise InputError(
                file=f"papers/{case.name}/quantities.csv",
                row=row,
                field="unit",
                value=declared.unit,
                expected=f"{to_si(declared.unit)[0]}, since what is computed is in SI",
            )
        for entry in sorted(declared.requirements):
            name = entry.partition("=")[2]
            faults = [("requires", entry, f"what=parameter, {one_of(name, case.parameters)}")]
            _refuse_first(faults if name not in case.parameters else [], f"papers/{case.name}/quantities.csv", row)
    matrices = [name for name, parameter in case.parameters.items() if parameter.type == "matrix"]
    for printed in case.paper.printed.values():
        faults = [("printed", printed, one_of(printed, matrices))] if printed not in matrices else []
        _refuse_first(faults, f"papers/{case.name}/paper.toml", None)
    for measured, text in case.paper.measures.items():
        _refuse_first(_measure_faults(case, measured, text), f"papers/{case.name}/paper.toml", None)
    for row, claim in enumerate(case.claims.values(), start=_ROW_OF_FIRST):
        for field, value, expected in _claim_faults(case, claim):
            raise InputError(
                f"claim {claim.id}:",
                file=f"papers/{case.name}/claims.csv",
                row=row,
                field=field,
                value=value,
                expected=expected,
            )
    for row, claim, field, expected in _sentence_faults(case):
        file, value = f"papers/{case.name}/claims.csv", getattr(claim, field)
        raise InputError(f"claim {claim.id}:", file=file, row=row, field=field, value=value, expected=expected)
    for row, erratum in enumerate(case.errata.values(), start=_ROW_OF_FIRST):
        _refuse_first(_erratum_faults(erratum), f"papers/{case.name}/errata.csv", row)
    for row, reply in enumerate(case.replies, start=_ROW_OF_FIRST):
        if reply.claim not in case.claims:
            faults = [("claim", reply.claim, one_of(reply.claim, case.claims))]
            _refuse_first(faults, f"papers/{case.name}/replies.csv", row)
    for row, recorded in enumerate(case.recorded.values(), start=_ROW_OF_FIRST):
        quantity = case.quantities.get(recorded.quantity)
        faults = list(_recorded_faults(recorded))
        if quantity is None:
            faults = [("quantity", recorded.quantity, "one of quantities.csv")]
        elif quantity.unit != recorded.unit:
            faults = [("unit", recorded.unit, quantity.unit)]
        _refuse_first(faults, f"papers/{case.name}/recorded.csv", row)
    for row, recorded_scan in enumerate(case.recorded_scans.values(), start=_ROW_OF_FIRST):
        words = recorded_scan.class_ == "exact"  # an outcome, an input, one of a list of choices
        faults = [] if words else list(_recorded_faults(recorded_scan))
        if recorded_scan.claim not in case.claims:
            faults = [("claim", recorded_scan.claim, "one of claims.csv")]
        _refuse_first(faults, f"papers/{case.name}/recorded_scans.csv", row)
    for row, campaign in enumerate(case.campaigns.values(), start=_ROW_OF_FIRST):
        _refuse_first(campaign_faults(case, campaign), f"papers/{case.name}/campaigns.csv", row)


def _erratum_faults(erratum: Erratum) -> Iterator[tuple[str, str, str]]:
    """Yield what an erratum says twice, or not at all: its texts stand in the table or follow from an edition."""
    for field in ("printed", "corrected"):
        text = getattr(erratum, field)
        if text and erratum.edition:
            yield field, text, f"nothing, since it follows from {erratum.edition}"
        if not text and not erratum.edition:
            yield field, text, "what stands there, or should; or an edition that says so"


def _measure_faults(case: Case, quantity: str, text: str) -> Iterator[tuple[str, str, str]]:
    """Yield field, value and expectation of every fault of a measure in the table of designs."""
    if quantity not in case.quantities:
        yield "measures", quantity, "a quantity declared in quantities.csv"
        return
    designs = (*case.paper.designs, *case.paper.runs)
    for design in [held_against(text), *(word.partition("=")[0] for word in text.split() if "=" in word)]:
        if design and design not in designs:
            yield "measures", design, one_of(design, designs)
            return
    named = [measure_of(case, text, name) for name in designs]
    for name in filter(None, named):
        if name not in case.quantities:
            yield "measures", name, "a quantity declared in quantities.csv"
            return
    units = {case.quantities[name].unit for name in named if name and name != quantity}
    if units != {case.quantities[quantity].unit}:
        yield "measures", text, f"quantities of designs or runs in {case.quantities[quantity].unit}"


def measure_of(case: Case, text: str, design: str) -> str:
    """Return the quantity that a measure of paper.toml has for a design or run; empty where it has none.

    A design ``point_1`` is looked for as ``point.1`` too.
    """
    _, *words = text.split()
    names = {name: quantity for name, equals, quantity in (word.partition("=") for word in words) if equals}
    if names:
        return names.get(design, "")
    measures = (word.replace("{}", name) for word in words for name in (design, design.replace("_", ".")))
    return next((name for name in measures if name in case.quantities), "")


def held_against(text: str) -> str:
    """Return the design that the others of a measure are held against; empty where it is the printed one."""
    first = text.split()[1]
    return "" if "{}" in first else first


def _refuse_first(faults: Iterable[tuple[str, object, str]], file: str, row: int | None) -> None:
    for field, value, expected in faults:
        raise InputError(file=file, row=row, field=field, value=value, expected=expected)


def _recorded_faults(recorded: Toleranced) -> Iterator[tuple[str, str, str]]:
    """Yield field, value and expectation of every fault of a value on record; nan stands for what is undecided."""
    if recorded.value == "nan" and recorded.class_ == "exact":
        return
    try:
        finite = math.isfinite(double(recorded.value))
    except InputError:
        finite = False
    if not finite:
        yield "value", recorded.value, "a finite number"
        return
    relative, absolute = PrintedNumber(recorded.relative).value, PrintedNumber(recorded.absolute).value
    if relative < 0 or absolute < 0:
        yield "relative", f"{recorded.relative}, {recorded.absolute}", "tolerances of at least 0"
    if recorded.class_ == "exact" and (relative or absolute):
        yield "class", "exact", "both tolerances 0, or another class"
    if recorded.class_ in ("sampled", "floor", "enclosed") and not absolute:
        yield "absolute", recorded.absolute, f"more than 0, since the class is {recorded.class_}"
    if recorded.class_ == "rounding" and not (relative or absolute):
        yield "relative", recorded.relative, "a tolerance, or the class exact"
    if recorded.class_ == "floor" and (float(recorded.value) != 0 or relative):
        yield "value", recorded.value, "0 with an absolute tolerance alone, since the class is floor"
