"""One program at many values of a parameter, each solve starting from the scaling of its neighbour."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

from gainsay.errors import InputError
from gainsay.lmi import scaling
from gainsay.lmi.program import Program
from gainsay.lmi.solving import Failed, Infeasible, Solved, solve

Outcome = Solved | Infeasible | Failed


def sweep(build: Callable[[float], Program], values: Iterable[float]) -> Iterator[tuple[float, Outcome]]:
    """Solve `build(value)` for each value.

    Parameters
    ----------
    build : callable
        Program at a parameter value; stating it again costs about a millisecond, the scaling is what is kept.
    values : iterable of float
        In an order in which neighbours are alike.

    Yields
    ------
    tuple of (float, Solved or Infeasible or Failed)
    """
    start = None
    for value in values:
        program = build(value)
        outcome = solve(program, start)
        if isinstance(outcome, Failed) and start is not None:
            outcome = solve(program)
        if isinstance(outcome, Solved):
            start = scaling.from_point(program, program.coordinates(outcome.values))
        yield value, outcome


@dataclass(frozen=True)
class Threshold:
    """Where a program turns from infeasible to feasible.

    Attributes
    ----------
    infeasible, feasible : float
        Last value with a checked Farkas candidate, first value with a checked point.
    solved : Solved
        The point at `feasible`.
    undecided : tuple of float
        Values between the two at which the solver gave neither.
    """

    infeasible: float
    feasible: float
    solved: Solved
    undecided: tuple[float, ...]


def threshold(
    build: Callable[[float], Program], infeasible: float, feasible: float, relative: float = 1e-3
) -> Threshold:
    """Bisect a parameter between an infeasible and a feasible value.

    Parameters
    ----------
    build : callable
        Program at a parameter value, feasible on one side of the threshold only.
    infeasible, feasible : float
        The two ends; either order.
    relative : float, optional
        Width at which to stop, relative to the value; values that stay undecided end the search earlier.

    Raises
    ------
    InputError
        The program at `feasible` has no checked point.
    """
    start, undecided = None, []
    program = build(feasible)
    solved = solve(program)
    if not isinstance(solved, Solved):
        raise InputError("no point at the feasible end", field=program.label, value=feasible)
    inside, outside, floor = feasible, infeasible, infeasible
    while abs(inside - floor) > relative * abs(inside):
        middle = (inside + floor) / 2
        program = build(middle)
        start = scaling.from_point(program, program.coordinates(solved.values))
        outcome = solve(program, start)
        if isinstance(outcome, Solved):
            inside, solved = middle, outcome
        else:
            floor = middle
            if isinstance(outcome, Infeasible):
                outside = middle
            else:
                undecided.append(middle)
    return Threshold(outside, inside, solved, tuple(v for v in undecided if (v - outside) * (inside - v) > 0))
