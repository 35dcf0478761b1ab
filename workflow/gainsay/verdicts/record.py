"""The values on record: `make record` writes them and nothing else does."""

from collections.abc import Iterator

from gainsay.tables import Case
from gainsay.tables.files import write_csv
from gainsay.tables.models import Recorded
from gainsay.verdicts.differences import rows_of

#: tolerance of a quantity that has none of its own yet: what two machines may differ by in rounding
DEFAULT = ("1e-6", "1e-12", "rounding of double precision across machines")


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
            tolerances = DEFAULT
            lines.append(f"{quantity}: new, {value} {declared.unit}")
        else:
            tolerances = (before.relative, before.absolute, before.reason)
            if before.value != value:
                lines.append(f"{quantity}: {before.value} -> {value} {declared.unit}")
        rows.append((quantity, value, declared.unit, *tolerances))
    write_csv(case.folder / "recorded.csv", tuple(Recorded.model_fields), rows)
    yield from lines
    yield f"{len(rows)} quantities on record, {len(lines)} changed"
