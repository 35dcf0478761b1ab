"""What the steps made of tasks share: synthesis and audit."""

from collections.abc import Sequence

from gainsay.proof import check
from gainsay.proof.build import accepted
from gainsay.results import Results, run_tasks
from gainsay.results.tasks import Task
from gainsay.steps.modules import paper_module
from gainsay.tables import Case


def run_step(case: Case, step: str) -> None:
    """Run every task of a paper's module named as the step; one that breaks leaves a failed record, the others run."""
    results = Results(case, step, verify=lambda certificate: accepted(certificate) or check(certificate, case))
    tasks: Sequence[Task] = ()
    with results.task(step, "import", quiet=True):
        tasks = paper_module(case, step).TASKS
    run_tasks(results, tasks)
