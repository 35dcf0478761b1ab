"""One program at many values of a parameter, each solve starting from the sizes of its neighbour."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from gainsay.errors import InputError
from gainsay.lmi import backends, scaling
from gainsay.lmi.affine import affine
from gainsay.lmi.outcomes import Outcome, Solved, Undecided
from gainsay.lmi.program import Program
from gainsay.lmi.solving import solve

# part of the distance of two ends below which a value counts as zero: halving would go on to the smallest double
_NOTHING = 1e-9


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
    tuple of (float, Solved or Infeasible or Unbounded or Undecided)
    """
    near = None
    for value in values:
        program = build(value)
        outcome = solve(program, near)
        if isinstance(outcome, Undecided) and not outcome.excluded and near is not None:
            outcome = solve(program)
        if isinstance(outcome, Solved):
            near = outcome.values
        yield value, outcome


@dataclass(frozen=True)
class Threshold:
    """Where a program turns from infeasible to feasible.

    Attributes
    ----------
    infeasible, feasible : float
        Last value that is proved infeasible (nan where none is, not even the end given), first with a proved point.
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
        Width at which to stop, relative to the value; near zero, relative to 1e-9 of the distance of the two ends.

    Raises
    ------
    InputError
        The ends are not two finite numbers, the width is not positive, the program at `feasible` has no proved point,
        or that at `infeasible` has one.
    """
    if not (np.isfinite([infeasible, feasible]).all() and infeasible != feasible):
        raise InputError("threshold", value=(infeasible, feasible), expected="two different finite ends")
    if not relative > 0:
        raise InputError("threshold", field="relative", value=relative, expected="above 0")
    undecided = []
    program = build(feasible)
    solved = solve(program)
    if not isinstance(solved, Solved):
        raise InputError("no point at the feasible end", field=program.label, value=feasible)
    far = solve(build(infeasible))
    if isinstance(far, Solved):
        raise InputError("a point at the infeasible end", field=program.label, value=infeasible)
    inside, floor = feasible, infeasible
    outside = infeasible if far.excluded else float("nan")
    nothing = _NOTHING * abs(feasible - infeasible)
    while abs(inside - floor) > relative * max(abs(inside), nothing):
        middle = (inside + floor) / 2
        program = build(middle)
        outcome = solve(program, solved.values)
        if isinstance(outcome, Solved):
            inside, solved = middle, outcome
        else:
            floor = middle
            if outcome.excluded:
                outside = middle
            else:
                undecided.append(middle)
    last = infeasible if np.isnan(outside) else outside
    return Threshold(outside, inside, solved, tuple(v for v in undecided if (v - last) * (inside - v) > 0))


@dataclass(frozen=True)
class Range:
    """Range of a linear expression over a program's feasible set, attained at checked points.

    Attributes
    ----------
    low, high : float
        Values attained; nan where no point passed its check.
    at_low, at_high : dict
        The points.
    """

    low: float
    high: float
    at_low: dict[str, Any]
    at_high: dict[str, Any]


def ranges(
    program: Program, expressions: Iterable[Any], near: dict[str, Any], sides: tuple[int, ...] = (0, 1)
) -> list[Range]:
    """Minimise and maximise linear expressions over one feasible set, which is assembled and scaled once.

    Parameters
    ----------
    program : Program
        Its objective is left aside.
    expressions : iterable of Affine, shape (1, 1)
    near : mapping
        Point inside or nearly so, for the sizes.
    sides : tuple of int
        0 for the lower ends, 1 for the upper ones; an end that is not asked for is nan.
    """
    scale = scaling.from_point(program, program.coordinates(near))
    scaled, spans = scaling.apply(program, scale), []
    for expression in expressions:
        read = affine(expression)
        cost = np.zeros(program.size)
        for variable, coefficient in read.terms.items():
            cost[program.places[variable]] = coefficient[0, 0]
        size = np.abs(cost * scale.unknowns).max(initial=0.0) or 1.0
        ends: list[tuple[float, dict[str, Any]]] = []
        for side, sign in enumerate((1, -1)):
            if side not in sides:
                ends.append((float("nan"), {}))
                continue
            aimed = scaling.Scaled(sign * cost * scale.unknowns / size, scaled.constants, scaled.tensors)
            raw = backends.run(aimed, program.constraints, program.margin)
            values = {} if raw.x is None else program.values(raw.x * scale.unknowns)
            holds = bool(values) and program.check(values).holds
            ends.append((float(read.value(values)[0, 0]), values) if holds else (float("nan"), {}))
        spans.append(Range(ends[0][0], ends[1][0], ends[0][1], ends[1][1]))
    return spans
