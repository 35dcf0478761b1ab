"""Write the page of a paper from its tables and result files alone."""

import sys

from gainsay.report import PaperResults, read_results, write_paper
from gainsay.results.listing import write_listing
from gainsay.steps.campaign import gathered_digests
from gainsay.steps.closure import PAPER_MODULES, sources
from gainsay.steps.command import step_command
from gainsay.tables import Case
from gainsay.verdicts.errata import with_results


def results_of(case: Case) -> PaperResults:
    """Return all that pages say of a paper."""
    code = {file for step in PAPER_MODULES for file in sources(case.root, step, case.name)}
    return read_results(with_results(case), sorted(code), gathered_digests(case))


def page(case: Case) -> None:
    """Write index.html of a paper."""
    results = results_of(case)
    write_paper(results)
    write_listing(case.results / "parts" / "page.files.csv", case.results, {"index.html": ""})
    for lost in results.missing:
        print(f"{case.name}  page        {lost}")


if __name__ == "__main__":
    sys.exit(step_command(page, __doc__))
