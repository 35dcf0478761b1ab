"""What differs between the results and what is on record."""

from collections.abc import Iterator

from gainsay.results.returned import read_returned
from gainsay.tables import Case
from gainsay.tables.models import Toleranced
from gainsay.verdicts.errata import unsaid
from gainsay.verdicts.record import certificates_of, outcomes_of, reads_of, scan_items, scans_of
from gainsay.verdicts.tolerance import allowed, share

DIFFERENCE_COLUMNS = ("paper", "what", "item", "expected", "found", "note")
Difference = tuple[str, str, str, str, str, str]
#: note of what was computed and is not on record
NEW = "not on record"


def _allowed(recorded: Toleranced) -> str:
    return "exact" if recorded.class_ == "exact" else f"{recorded.class_}: allowed difference {allowed(recorded)!r}"


def _agrees(recorded: Toleranced, text: str) -> bool:
    """Say whether what was found is what is on record: to the letter, or within the tolerance of a number."""
    if text == recorded.value:
        return True
    try:
        return recorded.class_ != "exact" and share(recorded, float(text)) <= 1
    except ValueError:
        return False


def _quantity_differences(case: Case) -> Iterator[Difference]:
    quantities = {row["quantity"]: row for row in read_returned(case.results / "quantities.csv", case.root)}
    for quantity in case.quantities:
        if quantity not in quantities:
            step = case.quantities[quantity].step
            yield case.name, "quantity", quantity, "a value", "", f"the step {step} gives it none; a scan alone is none"
            continue
        recorded, row = case.recorded.get(quantity), quantities[quantity]
        if recorded is None:
            yield case.name, "quantity", quantity, "", row["value"], NEW
            continue
        if not _agrees(recorded, row["value"]):
            yield case.name, "quantity", quantity, recorded.value, row["value"], _allowed(recorded)
        if recorded.class_ == "enclosed" and not (row["lower"] and row["upper"]):
            yield case.name, "quantity", quantity, "an enclosure", "none", "on record by its enclosure"


def scan_differences(case: Case) -> list[Difference]:
    """Hold what the scans of a paper found against the record."""
    return list(_scan_differences(case))


def _scan_differences(case: Case) -> Iterator[Difference]:
    items = {
        (claim, item): text for claim, scan in scans_of(case).items() for item, (text, _) in scan_items(scan).items()
    }
    for key in {**items, **case.recorded_scans}:
        recorded, text = case.recorded_scans.get(key), items.get(key, "")
        what = " ".join(key)
        if recorded is None or not text:
            on_record = "" if recorded is None else recorded.value
            yield case.name, "scan", what, on_record, text, NEW if recorded is None else "not found"
        elif not _agrees(recorded, text):
            yield case.name, "scan", what, recorded.value, text, _allowed(recorded)


def _read_differences(case: Case) -> Iterator[Difference]:
    """Hold what the computations read of what the paper leaves out against the record."""
    reads = reads_of(case)
    for key in {**reads, **case.recorded_reads}:
        recorded = case.recorded_reads[key].how if key in case.recorded_reads else ""
        if reads.get(key, "") != recorded:
            note = "what the paper leaves out and the computation read" if recorded else NEW
            yield case.name, "input", " ".join(key), recorded, reads.get(key, ""), note


def _published_differences(case: Case) -> Iterator[Difference]:
    """Hold how every printed entry and pole came out against the record."""
    found = outcomes_of(case)
    for key in {**found, **case.recorded_published}:
        recorded, (published, verdict) = case.recorded_published.get(key), found.get(key, ("", ""))
        if recorded is None:
            yield case.name, "published", " ".join(key), "", verdict, NEW
        elif (recorded.published, recorded.verdict) != (published, verdict):
            yield case.name, "published", " ".join(key), recorded.verdict, verdict, f"printed as {recorded.published}"


def _statement_differences(case: Case) -> Iterator[Difference]:
    """Hold what each certificate states against the record: one that states something else proves something else."""
    digests = certificates_of(case)
    for name in {**digests, **case.recorded_certificates}:
        recorded = case.recorded_certificates.get(name)
        if name not in digests:
            yield case.name, "certificate", name, "present", "missing", "on record"
        elif recorded is None:
            yield case.name, "certificate", name, "", digests[name], NEW
        elif recorded.formulas != digests[name]:
            yield (
                case.name,
                "certificate",
                name,
                recorded.formulas,
                digests[name],
                "its formulas are not those on record",
            )


def _witness_differences(case: Case) -> Iterator[Difference]:
    quantities = {row["quantity"] for row in read_returned(case.results / "quantities.csv", case.root)}
    certificates = {row["certificate"]: row for row in read_returned(case.results / "certificates.csv", case.root)}
    for name, row in certificates.items():
        if row["accepted"] != "1":
            yield case.name, "certificate", name, "accepted", "refused", row["says"]
    accepted = {name for name, row in certificates.items() if row["accepted"] == "1"}
    for erratum in case.errata.values():
        for witness in erratum.witness.split():
            if witness not in quantities | accepted:
                yield case.name, "erratum", erratum.id, witness, "", "its witness does not exist"
    for erratum in unsaid(case):
        yield case.name, "erratum", erratum.id, erratum.edition, "", "the editions of statements.py do not say so"


def differences(case: Case) -> list[Difference]:
    """Return every difference of a paper: verdicts, quantities, failures, certificates, witnesses, missing files.

    Of a draft, what is not on record yet is no difference.
    """
    rows: list[Difference] = []
    for row in read_returned(case.results / "failures.csv", case.root):
        rows.append((case.name, "failure", f"{row['step']} {row['where']}", "", row["message"], row["task"]))
    verdicts = {row["claim"]: row for row in read_returned(case.results / "verdicts.csv", case.root)}
    for claim in case.claims.values():
        row = verdicts.get(claim.id, {"verdict": "missing", "note": "run the verdicts again", "witness": ""})
        if row["verdict"] != claim.expected or row["verdict"] == "failed":
            rows.append((case.name, "verdict", claim.id, claim.expected, row["verdict"], row["note"] or row["witness"]))
    rows += _quantity_differences(case)
    rows += _witness_differences(case)
    rows += scan_differences(case)
    rows += _read_differences(case)
    rows += _statement_differences(case)
    rows += _published_differences(case)
    wanted = [f"logs/{run}.{ending}" for run in case.paper.runs for ending in ("mcap", "rrd")]
    wanted += [f"figures/{figure}.{ending}" for figure in case.paper.figures for ending in ("svg", "png")]
    for file in wanted:
        if not (case.results / file).is_file():
            rows.append((case.name, "file", file, "present", "missing", ""))
    for design in case.paper.designs:
        if design not in case.designs:
            rows.append((case.name, "design", design, "in designs/", "missing", "found by `gainsay search`"))
    return [row for row in rows if row[-1] != NEW] if case.paper.draft else rows
