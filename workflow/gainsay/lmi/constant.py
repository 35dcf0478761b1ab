"""What needs no solver: programs without unknowns or without constraints, and constraints without unknowns."""

import numpy as np
from flint import fmpq_mat

from gainsay.exact.rational import to_fmpq
from gainsay.lmi import points, scaling
from gainsay.lmi.outcomes import Farkas, Infeasible, Outcome, Solved, Unbounded
from gainsay.lmi.program import Program, Row


def without_solver(program: Program) -> Outcome | None:
    """Outcome of a program without unknowns, without constraints, or with a false constraint that holds no unknown."""
    for row in program.rows:
        if not row.tensor.any() and not _true(row):
            reason = f"{row.constraint.label!r} is false as it stands"
            return Infeasible(Farkas({row.constraint.label: _witness(row)}, _value(row), 0.0, reason), ())
    if program.size and program.rows:
        return None
    origin = program.values(np.zeros(program.size))
    objective = float(program.objective.constant[0, 0])
    solved = Solved(origin, objective, program.check(origin), 0.0, ())
    if program.cost.any():
        return Unbounded(program.values(-program.cost), solved, ())
    return solved


def _true(row: Row) -> bool:
    whole = scaling.Scaled(np.zeros(0), (row.constant,), (row.tensor[..., :0],))
    return points.prove(whole, [row.constraint], np.zeros(0)) is not None or _exactly(row)


def _exactly(row: Row) -> bool:
    if not row.is_matrix:
        return False
    from gainsay.exact.definite import positive_semidefinite, rational_positive_definite

    exact = fmpq_mat([[to_fmpq(float(v)) for v in line] for line in row.constant])
    return rational_positive_definite(exact) if points.is_strict(row.constraint) else positive_semidefinite(exact)


def _witness(row: Row) -> np.ndarray:
    if row.is_matrix:
        vector = np.linalg.eigh(row.constant)[1][:, 0]
        return np.outer(vector, vector)
    worst = np.abs(row.constant) if row.constraint.__class__.__name__ == "Equal" else -row.constant
    witness = np.zeros(row.size)
    witness[int(np.argmax(worst))] = -np.sign(row.constant[int(np.argmax(worst))])
    return witness


def _value(row: Row) -> float:
    return float(np.sum(_witness(row) * row.constant))
