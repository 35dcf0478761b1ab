"""Join the verdicts of all papers in one table and write the pages from tables and result files alone."""

import argparse
import sys
from collections.abc import Mapping, Sequence
from importlib import import_module
from pathlib import Path

from gainsay.errors import InputError
from gainsay.report import PaperResults, read_results, write_pages
from gainsay.steps.command import CLEAN, refuse
from gainsay.tables import find_root, read_case
from gainsay.tables.files import write_csv
from gainsay.verdicts.table import VERDICT_COLUMNS


def figure_runs(paper: str) -> Mapping[str, Sequence[str]] | None:
    """Return the runs that each figure of a paper is drawn from, or None where its module cannot say."""
    try:
        return {figure.name: figure.runs for figure in import_module(f"papers.{paper}.figures").FIGURES}
    except Exception:  # a paper's broken module must not cost the page; its step has said what broke
        return None


def write_report(root: Path, papers: Sequence[PaperResults]) -> None:
    """Write results/verdicts.csv, results/index.html and the page of each paper."""
    rows = [
        [found.case.name, *(row[column] for column in VERDICT_COLUMNS)]
        for found in papers
        for row in found.verdicts.values()
    ]
    write_csv(root / "results" / "verdicts.csv", ("paper", *VERDICT_COLUMNS), rows)
    write_pages(root, papers)


def main(arguments: Sequence[str] | None = None) -> int:
    """Write the report over the papers named on the command line and return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__, epilog="exit codes: 0 done, 2 bad input")
    parser.add_argument("papers", nargs="+", help="folder names below papers/, such as wan2014")
    parser.add_argument("--root", type=Path, help="project root; default: the project around the current folder")
    options = parser.parse_args(arguments)
    try:
        root = find_root(options.root)
        cases = [read_case(root, paper) for paper in dict.fromkeys(options.papers)]
        papers = [read_results(case, figure_runs(case.name)) for case in cases]
        write_report(root, papers)
    except InputError as error:
        return refuse(error)
    for found in papers:
        for lost in found.missing:
            print(f"{found.case.name}  report      {lost}")
    claims = sum(len(found.verdicts) for found in papers)
    print(f"report      {claims} verdicts of {len(papers)} papers, see results/index.html")
    return CLEAN


if __name__ == "__main__":
    sys.exit(main())
