"""Synthesis against the same LMI handed to Clarabel directly, already assembled and scaled."""

from collections.abc import Iterator
from importlib import import_module

from gainsay.bench.measure import Row, paired
from gainsay.lmi import Solved, backends, scaling, solve
from gainsay.tables import Case


def rows(case: Case) -> Iterator[Row]:
    """Measure the sub-problem of wan2014: built, scaled, solved, every block evaluated again; against one bare solve.

    Raises
    ------
    RuntimeError
        If it is not solved: a broken run is not a measurement.
    """
    state_feedback = import_module("papers.wan2014.statements").state_feedback
    program = state_feedback(case).program()
    outcome = solve(program)
    if not isinstance(outcome, Solved):
        raise RuntimeError("the sub-problem was not solved")
    point = program.coordinates(outcome.values)
    assembled = scaling.apply(program, scaling.from_point(program, point))

    def bare() -> None:
        raw = backends.run(assembled, program.constraints, program.margin)
        if raw.x is None:
            raise RuntimeError(f"bare Clarabel gave no point: {raw.record}")

    yield paired(
        "wan2014: sub-problem, built to checked",
        lambda: state_feedback(case).solve(),
        "one Clarabel call on assembled data",
        bare,
    )
