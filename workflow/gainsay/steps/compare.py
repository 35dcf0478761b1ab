"""Hold a paper's results against what it publishes and against the record; succeeds whatever comes out."""

import sys

from gainsay.errors import one_line
from gainsay.results.listing import write_listing
from gainsay.steps.command import step_command
from gainsay.steps.editions import with_texts
from gainsay.tables import Case
from gainsay.tables.files import Table, write_csv
from gainsay.verdicts.differences import DIFFERENCE_COLUMNS, differences
from gainsay.verdicts.errata import errata_table
from gainsay.verdicts.published import PUBLISHED_COLUMNS, published_rows


def compared(case: Case) -> dict[str, Table]:
    """Return the published numbers of a paper and what differs from the record, as tables by the name of their file."""
    published = [[row[column] for column in PUBLISHED_COLUMNS] for row in published_rows(case)]
    return {
        "published": (PUBLISHED_COLUMNS, published),
        "differences": (DIFFERENCE_COLUMNS, [list(row) for row in differences(case)]),
    }


def _with_texts(case: Case) -> Case:
    """Return the case with the texts of its errata, those of statements empty where its modules do not say."""
    try:
        return with_texts(case)
    except Exception as error:  # a paper's broken module costs the texts, which `differences` then misses
        print(f"{case.name}  compare     errata of statements: {one_line(str(error))}")
        return case


def compare(case: Case) -> None:
    """Write the errata, and what `compared` finds (only a header where nothing differs)."""
    errata = errata_table(_with_texts(case))
    write_csv(case.results / "errata.csv", *errata)  # what differs from the record is read from it
    tables = {**compared(case), "errata": errata}
    for name, (columns, rows) in tables.items():
        write_csv(case.results / f"{name}.csv", columns, rows)
    listing = case.results / "parts" / "compare.files.csv"
    write_listing(listing, case.results, {f"{name}.csv": "" for name in tables})
    published, differing = (len(tables[name][1]) for name in ("published", "differences"))
    print(f"{case.name}  compare     {published} published numbers, {differing} differences from the record")


if __name__ == "__main__":
    sys.exit(step_command(compare, __doc__))
