"""Programs of known outcome: how many are answered, here and by plain solvers, and how many of the answers are wrong.

A solver's answer is its status, feasible or infeasible, or its value to 1e-5; ours is what is proved.
"""

from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from gainsay.bench.programs import as_stated
from gainsay.bench.random_programs import draws
from gainsay.lmi import (
    Infimum,
    Program,
    Solved,
    affine,
    backends,
    equal,
    infimum,
    scalar,
    solve,
    sym,
    symmetric,
    trace,
)

#: relative to which a value is right
_CLOSE = 1e-5


@dataclass(frozen=True)
class Known:
    """A program that is feasible (True), infeasible (False), or has a known infimum (a number)."""

    program: Program
    right: bool | float


def rows() -> Iterator[str]:
    """A line a family: right, undecided and wrong answers of ours, of Clarabel and of SCS."""
    for name, family in _families():
        told = []
        for who, answer in (("proved", _ours), ("Clarabel", _plain("CLARABEL")), ("SCS", _plain("SCS"))):
            counts = Counter(_judged(answer(known.program), known.right) for known in family)
            told.append(f"{who} {counts['right']}, {counts['undecided']}, {counts['wrong']}")
        yield f"{name + f', {len(family)}':<42} " + "   ".join(told)


def _judged(answer: bool | float | None, right: bool | float) -> str:
    if answer is None:
        return "undecided"
    if isinstance(right, bool) or isinstance(answer, bool):
        return "right" if answer is right else "wrong"
    return "right" if abs(answer - right) <= _CLOSE * max(1.0, abs(right)) else "wrong"


def _ours(program: Program) -> bool | float | None:
    outcome = infimum(program) if program.cost.any() else solve(program)
    if isinstance(outcome, Infimum):
        return outcome.value if np.isfinite(outcome.value) else None
    return True if isinstance(outcome, Solved) else False if outcome.excluded else None


def _plain(solver: str) -> Callable[[Program], bool | float | None]:
    def answer(program: Program) -> bool | float | None:
        # a homogeneous program is as good at any scale, and solvers are at their best at that of one
        homogeneous = not program.cost.any() and not any(row.constant.any() for row in program.rows)
        margin = 1.0 if homogeneous else program.margin
        status, value = backends.status_by(as_stated(program), program.constraints, margin, solver)
        if status in ("optimal", "optimal_inaccurate"):
            return value if program.cost.any() else True
        return False if status in ("infeasible", "infeasible_inaccurate") else None

    return answer


def _families() -> Iterator[tuple[str, list[Known]]]:
    rng = np.random.default_rng(2026)
    yield "random, 2 to 20 rows", [Known(drawing.program, drawing.feasible) for drawing in draws(2026, 40, 20)]
    for outside, name in ((True, "Lyapunov, unstable"), (False, "Lyapunov, stable")):
        yield name, [Known(_lyapunov(rng, outside), not outside) for _ in range(30)]
    yield "theta of cycles (Lovasz 1979)", [_cycle(n) for n in (5, 7, 9, 11)]
    yield "like truss1 of SDPLIB", [_truss()]
    yield "weakly infeasible (Ramana 1997)", [Known(_weak(10.0**k), False) for k in (-3, 0, 3)]


def _lyapunov(rng: np.random.Generator, outside: bool) -> Program:
    n = int(rng.integers(2, 9))
    A = rng.standard_normal((n, n))
    by = (0.1 + rng.random()) * (1 if outside else -1)
    A += (by - np.linalg.eigvals(A).real.max()) * np.eye(n)
    P = symmetric("P", n)
    return Program(subject_to=[(sym(A.T @ P) < 0).named("Lyapunov"), (P > 0).named("P")])


def _cycle(n: int) -> Known:
    """Lovasz's number of an odd cycle is n cos(pi/n) / (1 + cos(pi/n))."""
    X = symmetric("X", n)
    edges = [equal(X[k, (k + 1) % n], 0.0, f"edge {k}") for k in range(n)]
    program = Program(-trace(np.ones((n, n)) @ X), [X >= 0, equal(trace(X), 1.0, "trace"), *edges])
    return Known(program, -n * float(np.cos(np.pi / n) / (1 + np.cos(np.pi / n))))


def _truss() -> Known:
    """Six bars as in truss1 of SDPLIB (Borchers 1999): [[w, b'x], [b'x, s]] >= 0 for each, w <= 1, least s - 2 x_2.

    The bars let x_2 reach 3 sqrt(s), so that the least value is that of s - 6 sqrt(s).
    """
    s, w, x = scalar("s"), scalar("w"), [scalar(f"x{k}") for k in range(1, 5)]
    off, ends = np.array([[0.0, 1.0], [1.0, 0.0]]), w * np.diag([1.0, 0.0]) + s * np.diag([0.0, 1.0])
    bars = (0 * x[0], -x[0], -0.5 * (x[2] + x[3]), -x[2], 0.5 * (x[1] - x[0]), x[1] - x[3])
    held = [(ends + bar * off >= 0).named(f"bar {k}") for k, bar in enumerate(bars)]
    return Known(Program(s - 2 * x[1], [*held, w <= 1]), -9.0)


def _weak(size: float) -> Program:
    x = scalar("x")
    return Program(subject_to=[affine(np.array([[0.0, size], [size, 0.0]])) + x * np.diag([1.0, 0.0]) >= 0])
