"""What the steps made of tasks share: synthesis and audit."""

from importlib import import_module

from gainsay.proof import check
from gainsay.proof.build import accepted
from gainsay.tables import Case
from gainsay.tables.results import Results, run_tasks


def run_step(case: Case, step: str) -> None:
    """Run every task of a paper's module named as the step; one that breaks leaves a failed record, the others run."""
    results = Results(case, step, verify=lambda certificate: accepted(certificate) or check(certificate, case))
    tasks = ()
    with results.task(step, "import", quiet=True):
        tasks = import_module(f"papers.{case.name}.{step}").TASKS
    run_tasks(results, tasks)
