"""Join what the steps found, check every certificate again, and give the verdicts."""

import sys
from collections import Counter

from gainsay.results.listing import write_listing
from gainsay.results.returned import CERTIFICATE_COLUMNS, PARTS, VERDICT_COLUMNS, read_part
from gainsay.steps.command import step_command
from gainsay.tables import Case
from gainsay.tables.files import write_csv
from gainsay.verdicts.table import verdict_rows

#: what the step writes below the paper's results
TABLES = (*PARTS, "certificates", "verdicts")


def verdicts(case: Case) -> None:
    """Write the joined tables of a paper, its certificates with what the checker says, and its verdicts."""
    for part, columns in PARTS.items():
        cells = [[row[column] for column in columns] for row in read_part(case, part)]
        write_csv(case.results / f"{part}.csv", columns, cells)
    rows, evidence = verdict_rows(case)
    write_csv(case.results / "certificates.csv", CERTIFICATE_COLUMNS, [
        *((name, True, sentence) for name, sentence in evidence.certificates.items()),
        *((name, False, reason) for name, reason in evidence.refused.items()),
    ])  # fmt: skip
    write_csv(case.results / "verdicts.csv", VERDICT_COLUMNS, [[row[c] for c in VERDICT_COLUMNS] for row in rows])
    files = {f"{table}.csv": "" for table in TABLES}
    write_listing(case.results / "parts" / "verdicts.files.csv", case.results, files)
    counts = Counter(row["verdict"] for row in rows)
    said = ", ".join(f"{counts[verdict]} {verdict}" for verdict in counts)
    print(f"{case.name}  verdicts    {len(rows)} claims: {said}; {len(evidence.certificates)} certificates checked")


if __name__ == "__main__":
    sys.exit(step_command(verdicts, __doc__))
