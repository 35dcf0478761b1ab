"""Hold all results against what is on record and write results/differences.csv (only its header when clean)."""

import sys
from pathlib import Path

from gainsay.errors import InputError
from gainsay.steps.command import CLEAN, refuse
from gainsay.tables import find_root, read_case
from gainsay.tables.files import write_csv
from gainsay.verdicts.differences import DIFFERENCE_COLUMNS, Difference, differences


def write_differences(root: Path, papers: list[str]) -> list[Difference]:
    """Write results/differences.csv for some papers and return its rows."""
    found = [row for paper in papers for row in differences(read_case(root, paper))]
    write_csv(root / "results" / "differences.csv", DIFFERENCE_COLUMNS, found)
    return found


def main() -> int:
    """Write the differences of the papers named; succeeds whatever they are, so that the file stays."""
    try:
        found = write_differences(find_root(), sys.argv[1:])
    except InputError as error:
        return refuse(error)
    print(f"check       {len(found)} differences in {len(sys.argv) - 1} papers, see results/differences.csv")
    return CLEAN


if __name__ == "__main__":
    sys.exit(main())
