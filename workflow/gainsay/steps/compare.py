"""Hold a paper's results against what it publishes and against the record; succeeds whatever comes out."""

import sys

from gainsay.results.listing import write_listing
from gainsay.steps.command import step_command
from gainsay.tables import Case
from gainsay.tables.files import write_csv
from gainsay.verdicts.differences import DIFFERENCE_COLUMNS, differences
from gainsay.verdicts.published import PUBLISHED_COLUMNS, published_rows


def compare(case: Case) -> None:
    """Write published.csv and differences.csv of a paper (only a header where nothing differs)."""
    published, found = published_rows(case), differences(case)
    rows = [[row[column] for column in PUBLISHED_COLUMNS] for row in published]
    write_csv(case.results / "published.csv", PUBLISHED_COLUMNS, rows)
    write_csv(case.results / "differences.csv", DIFFERENCE_COLUMNS, found)
    listing = case.results / "parts" / "compare.files.csv"
    write_listing(listing, case.results, {"published.csv": "", "differences.csv": ""})
    print(f"{case.name}  compare     {len(published)} published numbers, {len(found)} differences from the record")


if __name__ == "__main__":
    sys.exit(step_command(compare, __doc__))
