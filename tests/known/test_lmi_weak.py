"""Programs whose points lie on a face of the cones, or would: weakly infeasible ones, and ones without interior.

The right outcome of each is an argument of a line or the construction of its source; faces are checked in fractions.
"""

from fractions import Fraction

import numpy as np
import pytest

from gainsay.lmi import (
    Infeasible,
    Program,
    Solved,
    Undecided,
    affine,
    equal,
    facial,
    scalar,
    scaling,
    solve,
    solving,
    symmetric,
    threshold,
    trace,
    within,
)
from gainsay.lmi.exposing import exact_faces

x, y = scalar("x"), scalar("y")
H = np.array([[0.0, 1.0], [1.0, 0.0]])
E1, E2 = np.diag([1.0, 0.0]), np.diag([0.0, 1.0])
T4 = np.array([[1.0, 2, 0, -1], [0, 1, 1, 0], [1, 0, 2, 1], [0, -1, 0, 1]])


def fractions_of(matrix):
    return [[Fraction(int(v.p), int(v.q)) for v in row] for row in matrix.tolist()]


def product(A, B):
    return [[sum(a * b for a, b in zip(row, column, strict=True)) for column in zip(*B, strict=True)] for row in A]


def inner(matrix, block):
    return sum(
        v * Fraction(float(b)) for row, line in zip(matrix, block, strict=True) for v, b in zip(row, line, strict=True)
    )


def assert_exact(scaled, face):
    """Every unknown cancels, the value is what is said, and cores have positive pivots: all in fractions."""
    sums, value = [Fraction(0)] * len(scaled.cost), Fraction(0)
    for tensor, constant, frame, core in zip(scaled.tensors, scaled.constants, face.frames, face.cores, strict=True):
        if core is None:
            continue
        if tensor.ndim == 2:
            places = range(len(constant)) if frame is None else frame
            weights = [Fraction(int(v.p), int(v.q)) for v in core]
            assert frame is None or all(w > 0 for w in weights)
            sums = [
                s + sum(w * Fraction(float(tensor[i, k])) for w, i in zip(weights, places, strict=True))
                for k, s in enumerate(sums)
            ]
            value += sum(w * Fraction(float(constant[i])) for w, i in zip(weights, places, strict=True))
            continue
        U, M = fractions_of(frame), fractions_of(core)
        Z = product(product(U, M), list(zip(*U, strict=True)))
        sums = [s + inner(Z, tensor[:, :, k]) for k, s in enumerate(sums)]
        value += inner(Z, constant)
        for i in range(len(M)):  # elimination without pivoting: M is positive if and only if all pivots are
            assert M[i][i] > 0
            for j in range(i + 1, len(M)):
                ratio = M[j][i] / M[i][i]
                M[j] = [a - ratio * b for a, b in zip(M[j], M[i], strict=True)]
    assert not any(sums)
    assert value == Fraction(int(face.value.p), int(face.value.q))


@pytest.fixture
def checked_faces(monkeypatch):
    """Every face that a solve meets is checked."""
    met, plain = [], solving.exact_faces

    def checked(scaled, *rest):
        for face in plain(scaled, *rest):
            assert_exact(scaled, face)
            met.append(face)
            yield face

    monkeypatch.setattr(solving, "exact_faces", checked)
    return met


def symmetric_unit(n, i, j):
    unit = np.zeros((n, n))
    unit[i, j] = unit[j, i] = 1.0
    return unit


def chain(n):
    """The last diagonal entry is zero: its column is, hence all diagonal entries but the first, beside an entry of one.

    Diagonal entries x_0, ..., x_{n-2} are free, entry (i - 1, n - 1) is x_i.
    """
    block = affine(symmetric_unit(n, n - 2, n - 3))
    for i in range(n - 1):
        own = symmetric_unit(n, i, i) + (symmetric_unit(n, i - 1, n - 1) if i else 0)
        block = block + scalar(f"x{i}") * own
    return block


WEAK = {
    # [[x, s], [s, 0]] >= 0 (Ramana 1997), s from small to large
    **{f"two rows, {s:g}": lambda s=s: [affine(x * E1 + s * H) >= 0] for s in (1e-9, 1e-3, 1.0, 1e6, 1e12)},
    # T' F T with T = [[1, 1], [0, 1]]
    "in other coordinates": lambda: [affine(x * np.ones((2, 2)) + np.array([[0.0, 1.0], [1.0, 2.0]])) >= 0],
    "an equality": lambda: [affine(x * E1 + y * H) >= 0, equal(y, 1.0, "y")],
    "an entry held by another row": lambda: [affine(x * E1 + y * H) >= 0, (y >= 2).named("y")],
    # x >= 0, y >= 0 as entries of a list, x + y <= 0: both are zero
    "entries that are zero": lambda: [
        *within(np.array([[1.0], [0.0]]) * x + np.array([[0.0], [1.0]]) * y, np.zeros((2, 1)), np.ones((2, 1)), "list"),
        (x + y <= 0).named("sum"),
        affine(scalar("z") * E1 + x * E2 + H) >= 0,
    ],
    "a hyperbola and its asymptote": lambda: [affine(x * E1 + y * E2 + H) >= 0, (y <= 0).named("y")],
    "a cubic as a sum of squares of parabolas": lambda: [
        # x^3 + 5 = (1, x, x^2) Q (1, x, x^2)': Q_33 = 0, and Q_23 = 1/2 beside it
        affine(symmetric_unit(3, 0, 0) * 5 + symmetric_unit(3, 1, 2) / 2)
        + x * (symmetric_unit(3, 1, 1) - symmetric_unit(3, 0, 2) / 2)
        >= 0
    ],
    **{f"a chain of {n} rows": lambda n=n: [chain(n) >= 0] for n in (3, 4, 5, 6)},
    "a chain of 4 rows in other coordinates": lambda: [T4.T @ chain(4) @ T4 >= 0],
}


@pytest.mark.parametrize("name", WEAK)
def test_no_point_however_near(name, checked_faces):
    outcome = solve(Program(subject_to=WEAK[name]()))
    if isinstance(outcome, Undecided):  # some are refuted by multipliers of their own, rounded or not
        assert len(outcome.faces) > 1 and outcome.reason.startswith("weakly infeasible")
        assert all(face.value == 0 and face.distance == 0 for face in outcome.faces[:-1])
    assert outcome.excluded


@pytest.mark.parametrize("strict", [True, False])
@pytest.mark.parametrize(("size", "refuted", "confined"), [(1.0, False, False), (0.0, None, True), (-1.0, True, False)])
def test_multipliers_say_what_their_value_allows(strict, size, refuted, confined):
    # [[s + x, 0], [0, s - x]] and Z = I: the sum is 2 s for all x; below zero it excludes all x, at zero strict ones
    block = affine(size * np.eye(2)) + x * np.diag([1.0, -1.0])
    program = Program(subject_to=[block > 0 if strict else block >= 0])
    scale, scaled = scaling.exact(program, scaling.first(program))
    face = next(exact_faces(scaled, program.constraints, [np.eye(2)], None))
    assert_exact(scaled, face)
    assert facial.refutes(program, face) is (strict if refuted is None else refuted)
    assert (facial.reduced(program, scale, face) is not None) is confined


def test_multipliers_of_the_program_itself_need_no_faces():
    assert isinstance(solve(Program(subject_to=[(x > 1).named("a"), (x < 0).named("b")])), Infeasible)
    outcome = solve(Program(subject_to=[affine(x * E1 + H) >= 0]))
    assert isinstance(outcome, Undecided) and len(outcome.faces) == 2


def reduced_by(rng, n, steps):
    """Coefficients and right sides of <A_i, X> = b_i, X >= 0, that reduce X in so many steps to a contradiction.

    <A_i, X> with A_i an identity below blocks of steps before, and 0 above for the first: Liu and Pataki, "Exact
    duality in semidefinite programming based on elementary reformulations", SIAM J. Optim. 25 (2015), theorem 1.
    """
    A, b, start = [], [], 0
    for step in range(steps + 1):
        rows = int(rng.integers(1, 3)) if start + 2 * (steps + 1 - step) < n else 1
        M, R = np.zeros((n, n)), rng.integers(-2, 3, (n, n)).astype(float)
        R += R.T
        M[:start], M[:, :start] = R[:start], R[:, :start]
        M[start : start + rows, start : start + rows] = np.eye(rows)
        A.append(M)
        b.append(0.0 if step < steps else -1.0)
        start += rows
    return A, b


def mixed(rng, A, b):
    """Rows mixed by a regular matrix of integers, coordinates by another: a messy instance of a clean one."""

    def regular(size):
        while abs(np.linalg.det(T := rng.integers(-2, 3, (size, size)).astype(float))) < 0.5:
            pass
        return T

    F, T = regular(len(A)), regular(len(A[0]))
    return [T.T @ sum(f * a for f, a in zip(row, A, strict=True)) @ T for row in F], list(F @ b)


def stated(A, b):
    X = symmetric("X", len(A[0]))
    return Program(
        subject_to=[X >= 0, *(equal(trace(a @ X), float(c), f"{i}") for i, (a, c) in enumerate(zip(A, b, strict=True)))]
    )


@pytest.mark.parametrize("n", [3, 4, 5, 6])
@pytest.mark.parametrize("messy", [False, True])
def test_instances_of_liu_and_pataki(n, messy, checked_faces):
    rng = np.random.default_rng(n)
    A, b = reduced_by(rng, n, 1 if n == 3 else 2)
    for _ in range(2):
        R = rng.integers(-2, 3, (n, n))
        A.append((R + R.T).astype(float))
        b.append(float(rng.integers(-3, 4)))
    if messy:
        A, b = mixed(rng, A, b)
    assert solve(stated(A, b)).excluded


@pytest.mark.parametrize("seed", range(6))
def test_the_same_rows_with_a_point_are_not_refuted(seed, checked_faces):
    # X = T^-1 diag(0, Y) T^-T with Y >= 0 satisfies the rows of every step; T is unimodular, so that all is exact
    rng = np.random.default_rng(seed)
    n = int(rng.integers(4, 7))
    A, _ = reduced_by(rng, n, 1)
    A = A[:1]
    kept = n - int(np.trace(A[0]))
    R = rng.integers(-2, 3, (kept, kept)).astype(float)
    X = np.zeros((n, n))
    X[n - kept :, n - kept :] = R @ R.T
    for _ in range(2):
        M = rng.integers(-2, 3, (n, n))
        A.append((M + M.T).astype(float))
    T = np.eye(n)
    for i in range(n - 1):
        T[i] += rng.integers(-1, 2) * T[i + 1]
    back = np.round(np.linalg.inv(T))
    A, X = [T.T @ a @ T for a in A], back @ X @ back.T
    assert isinstance(solve(stated(A, [float(np.sum(a * X)) for a in A])), Solved)


@pytest.mark.parametrize("room", [1e-3, 1e-6, 1e-9, 1e-12])
def test_a_little_room_is_no_face(room):
    # [[x, 1], [1, room]] >= 0 holds for x >= 1 / room
    assert isinstance(solve(Program(subject_to=[affine(x * E1 + H + room * E2) >= 0])), Solved)


def test_a_threshold_at_a_weakly_infeasible_program():
    # [[x, v], [v, 0]] >= 0 has a point at v = 0 alone
    def program(v):
        return Program(subject_to=[x * E1 + v * H >= 0])

    found = threshold(program, infeasible=1.0, feasible=0.0, relative=1e8)  # of 1e-9, near zero
    assert found.feasible == 0 and 0 < found.infeasible < 0.2
