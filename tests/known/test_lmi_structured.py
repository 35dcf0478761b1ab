"""Inequalities of Lyapunov, Stein and regions of poles in a P of any structure: feasible exactly where a theorem says.

Lyapunov 1892 and Stein 1952 for the half plane and the disk, Chilali and Gahinet 1996 (theorem 2.2) for regions: a
positive P exists exactly if all eigenvalues lie inside. A P that is confined to a structure is infeasible where none
exists at all; the feasible draws have a P of the structure by construction.
"""

import numpy as np
import pytest

from gainsay.lmi import (
    BlockMatrix,
    Infeasible,
    Program,
    Solved,
    affine,
    block_diagonal,
    diagonal,
    positive,
    scalar,
    solve,
    sym,
    symmetric,
)
from gainsay.lmi.affine import Affine, Definite
from gainsay.lmi.lyapunov_forms import read_region, read_stein
from gainsay.lmi.row_scales import region_scales, stein_scales


def real_form(M):
    return np.block([[M.real, -M.imag], [M.imag, M.real]])


def moved(rng, n, outside, discrete=False, field=0):
    """Gaussian, its eigenvalues moved to 0.1 to 0.6 inside or outside."""
    A = rng.standard_normal((n, n)) + field * rng.standard_normal((n, n))
    eigenvalues, by = np.linalg.eigvals(A), (0.1 + rng.random() / 2) * (1 if outside else -1)
    return A * (1 + by) / np.abs(eigenvalues).max() if discrete else A + (by - eigenvalues.real.max()) * np.eye(n)


def hermitian(n):
    """Complex P written in reals."""
    P = affine(np.zeros((2 * n, 2 * n)))
    for i in range(n):
        for j in range(i + 1):
            E = np.zeros((n, n), complex)
            E[i, j] = E[j, i] = 1
            P = P + scalar(f"r{i}{j}") * real_form(E)
            if j < i:
                E[i, j], E[j, i] = 1j, -1j
                P = P + scalar(f"s{i}{j}") * real_form(E)
    return P


def lyapunov(A, P, *held):
    return [(sym(A.T @ P) < 0).named("Lyapunov"), *held]


def stein(A, P, *held):
    return [(P - A.T @ P @ A > 0).named("Stein"), *held]


def complex_lyapunov(rng, outside):
    P = hermitian(3)
    return lyapunov(real_form(moved(rng, 3, outside, field=1j)), P, P > 0)


def complex_stein(rng, outside):
    P = hermitian(3)
    return stein(real_form(moved(rng, 3, outside, True, 1j)), P, P > 0)


def complex_completed(rng, outside):
    P, F = hermitian(2), BlockMatrix("Stein", "a", "b")
    F["a", "a"], F["a", "b"], F["b", "b"] = P, real_form(moved(rng, 2, outside, True, 1j)).T @ P, P
    return [F > 0]


def coupled(rng, outside, discrete=False):
    """Two subsystems in cascade, which a block-diagonal P serves, or a system that is unstable."""
    if outside:
        return moved(rng, 5, True, discrete)
    A = block_diagonal(moved(rng, 2, False, discrete), moved(rng, 3, False, discrete)).value({})
    A[:2, 2:] = rng.standard_normal((2, 3))
    return A


def two_blocks(rng, outside):
    one, two = symmetric("P1", 2), symmetric("P2", 3)
    return lyapunov(coupled(rng, outside), block_diagonal(one, two), two > 0, one > 0)


def two_blocks_stein(rng, outside):
    P = block_diagonal(symmetric("P1", 2), symmetric("P2", 3))
    return stein(coupled(rng, outside, True), P, (P[:2, :2] > 0).named("1"), (P[2:, 2:] > 0).named("2"))


def diagonal_form(rng, outside):
    D = diagonal("D", 4)
    A = moved(rng, 4, True) if outside else rng.uniform(-0.5, 0.5, (4, 4)) - 3 * np.eye(4)  # diagonally dominant
    return lyapunov(A, D, D > 0)


def numbers(rng, outside):
    A = moved(rng, 3, True) if outside else rng.uniform(-0.5, 0.5, (3, 3)) - 3 * np.eye(3)
    return lyapunov(A, block_diagonal(*(positive(f"d{i}") for i in range(3))))


def a_sum(rng, outside):
    one, two = symmetric("P1", 4), symmetric("P2", 4)
    return lyapunov(moved(rng, 4, outside), one + two, one > 0, two > 0)


def a_vertex(rng, outside):
    zero, one, A = symmetric("P0", 3), symmetric("P1", 3), moved(rng, 3, False)
    other = moved(rng, 3, True) if outside else A + 1e-3
    first, second = zero - one, zero + 0.7 * one
    return [
        *lyapunov(A, first, (first > 0).named("first")),
        *((c.named(f"second {c.label}")) for c in lyapunov(other, second, second > 0)),
    ]


def repeated(rng, outside):
    P, A = symmetric("P", 2), moved(rng, 2, outside)
    basis = P.terms[P]
    every = (
        [np.kron(np.eye(2), basis[:, :, k]) for k in range(3)],
        [np.kron(basis[:, :, k], np.eye(2)) for k in range(3)],
    )
    place = int(rng.integers(2))
    whole = Affine(np.zeros((4, 4)), {P: np.stack(every[place], axis=2)})
    return lyapunov(np.kron(A, np.eye(2)) if place else np.kron(np.eye(2), A), whole, P > 0)


def with_more(rng, outside):
    P, Q, e = symmetric("P", 3), symmetric("Q", 3), positive("e")
    A, column = moved(rng, 3, outside), np.array([[1.0], [-2.0], [1.0]])
    return [(sym(A.T @ P) + Q + e * (column @ column.T) < 0).named("Lyapunov"), P > 0, Q > 0]


def change_of_basis(rng, outside):
    T = rng.standard_normal((4, 4))
    P = T.T @ symmetric("X", 4) @ T
    return lyapunov(moved(rng, 4, outside), P, (P > 0).named("P"))


STRUCTURES = (
    complex_lyapunov,
    complex_stein,
    complex_completed,
    two_blocks,
    two_blocks_stein,
    diagonal_form,
    numbers,
    a_sum,
    a_vertex,
    repeated,
    with_more,
    change_of_basis,
)


@pytest.mark.parametrize("made", STRUCTURES)
def test_a_structured_solution_exists_where_the_poles_are_inside(made):
    rng = np.random.default_rng(31)
    for outside in (False, True, True):
        assert isinstance(solve(Program(subject_to=made(rng, outside))), Infeasible if outside else Solved)


S, C = np.sin(0.6), np.cos(0.6)
#: L and M of f(s) = L + s M + conj(s) M': a cone, a disk beside the origin, strips across and along, a cone and a disk
REGIONS = {
    "cone": ([[0.0, 0], [0, 0]], [[S, C], [-C, S]]),
    "disk": ([[-2.0, 1], [1, -2]], [[0.0, 1], [0, 0]]),
    "half plane": ([[1.0]], [[1.0]]),
    "strip": ([[-8.0, 0], [0, 1]], [[-1.0, 0], [0, 1]]),
    "band": ([[-4.0, 0], [0, -4]], [[0.0, 1], [-1, 0]]),
    "half plane and disk": ([[0.0, 0, 0], [0, -6, 0], [0, 0, -6]], [[1.0, 0, 0], [0, 0, 1], [0, 0, 0]]),
}


def worst(L, M, A):
    return max(np.linalg.eigvalsh(L + s * M + np.conj(s) * M.T)[-1] for s in np.linalg.eigvals(A))


def placed(L, M, A):
    P, F = symmetric("P", len(A)), BlockMatrix("region", *(f"b{i}" for i in range(len(L))))
    for p in range(len(L)):
        for q in range(p, len(L)):
            F[f"b{p}", f"b{q}"] = L[p, q] * P + M[p, q] * (P @ A) + M[q, p] * (A.T @ P)
    return [F < 0, P > 0]


@pytest.mark.parametrize("name", REGIONS)
def test_a_region_holds_all_poles_or_there_is_no_solution(name):
    L, M = (np.array(part) for part in REGIONS[name])
    rng, seen = np.random.default_rng(32), {True: 0, False: 0}
    while min(seen.values()) < 3:
        n = int(rng.integers(2, 6))
        A = rng.standard_normal((n, n)) * 2 * rng.random() - 3 * rng.random() * np.eye(n)
        value = worst(L, M, A)
        if abs(value) > 0.05 and seen[value > 0] < 3:
            seen[value > 0] += 1
            assert isinstance(solve(Program(subject_to=placed(L, M, A))), Infeasible if value > 0 else Solved)


def test_a_form_that_is_nearly_one_of_a_matrix_is_none():
    # closed cones hold P = 0; a positive multiple of I lets any A pass; an entry off by 1e-9 is no rounding
    A, P, q = np.array([[0.3, 1.0], [-1.0, 0.3]]), symmetric("P", 2), positive("q")
    closed = [(sym(A.T @ P) <= 0).named("Lyapunov"), (P >= 0).named("P")]
    assert isinstance(solve(Program(subject_to=closed)), Solved)
    assert isinstance(solve(Program(subject_to=[(sym(A.T @ P) - q * np.eye(2) < 0).named("L"), P > 0])), Solved)
    basis = P.terms[P]
    behind = np.einsum("ijk,jl->ilk", basis, A)
    value = behind + behind.transpose(1, 0, 2)
    region = read_region(value, basis)
    assert region is not None and np.array_equal(region.A, A) and region.M == pytest.approx(1)
    for place in np.argwhere(value):
        changed = value.copy()
        changed[tuple(place)] *= 1 + 1e-9
        if not np.array_equal(changed, changed.transpose(1, 0, 2)):
            changed[place[1], place[0], place[2]] = changed[tuple(place)]
        other = read_region(changed, basis)
        assert other is None or not np.array_equal(other.A, A)
    stein_value = basis - np.einsum("ji,jlk,lm->imk", A, basis, A)
    assert any(np.allclose(abs(found), abs(A)) for found, _ in read_stein(stein_value, basis))
    stein_value[0, 0, 1] += 1e-9
    assert not list(read_stein(stein_value, basis))


@pytest.mark.parametrize("power", [-7, -5, -3])
def test_an_eigenvalue_barely_outside_is_not_let_in_by_rounding(power):
    # the rounded sums of A'P + P A alone have points of a condition number of 1e16
    for seed in range(6):
        rng = np.random.default_rng([seed, -power])
        n = int(rng.integers(2, 6))
        A = rng.standard_normal((n, n))
        A += (10.0**power - np.linalg.eigvals(A).real.max()) * np.eye(n)
        P = symmetric("P", n)
        assert isinstance(solve(Program(subject_to=lyapunov(A, P, P > 0))), Infeasible)


def in_other_units(rng, constraints, power):
    """Every row and every coordinate times a power of ten of its own: the same program."""
    sizes = {v: 10.0 ** rng.uniform(-power, power, v.size) for v in Program(subject_to=constraints).variables}
    changed = []
    for constraint in constraints:
        F, d = constraint.expression, 10.0 ** rng.uniform(-power, power, constraint.expression.shape[0])
        both = np.outer(d, d)
        terms = {v: c * both[:, :, None] * sizes[v] for v, c in F.terms.items()}
        changed.append(Definite(constraint.label, Affine(F.constant * both, terms), constraint.strict, constraint.rows))
    return changed


def free_lyapunov(rng, outside):
    P = symmetric("P", 4)
    return lyapunov(moved(rng, 4, outside), P, P > 0)


def free_stein(rng, outside):
    P = symmetric("P", 4)
    return stein(moved(rng, 4, outside, True), P, P > 0)


def in_a_cone(rng, outside):
    L, M = (np.array(part) for part in REGIONS["cone"])
    A = np.array([[-1.0, 2.0 if outside else 0.5], [-2.0 if outside else -0.5, -1.0]])
    T = rng.standard_normal((2, 2)) + 3 * np.eye(2)
    return placed(L, M, np.linalg.solve(T, A @ T))


def completed(rng, outside):
    P, F = symmetric("P", 3), BlockMatrix("Stein", "a", "b")
    F["a", "a"], F["a", "b"], F["b", "b"] = P, moved(rng, 3, outside, True).T @ P, P
    return [F > 0]


@pytest.mark.parametrize(
    "made", [free_lyapunov, free_stein, in_a_cone, completed, a_vertex, diagonal_form, complex_lyapunov]
)
@pytest.mark.parametrize("power", [1, 4])
def test_units_of_rows_and_unknowns_change_no_outcome(made, power):
    rng = np.random.default_rng(33)
    for outside in (False, True):
        program = Program(subject_to=in_other_units(rng, made(rng, outside), power))
        assert isinstance(solve(program), Infeasible if outside else Solved)


def test_the_scales_of_rows_are_read_from_coefficients():
    rng = np.random.default_rng(34)
    A, basis = rng.standard_normal((3, 3)), symmetric("P", 3).terms
    ((_, basis),) = basis.items()
    d, e, sizes = (10.0 ** rng.uniform(-3, 3, n) for n in (3, 3, 6))
    behind = np.einsum("ijk,jl->ilk", basis, A)
    forms = behind + behind.transpose(1, 0, 2), basis - np.einsum("ji,jlk,lm->imk", A, basis, A)
    given = basis * np.outer(e, e)[:, :, None] * sizes
    for form, read in zip(forms, (region_scales, stein_scales), strict=True):
        weights = read(form * np.outer(d, d)[:, :, None] * sizes, given)
        ratio = weights * d / e
        np.testing.assert_allclose(ratio, ratio[0], rtol=1e-12)
    assert np.array_equal(region_scales(forms[0], basis), np.ones(3))
    # a complex P in reals has no unknown in one entry: no scale is seen
    assert np.array_equal(stein_scales(*2 * (np.dstack([np.eye(2)]),)), np.ones(2))
