"""Outcomes known from outside: theorems of alternatives, weak infeasibility, unattained and missing optima.

Each right outcome is a theorem or an argument of one line, named beside it; none comes from a run of ours.
"""

import numpy as np
import pytest

from gainsay.errors import InputError
from gainsay.lmi import (
    BlockMatrix,
    Infeasible,
    Infimum,
    Program,
    Scale,
    Solved,
    Unbounded,
    Undecided,
    affine,
    equal,
    infimum,
    matrix,
    positive,
    scalar,
    solve,
    sym,
    symmetric,
    threshold,
    trace,
)

x, y = scalar("x"), scalar("y")
P, X = symmetric("P", 2), symmetric("X", 3)
H = np.array([[0.0, 1.0], [1.0, 0.0]])
E1, E2 = np.diag([1.0, 0.0]), np.diag([0.0, 1.0])
ROTATION = np.array([[0.3, 1.0], [-1.0, 0.3]])  # eigenvalues 0.3 +- i
T3 = np.array([[3.0, 1, -2], [1, 4, 2], [-1, 2, 5]])
INTEGRATORS = np.array([[0.0, 1.0], [0.0, 0.0]])  # eigenvalue 0, twice


def lyapunov(A):
    P = symmetric("P", len(A))
    return [(sym(A.T @ P) < 0).named("Lyapunov"), (P > 0).named("P > 0")]


def stein(A):
    P = symmetric("P", len(A))
    return [(P - A.T @ P @ A > 0).named("Stein"), (P > 0).named("P > 0")]


def completed(A, dual=False):
    P = symmetric("P", len(A))
    corner = P @ A if dual else A.T @ P
    F = BlockMatrix("Stein", "a", "b")
    F["a", "a"], F["a", "b"], F["b", "b"] = P, corner, P
    return [F > 0]


# Lyapunov 1892, Stein 1952: feasible exactly if the spectrum lies in the open half plane (disk)
INFEASIBLE = {
    "unstable focus": lambda: lyapunov(ROTATION),
    "double integrator": lambda: lyapunov(INTEGRATORS),
    "one unstable, one stable mode": lambda: lyapunov(np.array([[0.1, 2.0], [0.3, -1.7]])),
    "outside the disk": lambda: stein(np.array([[1.1, 0.4], [0.2, 0.3]])),
    "on the circle": lambda: stein(np.eye(2)),
    "outside the disk, as a Schur complement": lambda: completed(np.array([[1.1, 0.4], [0.2, 0.3]])),
    "the same, transposed": lambda: completed(np.array([[1.1, 0.4], [0.2, 0.3]]), dual=True),
    # B does not reach the unstable mode, whatever Y
    "not stabilisable": lambda: [
        sym(np.diag([1.0, -1.0]) @ P + np.array([[0.0], [1.0]]) @ matrix("Y", 1, 2)) < 0,
        (P > 0).named("P > 0"),
    ],
    "opposite signs": lambda: [(P > 0).named("a"), (P < 0).named("b")],
    "trace of a positive matrix": lambda: [P > 0, (trace(P) <= 0).named("trace")],
    "indefinite by a minor": lambda: [x * E1 + 2 * H + E2 > 0, (x <= 3).named("x")],  # x > 4 is needed
    "contradicting equalities": lambda: [P > 0, equal(P[0, 0], 1.0, "a"), equal(P[0, 0], 2.0, "b")],
    # 2x + 2y = 2 + 4e-16 and x + y = 1, as exact numbers
    "equalities that differ in the last digit": lambda: [
        equal(x + y, 1.0, "a"),
        equal(2 * x + 2 * y, 2 + 4e-16, "b"),
        x > 0,
    ],
    "interval of one point, strict": lambda: [(x > 1).named("a"), (x < 1).named("b")],
    "a positive unknown at zero": lambda: [positive("p") <= 0],
    "a positive unknown whose row's name another bears": lambda: [
        (x > 0).named("p > 0"),
        (positive("p") <= -1).named("p"),
    ],
    # [[x, 1], [1, 0]] > 0: its second diagonal entry is not positive
    "zero on the diagonal, strict": lambda: [x * E1 + H > 0],
    # v = (1, -1), (1, 1), (2, -1): v'Bv = 0 and v'Av < 0; all multipliers are multiples of vv', on the edge of the cone
    "a semidefinite coefficient": lambda: [affine(np.array([[-1.0, 1], [1, 2]])) + x * 2 * np.ones((2, 2)) > 0],
    "the same, closed": lambda: [affine(np.array([[0.0, 1], [1, 1]])) + x * 2 * np.ones((2, 2)) >= 0],
    "the same, negative": lambda: [affine(np.array([[-2.0, -1], [-1, 2]])) - x * np.array([[1.0, -1], [-1, 1]]) > 0],
    "the same, of other numbers": lambda: [affine(np.array([[1.0, 1], [1, -1]])) + x * np.outer([1, 2], [1, 2]) > 0],
    # v = (0, 1, 1) after the change of coordinates T: v'Av = 0, which a strict inequality excludes
    "a semidefinite coefficient and a value of zero": lambda: [
        affine(T3.T @ np.array([[0.0, 1, 0], [1, 0, 0], [0, 0, 1]]) @ T3) + x * (T3.T @ np.diag([1.0, 0, 0]) @ T3) > 0
    ],
    # the kernel of the coefficient of x, then that of y on it
    "one kernel inside another": lambda: [
        affine(np.diag([3.0, 2.0, -1.0])) + x * np.diag([1.0, 0, 0]) + y * np.diag([0, 1.0, 0]) > 0
    ],
    # no common quadratic Lyapunov function: A1 A2 has a negative eigenvalue (Shorten, Narendra 2002)
    "no common Lyapunov matrix": lambda: [
        (sym(np.array([[-1.0, 10], [-0.1, -1]]).T @ P) < 0).named("1"),
        (sym(np.array([[-1.0, 0.1], [-10, -1]]).T @ P) < 0).named("2"),
        (P > 0).named("P > 0"),
    ],
}


@pytest.mark.parametrize("name", INFEASIBLE)
def test_infeasible(name):
    assert isinstance(solve(Program(subject_to=INFEASIBLE[name]())), Infeasible)


FEASIBLE = {
    "stable focus": lambda: lyapunov(-ROTATION),
    "inside the disk": lambda: stein(np.array([[0.5, 0.4], [0.2, 0.3]])),
    "inside the disk, as a Schur complement": lambda: completed(np.array([[0.5, 0.4], [0.2, 0.3]])),
    # closed inequalities meet in one point
    "closed pair": lambda: [(P >= 0).named("a"), (P <= 0).named("b")],
    # v = (1, -1): v'Av = 1 > 0, so that x can be large enough
    "a semidefinite coefficient": lambda: [affine(np.array([[-1.0, 0], [0, 2]])) + x * 2 * np.ones((2, 2)) > 0],
    "closed interval of one point": lambda: [(x >= 1).named("a"), (x <= 1).named("b")],
    "rank one by equalities": lambda: [P >= 0, *(equal(P[i, j], 1.0, f"{i}{j}") for i in (0, 1) for j in range(i, 2))],
    "strict interval of width 1e-13": lambda: [(x > 0).named("a"), (x < 1e-13).named("b")],
    # v < x < v (1 + w): the number v (1 + w/2) lies between
    **{
        f"strict interval of relative width {w:g} at {v:g}": lambda v=v, w=w: [
            (x > v).named("a"),
            (x < v * (1 + w)).named("b"),
        ]
        for v in (1e-12, 1.0, 1e12)
        for w in (1e-6, 1e-9, 1e-13)
    },
    # v < P < v (1 + 1e-10) in the order of forms: v (1 + 5e-11) I lies between
    "strict interval of matrices": lambda: [
        (P > 3e4 * np.eye(2)).named("a"),
        (P < 3e4 * (1 + 1e-10) * np.eye(2)).named("b"),
    ],
}


@pytest.mark.parametrize("name", FEASIBLE)
def test_feasible(name):
    assert isinstance(solve(Program(subject_to=FEASIBLE[name]())), Solved)


@pytest.mark.parametrize(
    ("objective", "constraints"),
    [
        (-x, lambda: [x > 0]),
        (-trace(P), lambda: [P > 0]),
        (-x - y, lambda: [x * E1 + y * E2 + H > 0]),
    ],
)
def test_unbounded_has_a_ray_that_holds(objective, constraints):
    program = Program(minimise=objective, subject_to=constraints())
    found = infimum(program)
    assert isinstance(found, Unbounded)
    far = {name: found.solved.values[name] + 1e3 * np.asarray(step) for name, step in found.ray.items()}
    assert program.check(far).holds
    assert program.check(far).objective < found.solved.objective


def test_unbounded_without_a_ray_gets_no_value():
    # [[y, x], [x, 1]] >= 0, least x: y >= x^2 lets x fall, but no fixed direction does
    found = infimum(Program(minimise=x, subject_to=[y * E1 + x * H + E2 >= 0]))
    assert isinstance(found, Undecided | Infimum)
    assert not np.isfinite(getattr(found, "value", np.nan))


def test_infimum_that_is_not_attained():
    # [[x, 1], [1, y]] >= 0, least y: 0 as x grows (Vandenberghe, Boyd 1996)
    found = infimum(Program(minimise=y, subject_to=[x * E1 + H + y * E2 >= 0]))
    assert not isinstance(found, Infeasible | Unbounded)
    if isinstance(found, Infimum):
        assert found.lower <= 0 <= found.upper


def test_duality_gap_is_closed_on_the_face():
    # Vandenberghe, Boyd 1996, section 3: primal 0, dual -1
    block = x * (np.eye(3)[[1, 0, 2]]) + y * np.diag([0, 1.0, 0]) + np.diag([0, 0, 1.0])
    found = infimum(Program(minimise=x, subject_to=[affine(block) >= 0]))
    assert isinstance(found, Infimum)
    assert found.lower <= 0 <= found.upper and found.value == pytest.approx(0, abs=1e-9)


def test_no_unknowns_and_no_constraints():
    assert isinstance(solve(Program(subject_to=[affine([[-1.0]]) > 0])), Infeasible)
    assert isinstance(solve(Program(subject_to=[affine([[0.0]]) > 0])), Infeasible)
    assert isinstance(solve(Program(subject_to=[affine([[0.0]]) >= 0])), Solved)
    assert isinstance(solve(Program(subject_to=[equal(affine([[1.0]]), 0.0, "1 = 0")])), Infeasible)
    assert isinstance(solve(Program()), Solved)
    assert isinstance(infimum(Program(minimise=x)), Unbounded)


@pytest.mark.parametrize("size", [1e-300, 1e-20, 1.0, 1e300])
def test_a_constraint_without_unknowns_beside_others(size):
    # -size >= 0 is false whatever x; an unknown of the objective alone falls without end
    assert isinstance(solve(Program(subject_to=[(affine([[-size]]) >= 0).named("false"), x > 0])), Infeasible)
    assert isinstance(solve(Program(subject_to=[0 * x + affine([[-size]]) >= 0])), Infeasible)
    assert isinstance(solve(Program(subject_to=[equal(affine([[size]]), 0.0, "false"), x > 0])), Infeasible)
    found = infimum(Program(minimise=size * x, subject_to=[y > 0]))
    assert isinstance(found, Unbounded) and found.ray["x"] < 0 and set(found.solved.values) == {"x", "y"}


def test_numbers_too_small_to_be_scaled_are_no_points():
    # [[x, v], [v, 0]] has the determinant -v^2 < 0 whatever x; v^2 is no double
    for v in (1e-170, 1e-250, 5e-324):
        near = {"x": 1e-9 * v}
        assert isinstance(solve(Program(subject_to=[affine(x * E1 + v * H) >= 0]), near), Infeasible | Undecided)


def test_unbounded_where_the_solver_stumbles():
    # G = sum d_i A_i > 0 by construction, along d the objective falls: no finite infimum
    rng = np.random.default_rng(46)
    for n, m in ((9, 18), (5, 7), (12, 20)):
        A = [B + B.T for B in rng.standard_normal((m, n, n))]
        d, root = rng.standard_normal(m), rng.standard_normal((n, n))
        last = (root @ root.T / n + 0.1 * np.eye(n) - sum(s * B for s, B in zip(d[1:], A[1:], strict=True))) / d[0]
        A[0] = (last + last.T) / 2
        unknowns = [scalar(f"x{i}") for i in range(m)]
        block = sum((v * B for v, B in zip(unknowns, A, strict=True)), affine(A[1] + A[2]))
        objective = sum((v * float(-s) for v, s in zip(unknowns, d, strict=True)), affine(0.0))
        assert isinstance(infimum(Program(minimise=objective, subject_to=[block > 0])), Unbounded)


@pytest.mark.parametrize(
    "make",
    [
        lambda: Program(subject_to=["x > 0"]),
        lambda: Program(subject_to=[affine(np.zeros((0, 0))) > 0]),
        lambda: Program(subject_to=[equal(affine(np.zeros((0, 1))), 0, "nothing")]),
        lambda: Program(subject_to=[affine(np.array([[1j]])) > 0]),
        lambda: Program(subject_to=[affine("1") > 0]),
        lambda: Program(subject_to=[x > 0], margin=np.nan),
        lambda: Program(subject_to=[x > 0], margin=-1.0),
        lambda: symmetric("N", 0),
        lambda: matrix("N", -1, 2),
        lambda: solve(Program(subject_to=[x > 0]), rounds=0),
        lambda: infimum(Program(minimise=x, subject_to=[x > 0]), margins=()),
        lambda: infimum(Program(minimise=x, subject_to=[x > 0]), margins=(np.nan,)),
        lambda: infimum(Program(minimise=x, subject_to=[x > 0]), margins=(-1.0,)),
        lambda: Program(subject_to=[0 < x < 1]),  # would keep x < 1 alone
        lambda: Program(subject_to=[x > 0], margin="1e-6"),
        lambda: solve(3),
        lambda: solve(Program(subject_to=[x > 0]), rounds=1.5),
        lambda: solve(Program(subject_to=[P > 0]), near={"P": "one"}),
        lambda: solve(Program(subject_to=[P > 0]), near={"P": 1j * np.eye(2)}),
        lambda: solve(Program(subject_to=[P > 0]), near={"P": np.nan * np.eye(2)}),
        lambda: solve(Program(subject_to=[P > 0], scale=Scale(P="one"))),
        lambda: solve(Program(subject_to=[P > 0], scale=Scale(P=np.inf))),
        lambda: solve(Program(subject_to=[P > 0], scale=Scale(P=-1))),
        lambda: symmetric("N", 2.5),
        lambda: symmetric("N", True),
        lambda: symmetric("N", 10**7),
        lambda: scalar(""),
        lambda: threshold(lambda v: Program(subject_to=[x > v, x < 1]), infeasible=np.nan, feasible=0.0),
        lambda: threshold(lambda v: Program(subject_to=[x > v, x < 1]), infeasible=0.0, feasible=0.0),
        lambda: threshold(lambda v: Program(subject_to=[x > v, x < 1]), infeasible=2.0, feasible=0.0, relative=0.0),
    ],
)
def test_what_is_no_program_is_refused(make):
    with pytest.raises(InputError):
        make()


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_numbers_that_are_none_are_refused(bad):
    with pytest.raises(InputError, match="nan or inf"):
        Program(subject_to=[affine([[bad]]) + x > 0])
