"""Write the page of a paper from its tables and result files alone."""

import sys
from collections.abc import Mapping, Sequence

from gainsay.report import PaperResults, read_results, write_paper
from gainsay.results.listing import write_listing
from gainsay.steps.campaign import gathered_digests
from gainsay.steps.closure import PAPER_MODULES, sources
from gainsay.steps.command import step_command
from gainsay.steps.modules import paper_module
from gainsay.tables import Case


def figure_runs(case: Case) -> Mapping[str, Sequence[str]] | None:
    """Return the runs that each figure of a paper is drawn from, or None where its module cannot say."""
    try:
        return {figure.name: figure.runs for figure in paper_module(case, "figures").FIGURES}
    except Exception:  # a paper's broken module must not cost the page; its step has said what broke
        return None


def results_of(case: Case) -> PaperResults:
    """Return all that pages say of a paper."""
    code = {file for step in PAPER_MODULES for file in sources(case.root, step, case.name)}
    return read_results(case, figure_runs(case), sorted(code), gathered_digests(case))


def page(case: Case) -> None:
    """Write index.html of a paper."""
    found = results_of(case)
    write_paper(found)
    write_listing(case.results / "parts" / "page.files.csv", case.results, {"index.html": ""})
    for lost in found.missing:
        print(f"{case.name}  page        {lost}")


if __name__ == "__main__":
    sys.exit(step_command(page, __doc__))
