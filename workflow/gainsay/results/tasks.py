"""Tasks: the functions of which a step consists."""

from collections.abc import Callable, Iterable
from typing import Protocol, cast

from gainsay.results.writing import Results
from gainsay.tables.case import Case


class Task(Protocol):
    """A function of a paper that computes a part of a step."""

    where: str
    __name__: str

    def __call__(self, case: Case, results: Results, /) -> None:
        """Compute, and hand what was found to the results."""


def task(where: str) -> Callable[[Callable[[Case, Results], None]], Task]:
    """Mark a function as a task of a step; `where` is the equation or item of the paper that it works on."""

    def mark(function: Callable[[Case, Results], None]) -> Task:
        marked = cast(Task, function)
        marked.where = where
        return marked

    return mark


def run_tasks(results: Results, tasks: Iterable[Task]) -> None:
    """Run the tasks of a step one by one, then write what they found."""
    for one in tasks:
        with results.task(one.where, one.__name__):
            one(results.case, results)
    results.close()
