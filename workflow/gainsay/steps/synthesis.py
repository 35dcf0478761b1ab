"""Solve the LMIs of a paper, certify what they say, and write the designs and their gains."""

import sys
from importlib import import_module

from gainsay.proof import check
from gainsay.steps.command import step_command
from gainsay.tables import Case
from gainsay.tables.results import Results, run_tasks


def synthesis(case: Case) -> None:
    """Run every synthesis task of a paper; one that breaks leaves a failed record and the others run."""
    results = Results(case, "synthesis", verify=lambda certificate: check(certificate, case))
    tasks = ()
    with results.task("synthesis", "import", quiet=True):
        tasks = import_module(f"papers.{case.name}.synthesis").TASKS
    run_tasks(results, tasks)


if __name__ == "__main__":
    sys.exit(step_command(synthesis, __doc__))
