"""The values on record: `make record` writes them and nothing else does."""

from collections.abc import Iterator

from gainsay.tables import Case
from gainsay.tables.files import write_csv
from gainsay.tables.models import Recorded
from gainsay.verdicts.differences import rows_of

#: by step, what two machines may differ by: relative, absolute, reason; rows on record keep their own
DEFAULTS = {
    "audit": ("1e-7", "1e-10", "double precision across machines"),
    "synthesis": ("1e-4", "1e-9", "accuracy of a solver's optimum across machines"),
    "simulation": ("1e-6", "1e-9", "error-controlled integration across machines"),
}


def record_paper(case: Case) -> Iterator[str]:
    """Write recorded.csv of a paper from its results, keeping tolerances, and yield a line for every change."""
    found = {row["quantity"]: row for row in rows_of(case.results / "quantities.csv", case.root)}
    lines, rows = [], []
    for quantity, declared in case.quantities.items():
        before = case.recorded.get(quantity)
        if quantity not in found:
            if before is not None:
                lines.append(f"{quantity}: {before.value} -> not computed, taken off the record")
            continue
        value = found[quantity]["value"]
        if before is None:
            tolerances = DEFAULTS[declared.step]
            lines.append(f"{quantity}: new, {value} {declared.unit}")
        else:
            tolerances = (before.relative, before.absolute, before.reason)
            if before.value != value:
                lines.append(f"{quantity}: {before.value} -> {value} {declared.unit}")
        rows.append((quantity, value, declared.unit, *tolerances))
    write_csv(case.folder / "recorded.csv", tuple(Recorded.model_fields), rows)
    yield from lines
    yield f"{len(rows)} quantities on record, {len(lines)} changed"
