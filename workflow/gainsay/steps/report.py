"""Join the tables of all papers and write the page over them."""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from gainsay.errors import InputError
from gainsay.report import PaperResults, write_index, write_provenance
from gainsay.results.listing import write_listing
from gainsay.steps.command import CLEAN, broken_off, refuse, whole_streams
from gainsay.steps.holding import hold_as_step
from gainsay.steps.page import results_of
from gainsay.tables import find_root, read_case
from gainsay.tables.contract import README
from gainsay.tables.files import write_atomically, write_csv
from gainsay.verdicts.joined import JOINED, joined


def write_report(root: Path, papers: Sequence[PaperResults]) -> None:
    """Write the joined tables, results/index.html and README.md with the contract version, and the list of them."""
    for table, (columns, rows) in joined([results.case for results in papers]).items():
        write_csv(root / "results" / f"{table}.csv", columns, rows)
    write_index(root, papers)
    write_provenance(root)  # not in the list of files: it is never the same twice
    write_atomically(root / "results" / "README.md", README)
    files = {"README.md": "", "index.html": "", **{f"{table}.csv": "" for table in JOINED}}
    write_listing(root / "results" / "report.files.csv", root / "results", files)


def main(arguments: Sequence[str] | None = None) -> int:
    """Write the report over the papers named on the command line and return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__, epilog="exit codes: 0 done, 2 bad input")
    parser.add_argument("papers", nargs="+", help="folder names below papers/, such as wan2014")
    parser.add_argument("--root", type=Path, help="project root; default: the project around the current folder")
    whole_streams()
    options = parser.parse_args(arguments)
    try:
        root = find_root(options.root)
        cases = [read_case(root, paper) for paper in dict.fromkeys(options.papers)]
        hold_as_step(root)
        papers = [results_of(case) for case in cases]
        write_report(root, papers)
    except InputError as error:
        return refuse(error)
    except OSError as error:
        return broken_off(error)
    for results in papers:
        for lost in results.missing:
            print(f"{results.case.name}  report      {lost}")
    claims = sum(len(results.verdicts) for results in papers)
    print(f"report      {claims} verdicts of {len(papers)} paper{'s'[: len(papers) > 1]}, see results/index.html")
    return CLEAN


if __name__ == "__main__":
    sys.exit(main())
