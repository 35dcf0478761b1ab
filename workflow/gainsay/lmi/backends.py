"""Solvers behind one call: Clarabel directly, and the same program through cvxpy as a second opinion.

Nothing a solver says is taken as a result: points and multipliers go through `solving` and `duality`, which recompute.
"""

import os
import sys
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from gainsay.lmi.affine import Definite, Entrywise, Equal
from gainsay.lmi.scaling import Scaled


@dataclass(frozen=True)
class Raw:
    """What a solver returned, in scaled coordinates.

    Attributes
    ----------
    x : ndarray or None
        Point, or None where the solver gave none.
    multipliers : tuple of ndarray
        One a constraint: a symmetric matrix for a matrix inequality, a list of entries else.
    primal, dual : float
        Objective values of the solver.
    record : dict
        Solver, status, iterations, seconds, message: for the attempts.
    """

    x: np.ndarray | None
    multipliers: tuple[np.ndarray, ...] = ()
    primal: float = float("nan")
    dual: float = float("nan")
    record: dict = field(default_factory=dict)


SETTINGS = {
    "clarabel": {},
    "clarabel, more regularisation": {
        "static_regularization_constant": 1e-7,
        "dynamic_regularization_eps": 1e-12,
        "iterative_refinement_max_iter": 30,
    },
    "clarabel, short steps": {"max_step_fraction": 0.9, "max_iter": 400},
    "cvxpy": None,
}
#: settings under which Clarabel is called directly
CLARABEL = tuple(name for name, values in SETTINGS.items() if values is not None)


def run(scaled: Scaled, constraints: Sequence, margin: float, setting: str = "clarabel") -> Raw:
    """Solve one scaled program; whatever a solver raises becomes the record of an attempt without a point.

    Parameters
    ----------
    scaled : Scaled
        Program in coordinates.
    constraints : sequence of constraints
        Same order as in `scaled`.
    margin : float
        Subtracted from the diagonal of strict inequalities and from the entries of entrywise ones; a hundredth of it
        from closed ones, so that points come out inside by more than the solver's tolerance.
    setting : str
        Key of `SETTINGS`.
    """
    try:
        with _quiet():
            return (_cvxpy if SETTINGS[setting] is None else _clarabel)(scaled, constraints, margin, setting)
    except (KeyboardInterrupt, SystemExit, MemoryError):
        raise
    except BaseException as error:  # a panic inside Clarabel does not derive from Exception
        message = f"{type(error).__name__}: {error}".splitlines()[0]
        return Raw(None, record={"solver": setting, "status": "raised", "message": message})


# part of the margin asked of closed inequalities
_CLOSED = 0.01


@contextmanager
def _quiet() -> Iterator[None]:
    """Keep what a solver's panic prints off the terminal: it is in the record of the attempt."""
    try:
        sys.stderr.flush()
        kept = os.dup(2)
    except (OSError, ValueError, AttributeError):  # no standard error to keep clean
        yield
        return
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nowhere, 2)
        yield
    finally:
        os.dup2(kept, 2)
        os.close(kept)
        os.close(nowhere)


def _shifted(constraint: object, constant: np.ndarray, margin: float) -> np.ndarray:
    if isinstance(constraint, Definite):
        return constant - (1.0 if constraint.strict else _CLOSED) * margin * np.eye(len(constant))
    return constant - margin if isinstance(constraint, Entrywise) else constant


def _clarabel(scaled: Scaled, constraints: Sequence, margin: float, setting: str) -> Raw:
    import clarabel
    from scipy import sparse

    size = len(scaled.cost)
    order: tuple[list[int], ...] = ([], [], [])
    for number, constraint in enumerate(constraints):
        order[0 if isinstance(constraint, Equal) else 1 if isinstance(constraint, Entrywise) else 2].append(number)
    left, right, cones = [], [], []
    for number in (*order[0], *order[1], *order[2]):
        constraint, tensor = constraints[number], scaled.tensors[number]
        constant = _shifted(constraint, scaled.constants[number], margin)
        if isinstance(constraint, Definite):
            i, j, weight = _triangle(len(constant))
            left.append(-tensor[i, j] * weight[:, None])
            right.append(constant[i, j] * weight)
            cones.append(clarabel.PSDTriangleConeT(len(constant)))
        else:
            left.append(-tensor)
            right.append(constant)
            cone = clarabel.ZeroConeT if isinstance(constraint, Equal) else clarabel.NonnegativeConeT
            cones.append(cone(len(constant)))
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.max_threads = 1  # the order of sums, and so the last digits, must not depend on the machine
    settings.max_iter = 200
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = 1e-11
    for name, value in (SETTINGS[setting] or {}).items():
        setattr(settings, name, value)
    quadratic, rows = sparse.csc_matrix((size, size)), sparse.csc_matrix(np.vstack(left))
    solution = bare_solve(quadratic, scaled.cost, rows, np.concatenate(right), cones, settings)
    x, z = np.array(solution.x), np.array(solution.z)
    multipliers: list[np.ndarray] = [np.zeros(0)] * len(constraints)
    place = 0
    for number in (*order[0], *order[1], *order[2]):
        n = len(scaled.constants[number])
        if isinstance(constraints[number], Definite):
            i, j, weight = _triangle(n)
            part = z[place : place + len(i)] / weight
            whole = np.zeros((n, n))
            whole[i, j] = whole[j, i] = part
            multipliers[number] = whole
            place += len(i)
        else:
            multipliers[number] = z[place : place + n]
            place += n
    record = {
        "solver": setting,
        "status": str(solution.status),
        "iterations": int(solution.iterations),
        "seconds": float(solution.solve_time),
    }
    point = x if np.isfinite(x).all() else None
    return Raw(point, tuple(multipliers), float(solution.obj_val), float(solution.obj_val_dual), record)


def bare_solve(*data: Any) -> Any:
    """Clarabel's solution of assembled data: apart, so that its time can be told."""
    import clarabel

    return clarabel.DefaultSolver(*data).solve()


def _triangle(n: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Rows, columns and weights of the upper triangle, column by column."""
    j, i = np.tril_indices(n)
    return i, j, np.where(i == j, 1.0, np.sqrt(2.0))


def _stated(scaled: Scaled, constraints: Sequence, margin: float) -> tuple[Any, Any, list[Any]]:
    """The program as a user of cvxpy writes it who stacks its coefficients: problem, unknowns, constraints."""
    import cvxpy

    x = cvxpy.Variable(len(scaled.cost))
    held = []
    for constraint, constant, tensor in zip(constraints, scaled.constants, scaled.tensors, strict=True):
        shifted = _shifted(constraint, constant, margin)
        if isinstance(constraint, Definite):
            n = len(constant)
            flat = shifted.ravel() + tensor.reshape(n * n, -1) @ x
            held.append(cvxpy.reshape(flat, (n, n), order="C") >> 0)
        else:
            entries = shifted + tensor @ x
            held.append(entries == 0 if isinstance(constraint, Equal) else entries >= 0)
    return cvxpy.Problem(cvxpy.Minimize(scaled.cost @ x), held), x, held


def status_by(scaled: Scaled, constraints: Sequence, margin: float, solver: str) -> tuple[str, float]:
    """Status and value of a solver of cvxpy, by its name, at its own settings; status "failed" where it breaks."""
    import cvxpy

    problem, _, _ = _stated(scaled, constraints, margin)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            problem.solve(solver=solver)
        except cvxpy.error.SolverError:
            return "failed", float("nan")
    return str(problem.status), float(problem.value if problem.value is not None else "nan")


def _cvxpy(scaled: Scaled, constraints: Sequence, margin: float, setting: str) -> Raw:
    problem, x, held = _stated(scaled, constraints, margin)
    with warnings.catch_warnings(record=True) as messages:  # into the record of the attempt, not onto the terminal
        warnings.simplefilter("always")
        problem.solve(solver="CLARABEL")
    # cvxpy's multiplier of an equality has the other sign
    duals = tuple(
        np.asarray(c.dual_value) * (-1 if isinstance(of, Equal) else 1) for c, of in zip(held, constraints, strict=True)
    )
    stats = problem.solver_stats
    record = {
        "solver": "cvxpy/Clarabel",
        "status": problem.status,
        "iterations": stats.num_iters,
        "seconds": stats.solve_time,
        "warnings": [str(warning.message) for warning in messages],
    }
    return Raw(x.value, duals, float(problem.value), float("nan"), record)
