"""Certified answers against plain cvxpy with Clarabel: random programs up to 60 rows and 300 unknowns."""

from collections.abc import Iterator
from dataclasses import replace
from functools import partial

import numpy as np

from gainsay.bench.measure import Row, paired
from gainsay.bench.random_programs import Drawn, draw
from gainsay.lmi import Infeasible, Infimum, Program, Solved, backends, infimum, scaling, solve
from gainsay.lmi.affine import affine

#: rows and unknowns
_SIZES = ((6, 12), (20, 60), (40, 150), (60, 300))
_AIM = 3.0


def rows() -> Iterator[Row]:
    """Measure feasible and infeasible programs of every size, and minimising ones of all but the largest.

    Raises
    ------
    RuntimeError
        If an answer is not the one known, or not proved: that is not a measurement.
    """
    rng = np.random.default_rng(60)
    _plain(draw(rng, 2, 1, True, 1e-2))  # cvxpy's imports are none of its time
    for size, unknowns in _SIZES:
        runs = 3 if size < 40 else 1
        # a point of the largest takes as long as all others together, and is found the way of the size before
        for feasible in (True, False) if size < _SIZES[-1][0] else (False,):
            drawing = draw(rng, size, unknowns, feasible, 1e-2)
            kind = Solved if feasible else Infeasible
            what = f"{size} rows, {unknowns} unknowns, {'a point' if feasible else 'a refutation'}"

            def ours(drawing: Drawn = drawing, kind: type = kind) -> None:
                if not isinstance(solve(drawing.program), kind):
                    raise RuntimeError(f"{drawing.program.label}: not the known outcome")

            yield paired(what, ours, "plain cvxpy with Clarabel", partial(_plain, drawing), aim=_AIM, runs=runs)
        if size == _SIZES[-1][0]:
            continue  # a minute, and no other way than that of the size before
        least = _bounded(rng, size, unknowns)

        def enclosed(program: Program = least) -> None:
            outcome = infimum(program)
            if not isinstance(outcome, Infimum) or outcome.upper - outcome.lower >= 1e-5 * max(1.0, abs(outcome.upper)):
                raise RuntimeError(f"{program.label}: not enclosed")

        yield paired(
            f"{size} rows, {unknowns} unknowns, an infimum",
            enclosed,
            "plain cvxpy with Clarabel",
            partial(_plain, Drawn(least, True, 0.0)),
            aim=_AIM,
            runs=runs,
        )


def _bounded(rng: np.random.Generator, size: int, unknowns: int) -> Program:
    """A feasible program with an objective that a definite multiplier bounds."""
    program = draw(rng, size, unknowns, True, 1e-2).program
    block = program.constraints[0].expression
    root = rng.standard_normal((size, size))
    weight = root @ root.T / size + np.eye(size)
    cost = {v: np.tensordot(weight, c, 2)[None, None, :] for v, c in block.terms.items()}
    return replace(program, minimise=type(block)(affine(0.0).constant, cost))


def as_stated(program: Program) -> scaling.Scaled:
    """The program in its own coordinates, as a plain user hands it over."""
    return scaling.Scaled(
        program.cost, tuple(row.constant for row in program.rows), tuple(row.tensor for row in program.rows)
    )


def _plain(drawing: Drawn) -> None:
    backends.run(as_stated(drawing.program), drawing.program.constraints, drawing.program.margin, "cvxpy")
