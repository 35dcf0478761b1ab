"""Join what the steps found, check every certificate again, and give the verdicts."""

import sys

from gainsay.results.listing import write_listing
from gainsay.results.returned import CERTIFICATE_COLUMNS, FAILURE_COLUMNS, PARTS, VERDICT_COLUMNS, read_part
from gainsay.steps.command import step_command
from gainsay.tables import Case
from gainsay.tables.files import Table, write_csv
from gainsay.verdicts.evidence import Evidence
from gainsay.verdicts.judge import contradictions
from gainsay.verdicts.table import outcomes, verdict_rows


def judged(case: Case) -> tuple[dict[str, Table], Evidence]:
    """Return the joined tables of a paper, its certificates with what the checker says, and its verdicts.

    Returns
    -------
    tables : dict of name to (columns, rows)
        By the name of its file.
    evidence : Evidence
    """
    tables: dict[str, Table] = {}
    for part, columns in PARTS.items():
        tables[part] = columns, [[row[column] for column in columns] for row in read_part(case, part)]
    rows, evidence = verdict_rows(case)
    against = [[_step_of(case, name), name, "verdicts", message] for name, message in contradictions(evidence)]
    tables["failures"] = FAILURE_COLUMNS, [*tables["failures"][1], *against]
    tables["certificates"] = (
        CERTIFICATE_COLUMNS,
        [
            *((name, True, sentence) for name, sentence in evidence.certificates.items()),
            *((name, False, reason) for name, reason in evidence.refused.items()),
        ],
    )
    tables["verdicts"] = VERDICT_COLUMNS, [[row[column] for column in VERDICT_COLUMNS] for row in rows]
    return tables, evidence


def _step_of(case: Case, quantity: str) -> str:
    """Return the step that declares a quantity; of one that no table declares a certificate alone speaks."""
    return case.quantities[quantity].step if quantity in case.quantities else "verdicts"


def verdicts(case: Case) -> None:
    """Write what `judged` finds."""
    tables, evidence = judged(case)
    for name, (columns, rows) in tables.items():
        write_csv(case.results / f"{name}.csv", columns, rows)
    files = {f"{table}.csv": "" for table in tables}
    write_listing(case.results / "parts" / "verdicts.files.csv", case.results, files)
    summary = count_verdicts(tables["verdicts"])
    print(f"{case.name}  verdicts    {summary}; {len(evidence.certificates)} certificates checked")


def count_verdicts(verdicts: Table) -> str:
    """Say how many claims a table of verdicts holds, and how they came out."""
    columns, rows = verdicts
    return f"{len(rows)} claims: {outcomes(str(row[columns.index('verdict')]) for row in rows)}"


if __name__ == "__main__":
    sys.exit(step_command(verdicts, __doc__))
