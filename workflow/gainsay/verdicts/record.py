"""The values on record: `make record` writes them and nothing else does."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from typing import Any

from gainsay.errors import ComputationError, GainsayError
from gainsay.proof import formulas_digest, read_certificate
from gainsay.results.listing import damage
from gainsay.results.returned import STEPS, read_part, read_returned
from gainsay.scans.outcome import Outcome, outcomes, read_scans
from gainsay.tables import Case
from gainsay.tables.files import cell, write_csv
from gainsay.tables.models import (
    Recorded,
    RecordedCertificate,
    RecordedPublished,
    RecordedRead,
    RecordedScan,
    Toleranced,
    columns,
)
from gainsay.tables.units import with_unit
from gainsay.verdicts.published import entry_rows
from gainsay.verdicts.tolerance import ROUNDING, decimal_above, proposed

#: tables whose rows are named by two columns
_BY_TWO = ("recorded_scans", "recorded_reads", "recorded_published")


def scan_items(scan: Outcome) -> dict[str, tuple[str, bool]]:
    """Return what a scan says of a claim: item -> text of the value, and whether it is a number computed in doubles."""
    holds, fails = (None, None) if scan.boundary is None else (scan.boundary.holds, scan.boundary.fails)
    items = {
        "outcome": (scan.outcome, False),
        "samples": (cell(scan.samples), False),
        "holding": (cell(scan.holding), False),
        "closer": (cell(scan.closer) if scan.closer else "", False),
        "closer_holding": (cell(scan.closer_holding) if scan.closer else "", False),
        "smallest": (cell(scan.least[0]), True),
        "largest": (cell(scan.greatest[0]), True),
        "turns_on": ("" if scan.boundary is None else scan.boundary.input, False),
        "holds_at": (cell(holds), isinstance(holds, float)),
        "fails_at": (cell(fails), isinstance(fails, float)),
    }
    return {item: (text, number) for item, (text, number) in items.items() if text}


def scans_of(case: Case) -> dict[str, Outcome]:
    """Return what the scans that the steps of a paper list as theirs say, by claim."""
    files = {case.results / row["file"] for row in read_part(case, "files") if row["file"].startswith("scans/")}
    return outcomes(case, read_scans(files, case.root))


def certificates_of(case: Case) -> dict[str, str]:
    """Return the digest of what each certificate of a paper states, by its id; the verdicts say which are refused."""
    digests = {}
    for file in sorted({row["file"] for row in read_part(case, "files") if row["file"].startswith("certificates/")}):
        with suppress(GainsayError):
            certificate = read_certificate(case.results / file)
            digests[certificate.id] = formulas_digest(certificate)
    return digests


def _refuse_unfinished(case: Case, rows: Mapping[str, Any]) -> None:
    """Nothing goes on record, and nothing off it, while a computation is broken or missing, or a file of it damaged."""
    failures = read_returned(case.results / "failures.csv", case.root)
    if failures:
        raise ComputationError(case.name, f"{len(failures)} computations failed: nothing was put on record")
    missing = [quantity for quantity in case.quantities if quantity not in rows]
    if missing:
        raise ComputationError(case.name, f"{missing[0]} was not computed: nothing was put on record")
    for step in (*STEPS, "verdicts"):
        for file, how in damage(case.results / "parts" / f"{step}.files.csv", case.results):
            raise ComputationError(case.name, f"{file} of the step {step} is {how}: nothing was put on record")
    for row in read_returned(case.results / "certificates.csv", case.root):
        if row["accepted"] != "1":
            raise ComputationError(case.name, f"certificate {row['certificate']} refused: nothing was put on record")


def _toleranced(before: Toleranced | None, new: tuple[str, str, str, str], width: str) -> tuple[str, str, str, str]:
    """Keep what stands on record; only the width of an enclosure follows the enclosure."""
    if before is None:
        return new
    absolute = width if before.class_ == "enclosed" and width else before.absolute
    return before.class_, before.relative, absolute, before.reason


def _below_floor(before: Toleranced | None, value: str) -> str:
    """Return the value to put on record: what stands there where both lie below the floor, else the one found."""
    if before is not None and before.class_ == "floor" and abs(float(value)) <= float(before.absolute):
        return before.value
    return value


def _quantity_rows(case: Case, quantities: Mapping[str, Mapping[str, str]]) -> Iterator[tuple[tuple[str, ...], str]]:
    for quantity, declared in case.quantities.items():
        before, row = case.recorded.get(quantity), quantities[quantity]
        value, new = _below_floor(before, row["value"]), proposed(row, declared.meaning)
        width = ""
        if row["lower"] and row["upper"] and row["lower"] != row["upper"]:
            width = decimal_above(float(row["upper"]) - float(row["lower"]))
        tolerances = _toleranced(before, new, width)
        line = ""
        if before is None:
            line = f"{quantity}: new, {with_unit(value, declared.unit)}, {tolerances[0]}"
        elif before.value != value:
            line = f"{quantity}: {before.value} -> {with_unit(value, declared.unit)}"
        elif before.absolute != tolerances[2]:
            line = f"{quantity}: width of its enclosure {before.absolute} -> {tolerances[2]}"
        yield (quantity, value, declared.unit, *tolerances), line


def _scan_rows(case: Case) -> Iterator[tuple[tuple[str, ...], str]]:
    exact = ("exact", "0", "0", "a count, or a word")
    rounding = ("rounding", ROUNDING, "0", "rounding of doubles, with a condition of up to a million")
    for claim, scan in scans_of(case).items():
        unit = case.quantities[scan.quantity].unit
        for item, (value, number) in scan_items(scan).items():
            before = case.recorded_scans.get((claim, item))
            value = _below_floor(before, value)
            tolerances = _toleranced(before, rounding if number else exact, "")
            line = "" if before is not None and before.value == value else f"{claim} {item}: {value}"
            yield (claim, item, value, unit if item in ("smallest", "largest") else "1", *tolerances), line


def reads_of(case: Case) -> dict[tuple[str, str], str]:
    """Return how what the paper leaves out entered each quantity: (quantity, parameter) -> ``read`` or ``scanned``.

    Of the quantities that a claim speaks of. What was scanned over was read as well, at every plausible value; what a
    certificate reads counts for all that it concludes on.
    """
    claims = case.claims.values()
    claimed = {c.quantity for c in claims} | {c.published for c in claims if c.comparator == "less_than"}
    rows = sorted(read_part(case, "reads"), key=lambda row: row["how"])  # what was scanned over comes last, and counts
    reads = {(row["quantity"], row["parameter"]): row["how"] for row in rows}
    for file in sorted({row["file"] for row in read_part(case, "files") if row["file"].startswith("certificates/")}):
        with suppress(GainsayError):
            certificate = read_certificate(case.results / file)
            names = [name for name in certificate.data.get("number", {}) if name in case.assumed]
            quantities = {conclusion.quantity for conclusion in certificate.conclusions if conclusion.quantity}
            for key in ((quantity, name) for quantity in quantities for name in names):
                reads.setdefault(key, "read")
    return {key: how for key, how in sorted(reads.items()) if key[0] in claimed}


def _read_rows(case: Case) -> Iterator[tuple[tuple[str, ...], str]]:
    for (quantity, parameter), how in reads_of(case).items():
        before = case.recorded_reads.get((quantity, parameter))
        line = "" if before is not None and before.how == how else f"{quantity}: {parameter} {how}"
        yield (quantity, parameter, how), line


def _certificate_rows(case: Case) -> Iterator[tuple[tuple[str, ...], str]]:
    for certificate, formulas in certificates_of(case).items():
        before = case.recorded_certificates.get(certificate)
        line = ""
        if before is None or before.formulas != formulas:
            line = f"{certificate}: {'new' if before is None else 'states something else'}"
        yield (certificate, formulas), line


def outcomes_of(case: Case) -> dict[tuple[str, str], tuple[str, str]]:
    """Return digits and verdict of every printed entry and pole held against one of ours, by what it is and entry."""
    rows = (row for row in entry_rows(case) if row["verdict"] != "uncheckable")
    return {(row["what"], row["entry"]): (row["published"], row["verdict"]) for row in rows}


def _published_rows(case: Case) -> Iterator[tuple[tuple[str, ...], str]]:
    for key, found in outcomes_of(case).items():
        before = case.recorded_published.get(key)
        same = before is not None and (before.published, before.verdict) == found
        yield (*key, *found), "" if same else f"{' '.join(key)}: {' '.join(found)}"


def record_paper(case: Case) -> Iterator[str]:
    """Write what is on record of a paper from its results, keeping tolerances, and yield a line for every change.

    Raises
    ------
    ComputationError
        While a computation of the paper is broken or missing: nothing is written then.
    """
    quantities = {row["quantity"]: row for row in read_returned(case.results / "quantities.csv", case.root)}
    _refuse_unfinished(case, quantities)
    tables: dict[str, tuple[Sequence[str], list[tuple[Any, str]], Mapping[Any, object]]] = {
        "recorded": (columns(Recorded), list(_quantity_rows(case, quantities)), case.recorded),
        "recorded_scans": (columns(RecordedScan), list(_scan_rows(case)), case.recorded_scans),
        "recorded_reads": (columns(RecordedRead), list(_read_rows(case)), case.recorded_reads),
        "recorded_certificates": (
            columns(RecordedCertificate),
            list(_certificate_rows(case)),
            case.recorded_certificates,
        ),
        "recorded_published": (columns(RecordedPublished), list(_published_rows(case)), case.recorded_published),
    }
    changed = 0
    for name, (header, rows, before) in tables.items():
        write_csv(case.folder / f"{name}.csv", header, [row for row, _ in rows])
        lines = [line for _, line in rows if line]
        kept = {row[:2] if name in _BY_TWO else row[0] for row, _ in rows}
        lines += [
            f"{key if isinstance(key, str) else ' '.join(key)}: off the record" for key in before if key not in kept
        ]
        changed += len(lines)
        yield from lines
    yield f"{len(tables['recorded'][1])} quantities on record, {changed} changes"
