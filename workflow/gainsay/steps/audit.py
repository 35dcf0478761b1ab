"""Audit the printed gains of a paper: poles, norms, identities, rounding."""

import sys
from importlib import import_module

from gainsay.proof import check
from gainsay.steps.command import step_command
from gainsay.tables import Case
from gainsay.tables.results import Results, run_tasks


def audit(case: Case) -> None:
    """Run every audit task of a paper; one that breaks leaves a failed record and the others run."""
    results = Results(case, "audit", verify=lambda certificate: check(certificate, case))
    tasks = ()
    with results.task("audit", "import", quiet=True):
        tasks = import_module(f"papers.{case.name}.audit").TASKS
    run_tasks(results, tasks)


if __name__ == "__main__":
    sys.exit(step_command(audit, __doc__))
