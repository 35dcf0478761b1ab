"""What differs between the results and what is on record."""

import math
from collections.abc import Iterator
from pathlib import Path

from gainsay.tables import Case
from gainsay.tables.files import read_csv

DIFFERENCE_COLUMNS = ("paper", "what", "item", "expected", "found", "note")
Difference = tuple[str, str, str, str, str, str]


def rows_of(path: Path, root: Path) -> list[dict[str, str]]:
    """Read a results table as dictionaries."""
    header, rows = read_csv(path, root)
    return [dict(zip(header, cells, strict=True)) for _, cells in rows]


def _quantity_differences(case: Case) -> Iterator[Difference]:
    found = {row["quantity"]: row for row in rows_of(case.results / "quantities.csv", case.root)}
    for quantity in case.quantities:
        if quantity not in found:
            yield case.name, "quantity", quantity, "computed", "", "declared in quantities.csv"
            continue
        recorded = case.recorded.get(quantity)
        value = float(found[quantity]["value"])
        if recorded is None:
            yield case.name, "quantity", quantity, "", repr(value), "not on record"
            continue
        allowed = float(recorded.absolute) + float(recorded.relative) * abs(float(recorded.value))
        difference = abs(value - float(recorded.value))
        if not (difference <= allowed) or math.isnan(value):
            yield case.name, "quantity", quantity, recorded.value, repr(value), f"allowed difference {allowed!r}"


def _witness_differences(case: Case) -> Iterator[Difference]:
    quantities = {row["quantity"] for row in rows_of(case.results / "quantities.csv", case.root)}
    certificates = {row["certificate"]: row for row in rows_of(case.results / "certificates.csv", case.root)}
    for name, row in certificates.items():
        if row["accepted"] != "1":
            yield case.name, "certificate", name, "accepted", "refused", row["says"]
    accepted = {name for name, row in certificates.items() if row["accepted"] == "1"}
    for erratum in case.errata.values():
        for witness in erratum.witness.split():
            if witness not in quantities | accepted:
                yield case.name, "erratum", erratum.id, witness, "", "its witness does not exist"


def differences(case: Case) -> list[Difference]:
    """Return every difference of a paper: verdicts, quantities, failures, certificates, witnesses, missing files."""
    found: list[Difference] = []
    for row in rows_of(case.results / "failures.csv", case.root):
        found.append((case.name, "failure", f"{row['step']} {row['where']}", "", row["message"], row["task"]))
    verdicts = {row["claim"]: row for row in rows_of(case.results / "verdicts.csv", case.root)}
    for claim in case.claims.values():
        row = verdicts.get(claim.id, {"verdict": "missing", "note": "run the verdicts again", "witness": ""})
        if row["verdict"] != claim.expected or row["verdict"] == "failed":
            found.append(
                (case.name, "verdict", claim.id, claim.expected, row["verdict"], row["note"] or row["witness"])
            )
    found += _quantity_differences(case)
    found += _witness_differences(case)
    wanted = [f"logs/{run}.{ending}" for run in case.paper.runs for ending in ("mcap", "rrd")]
    wanted += [f"figures/{figure}.{ending}" for figure in case.paper.figures for ending in ("svg", "png")]
    wanted += [f"designs/{design}.json" for design in case.paper.designs]
    for file in wanted:
        if not (case.results / file).is_file():
            found.append((case.name, "file", file, "present", "missing", ""))
    return found
