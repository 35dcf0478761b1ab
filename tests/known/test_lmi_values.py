"""Optimal values known from outside: Lovasz theta of graphs, eigenvalue sums, Chebyshev, textbook Schur complements.

Every right value has a closed form, or comes by another way, named beside it.
"""

from itertools import combinations

import numpy as np
import pytest

from gainsay.lmi import (
    BlockMatrix,
    Infeasible,
    Infimum,
    Program,
    affine,
    diagonal,
    equal,
    infimum,
    matrix,
    scalar,
    solve,
    sym,
    symmetric,
    trace,
)
from gainsay.systems.norms import hinf_norm

ROOT5 = np.sqrt(5)


def theta(n, edges):
    """Lovasz's theta: max <J, X> with X >= 0, trace 1, zero on the edges (Lovasz 1979, theorem 4)."""
    X = symmetric("X", n)
    zero = [equal(X[i, j], 0.0, f"{i}-{j}") for i, j in edges]
    return Program(minimise=-trace(np.ones((n, n)) @ X), subject_to=[X >= 0, equal(trace(X), 1.0, "trace"), *zero])


def cycle(n):
    return [(i, (i + 1) % n) for i in range(n)]


def petersen():
    pairs = list(combinations(range(5), 2))
    return [(i, j) for i, j in combinations(range(10), 2) if not set(pairs[i]) & set(pairs[j])]


def odd_cycle(n):
    # Lovasz 1979, corollary 5: n cos(pi/n) / (1 + cos(pi/n))
    return n * np.cos(np.pi / n) / (1 + np.cos(np.pi / n))


@pytest.mark.parametrize(
    ("name", "n", "edges", "right"),
    [
        ("C3", 3, cycle(3), 1.0),  # complete: clique cover number 1
        ("C5", 5, cycle(5), ROOT5),  # Lovasz 1979, theorem 2
        ("C7", 7, cycle(7), odd_cycle(7)),
        ("C9", 9, cycle(9), odd_cycle(9)),
        ("C4", 4, cycle(4), 2.0),  # perfect: stability number
        ("C6", 6, cycle(6), 3.0),  # perfect
        ("Petersen", 10, petersen(), 4.0),  # Lovasz 1979: theta of the Kneser graph K(5,2) is binom(4,1)
        ("empty", 4, [], 4.0),  # no edge: n
        ("K5", 5, list(combinations(range(5), 2)), 1.0),  # complete
        ("K33", 6, [(i, j) for i in range(3) for j in range(3, 6)], 3.0),  # bipartite, perfect
        ("star", 5, [(0, i) for i in range(1, 5)], 4.0),  # perfect: the leaves
        ("W5", 6, [*cycle(5), *((5, i) for i in range(5))], ROOT5),  # a wheel: the larger of theta(C5) and 1
    ],
)
def test_theta_of_known_graphs(name, n, edges, right):
    found = infimum(theta(n, edges))
    assert isinstance(found, Infimum)
    assert found.lower <= -right * (1 - 1e-14) and found.upper >= -right * (1 + 1e-14)
    assert found.value == pytest.approx(-right, rel=1e-6)
    assert found.width < 1e-5


A4 = np.array([[2.0, -1, 0, 0], [-1, 2, -1, 0], [0, -1, 2, -1], [0, 0, -1, 2]])
# eigenvalues of the second difference: 2 - 2 cos(k pi / 5), textbook
A4_VALUES = 2 - 2 * np.cos(np.arange(1, 5) * np.pi / 5)
x, t, g = scalar("x"), scalar("t"), scalar("g")
P, Y = symmetric("P", 4), matrix("Y", 1, 4)
H2 = np.array([[0.0, 1.0], [1.0, 0.0]])


def _square():
    # Schur complement: [[t, x], [x, 1]] >= 0 is t >= x^2; with x >= 3 the least t is 9 (Boyd et al. 1994, 2.1)
    block = t * np.diag([1.0, 0]) + x * H2 + np.diag([0, 1.0])
    return Program(minimise=t, subject_to=[affine(block) >= 0, (x >= 3).named("x")])


def _geometric():
    # x y >= 4, least x + y = 4 (inequality of the means)
    y = scalar("y")
    return Program(minimise=x + y, subject_to=[x * np.diag([1.0, 0]) + y * np.diag([0, 1.0]) + 2 * H2 >= 0])


def _lyapunov():
    # least trace of P with A'P + PA + I <= 0: A = -A4 gives P = A4^-1 / 2, trace sum 1/(2 lambda)
    return Program(minimise=trace(P), subject_to=[(sym(-A4 @ P) + np.eye(4) <= 0).named("Lyapunov")])


def _maxcut(n, edges):
    X = symmetric("X", n)
    L = np.zeros((n, n))
    for i, j in edges:
        L[i, i] += 1
        L[j, j] += 1
        L[i, j] -= 1
        L[j, i] -= 1
    one = [equal(X[i, i], 1.0, f"x{i}") for i in range(n)]
    return Program(minimise=-0.25 * trace(L @ X), subject_to=[X >= 0, *one])


def _fantope(k):
    # sum of the k largest eigenvalues: max <A, X>, 0 <= X <= I, trace k (Overton, Womersley 1992)
    return Program(minimise=-trace(A4 @ P), subject_to=[P >= 0, (P <= np.eye(4)).named("I"), equal(trace(P), k, "k")])


def _hyperbola(size):
    # x y >= size^2, least 3 x + 2: as near to 2 as one likes, and never there
    y = scalar("y")
    block = x * np.diag([1.0, 0]) + y * np.diag([0, 1.0]) + size * H2
    return Program(minimise=3 * x + 2, subject_to=[block >= 0])


def _gap(size, slope, T):
    # the first two rows of [[0, a x, 0], [a x, y, 0], [0, 0, a x + s]] force x = 0; its dual has the value -s / a
    y = scalar("y")
    unit = np.zeros((3, 3))
    unit[0, 1] = unit[1, 0] = unit[2, 2] = slope
    block = size * np.diag([0, 0, 1.0]) + x * unit + y * np.diag([0, 1.0, 0])
    return Program(minimise=x, subject_to=[T.T @ block @ T >= 0])


def _nuclear():
    # norm of the (1, 4) matrix b: [[t, b], [b', t I]] >= 0, least t = |b|
    b = np.array([[3.0, 0, 4.0, 12.0]])
    block = np.zeros((5, 5))
    block[:1, 1:] = b
    block[1:, :1] = b.T
    return Program(minimise=t, subject_to=[t * np.eye(5) + block >= 0])


def _diagonal_scaling():
    # least trace D with D - J >= 0, D diagonal, J of ones, n = 4: D = 4 I, trace 16 (the dual has X_ii = 1, X = J)
    D = diagonal("D", 4)
    return Program(minimise=trace(D), subject_to=[D - np.ones((4, 4)) >= 0])


def _h2():
    # H2 norm squared of 1/(s + a), a = 3: 1/(2 a)
    q = scalar("q")
    return Program(minimise=q, subject_to=[(-6 * q + 1 <= 0).named("Gramian")])


def _hinf():
    # bounded real lemma of 5/(s + 2): norm 2.5 squared
    p = scalar("p")
    block = p * np.array([[4.0, -1], [-1, 0]]) + g * np.diag([0, 1.0]) - np.diag([25.0, 0])
    return Program(minimise=g, subject_to=[block > 0, (p > 0).named("p")])


def _interpolation():
    # largest third entry of a correlation matrix with two correlations cos(a), cos(b): cos(a - b) (Olkin 1981)
    X = symmetric("X", 3)
    held = [equal(X[i, i], 1.0, f"d{i}") for i in range(3)]
    held += [equal(X[0, 1], np.cos(0.3), "a"), equal(X[1, 2], np.cos(0.5), "b")]
    return Program(minimise=-X[0, 2], subject_to=[X >= 0, *held])


KNOWN = {
    "largest eigenvalue": (lambda: Program(minimise=t, subject_to=[t * np.eye(4) - A4 >= 0]), A4_VALUES[-1]),
    "least eigenvalue": (lambda: Program(minimise=-t, subject_to=[A4 - t * np.eye(4) >= 0]), -A4_VALUES[0]),
    "condition number, scaled": (
        lambda: Program(
            minimise=t, subject_to=[(x * A4 >= np.eye(4)).named("l"), (x * A4 <= t * np.eye(4)).named("u")]
        ),
        A4_VALUES[-1] / A4_VALUES[0],
    ),
    "square": (_square, 9.0),
    "means": (_geometric, 4.0),
    "Lyapunov": (_lyapunov, float((0.5 / A4_VALUES).sum())),
    # Goemans, Williamson 1995: the relaxation of an odd cycle is n (1 + cos(pi/n)) / 2; bipartite graphs are exact
    "max cut C5": (lambda: _maxcut(5, cycle(5)), -5 * (1 + np.cos(np.pi / 5)) / 2),
    "max cut C4": (lambda: _maxcut(4, cycle(4)), -4.0),
    "max cut K3": (lambda: _maxcut(3, cycle(3)), -2.25),
    "two largest eigenvalues": (lambda: _fantope(2.0), -A4_VALUES[-2:].sum()),
    "three largest eigenvalues": (lambda: _fantope(3.0), -A4_VALUES[-3:].sum()),
    "norm of (3, 4, 12)": (_nuclear, 13.0),
    "diagonal above ones": (_diagonal_scaling, 16.0),
    "H2 norm squared": (_h2, 1 / 6),
    "H-infinity norm squared": (_hinf, 6.25),
    "correlation": (_interpolation, -np.cos(0.2)),
    "duality gap": (lambda: _gap(1.0, 1.0, np.eye(3)), 0.0),
    "duality gap, large": (lambda: _gap(1e4, 1e-3, np.eye(3)), 0.0),
    "duality gap, in other coordinates": (
        lambda: _gap(1e-4, 1e-3, np.array([[1.0, 2, 0], [0, 1, -1], [1, 0, 1]])),
        0.0,
    ),
    "not attained": (lambda: _hyperbola(1.0), 2.0),
    "not attained, far": (lambda: _hyperbola(1e6), 2.0),
    # linear programs: vertices by hand
    "vertex": (
        lambda: Program(minimise=-x - t, subject_to=[(2 * x + t <= 4).named("a"), (x + 3 * t <= 6).named("b")]),
        -2.8,
    ),
}


@pytest.mark.parametrize("name", KNOWN)
def test_known_value(name):
    build, right = KNOWN[name]
    found = infimum(build())
    assert isinstance(found, Infimum)
    assert found.lower <= right + 1e-14 * abs(right) and found.upper >= right - 1e-14 * abs(right)
    assert found.value == pytest.approx(right, rel=1e-6, abs=1e-9)


def bounded_real(n, seed):
    """Least g with the H-infinity norm below sqrt(g), a random stable plant of order n with one input and output."""
    rng = np.random.default_rng(seed)
    A = rng.standard_normal((n, n))
    A -= (np.linalg.eigvals(A).real.max() + 0.1) * np.eye(n)
    B, C = rng.standard_normal((n, 1)), rng.standard_normal((1, n))
    P, g = symmetric("P", n), scalar("g")
    F = BlockMatrix("bounded real", "state", "input")
    F["state", "state"], F["state", "input"], F["input", "input"] = sym(A.T @ P) + C.T @ C, P @ B, -g * np.eye(1)
    return (A, B, C), Program(minimise=g, subject_to=[F < 0, (P > 0).named("P")])


@pytest.mark.parametrize("seed", range(4))
def test_hinf_norms_of_random_plants_are_enclosed(seed):
    plant, program = bounded_real(6, seed)
    # by the Hamiltonian's imaginary eigenvalues and level sets, without any inequality (Boyd, Balakrishnan 1990)
    peak = hinf_norm(*plant)[0] ** 2
    found = infimum(program)
    assert isinstance(found, Infimum)
    assert found.lower <= peak * (1 + 1e-9) and found.upper >= peak * (1 - 1e-9)
    assert found.upper - found.lower < 0.05 * peak


def test_a_level_little_below_the_hinf_norm_is_refuted():
    # 1 / (s^2 + 2 z s + 1) peaks at 1 / (2 z sqrt(1 - z^2)): a closed form
    z = 0.3
    A, B, C = np.array([[0.0, 1], [-1, -2 * z]]), np.array([[0.0], [1]]), np.array([[1.0, 0]])
    P = symmetric("P", 2)
    for part in (1e-1, 1e-2, 1e-3, 1e-4):
        g = (1 - part) / (4 * z**2 * (1 - z**2))
        F = BlockMatrix("bounded real", "state", "input")
        F["state", "state"], F["state", "input"] = sym(A.T @ P) + C.T @ C, P @ B
        F["input", "input"] = affine(-g * np.eye(1))
        assert isinstance(solve(Program(subject_to=[F < 0, (P > 0).named("P")])), Infeasible)


def test_multipliers_on_a_face_are_none_of_the_program():
    # those of the whole program say -1 and no more: the gap of the dual
    found = infimum(_gap(1.0, 1.0, np.eye(3)))
    assert found.multipliers == {} and found.lower == pytest.approx(0, abs=1e-9)
    assert set(found.solved.values) == {"x", "y"}
