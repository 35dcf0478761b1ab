"""Each printed inequality of wan2014 typed a second time, from the paper's LaTeX, against the statements of the code.

Provenance of every expected matrix: the equations of the paper as they stand in its text, in numpy. The statements'
texts are evaluated at random data by the checker's own evaluator.
"""

from pathlib import Path

import numpy as np
import pytest

from gainsay.exact.matrix import Matrix
from gainsay.proof import check, formulas
from gainsay.proof.scope import MappingTables
from gainsay.tables.folder import read_case
from papers.wan2014 import derivations, derivations_bounds, statements

ROOT = Path(__file__).parents[2]
CASE = read_case(ROOT, "wan2014")
rng = np.random.default_rng(20140521)


def draw(rows, columns, symmetric=False, positive=False):
    value = rng.integers(-8, 9, (rows, columns)) / 4
    if symmetric:
        value = value + value.T
    return value @ value.T + np.eye(rows) if positive else value


A, B, L, C = draw(6, 6), draw(6, 3), draw(6, 3), draw(3, 6)
E1, E2, Lambda, DA = draw(6, 6), draw(6, 6), draw(6, 6), draw(6, 6)
X, Y, P, K = draw(6, 6, symmetric=True), draw(3, 6), draw(6, 6, positive=True), draw(3, 6)
Q, R = draw(6, 6, positive=True), draw(3, 3, positive=True)
x0, e0 = draw(6, 1), draw(6, 1)
eps, rho, w, u_max = 0.75, 3.5, 5.25, 2.5
VALUES = {
    "A": A, "B": B, "L": L, "C": C, "E1": E1, "E2": E2, "Lambda": Lambda, "DA": DA, "X": X, "Y": Y, "P": P, "K": K,
    "Q": Q, "R": R, "x0": x0, "e0": e0, "eps": eps, "rho": rho, "w": w, "u_x": u_max, "u_y": u_max, "u_z": u_max,
    "inverse_rho": 1 / 3.5,
}  # fmt: skip
AXES = {"x": [1.0, 0, 0], "y": [0, 1.0, 0], "z": [0, 0, 1.0]}
I6, O66, O63, O36 = np.eye(6), np.zeros((6, 6)), np.zeros((6, 3)), np.zeros((3, 6))
O33 = np.zeros((3, 3))


def whole(upper):
    """A symmetric block matrix from its upper block rows, the stars left out."""
    n = len(upper)
    full = [[upper[min(i, j)][max(i, j) - min(i, j)] for j in range(n)] for i in range(n)]
    return np.block([[full[i][j] if i <= j else full[i][j].T for j in range(n)] for i in range(n)])


def sym(M):
    return M + M.T


def number(x):
    return np.array([[float(x)]])


def eq14():
    BY, EE = B @ Y, eps * E1 @ E1.T
    Ri, Qi = np.linalg.inv(R), np.linalg.inv(Q)
    return whole([
        [sym(A @ X - BY) + EE, BY + EE, X @ E2.T, O66, Y.T, -Y.T, X],
        [sym((A - L @ C) @ X) + EE, O66, O66, -Y.T, Y.T, O66],
        [-eps * I6, O66, O63, O63, O66],
        [-eps * I6, O63, O63, O66],
        [-Ri, O33, O36],
        [-Ri, O36],
        [-Qi],
    ])  # fmt: skip


def eq15():
    return whole([[number(-rho), np.vstack([x0, e0]).T], [-np.block([[X, O66], [O66, X]])]])


def eq18():
    return whole([[sym(P @ (A + DA - B @ K)), P @ B @ K + DA.T @ P], [sym(P @ (A - L @ C))]])


def eq21():
    KRK = K.T @ R @ K
    return whole([
        [sym(P @ (A + DA - B @ K)) + Q + KRK, P @ B @ K + DA.T @ P - KRK],
        [sym(P @ (A - L @ C)) + KRK],
    ])  # fmt: skip


def eq23():
    KRK = K.T @ R @ K
    Psi = whole([[sym(P @ (A - B @ K)) + Q + KRK, P @ B @ K - KRK], [sym(P @ (A - L @ C)) + KRK]])
    Delta = np.block([[P @ E1, O66], [P @ E1, O66]])
    Phi = np.block([[Lambda, O66], [O66, O66]])
    E = np.block([[E2, O66], [O66, O66]])
    return Psi, Delta, Phi, E


def eq22():
    Psi, Delta, Phi, E = eq23()
    return Psi + Delta @ Phi @ E + E.T @ Phi.T @ Delta.T


def eq24():
    Psi, Delta, _, E = eq23()
    return Psi + eps * Delta @ Delta.T + E.T @ E / eps


def eq25():
    PEEP = eps * P @ E1 @ E1.T @ P
    Gamma11 = whole([[sym(P @ (A - B @ K)) + PEEP, P @ B @ K + PEEP], [sym(P @ (A - L @ C)) + PEEP]])
    Gamma12 = np.block([[E2.T, O66, K.T, -K.T, I6], [O66, O66, -K.T, K.T, O66]])
    Ri, Qi = np.linalg.inv(R), np.linalg.inv(Q)
    Gamma22 = np.zeros((24, 24))
    Gamma22[:6, :6], Gamma22[6:12, 6:12] = -eps * I6, -eps * I6
    Gamma22[12:15, 12:15], Gamma22[15:18, 15:18], Gamma22[18:, 18:] = -Ri, -Ri, -Qi
    return whole([[Gamma11, Gamma12], [Gamma22]])


def eq27():
    xi = np.vstack([x0, e0])
    return xi.T @ np.block([[P, O66], [O66, P]]) @ xi - rho


def eq29():
    return whole([[number(rho), np.vstack([x0, e0]).T], [-np.block([[P, O66], [O66, P]])]])


def eq30():
    return whole([[number(-1 / rho), np.vstack([x0, e0]).T / rho], [-np.block([[X, O66], [O66, X]])]])


def selector(axis):
    """U_i after (4)."""
    row = np.array([AXES[axis]])
    return row.T @ row


def eq31(axis):
    U = selector(axis)
    return whole([[-X, O66, Y.T @ U.T], [-X, -Y.T @ U.T], [-(u_max**2) / rho * np.eye(3)]])


def eq35(axis):
    KUUK = K.T @ selector(axis).T @ selector(axis) @ K
    left = np.block([[KUUK, -KUUK], [-KUUK, KUUK]]) / u_max**2
    return left - np.block([[P, O66], [O66, P]]) / rho


def eq36(axis):
    U = selector(axis)
    return whole([[-P, O66, K.T @ U.T], [-P, -K.T @ U.T], [-(u_max**2) / rho * np.eye(3)]])


def eq37():
    return np.array([[-w, 1], [1, -1 / rho]])


def evaluated(statement):
    """Value of a statement's text at the random data, by the checker's evaluator."""
    names = {name: Matrix.of(np.atleast_2d(value).tolist()) for name, value in VALUES.items()}
    names |= {f"U_{axis}": Matrix.of(selector(axis).tolist()) for axis in AXES}
    for name, text in statements.EQ23.items():
        names[name] = formulas.evaluate(text, names, MappingTables())
    found = formulas.evaluate(statement.formula, names, MappingTables())
    return np.array([[int(x.p) / int(x.q) for x in row] for row in found.rows()])


PLAIN = {
    "EQ14": eq14, "EQ15": eq15, "EQ18": eq18, "EQ21": eq21, "EQ22": eq22, "EQ24": eq24, "EQ25": eq25, "EQ27": eq27,
    "EQ29": eq29, "EQ30": eq30, "EQ37": eq37,
}  # fmt: skip


@pytest.mark.parametrize("name", PLAIN)
def test_statement_is_the_printed_inequality(name):
    np.testing.assert_allclose(evaluated(getattr(statements, name)), PLAIN[name](), rtol=1e-11, atol=1e-11)


@pytest.mark.parametrize(("name", "printed"), [("EQ31", eq31), ("EQ35", eq35), ("EQ36", eq36)])
@pytest.mark.parametrize("axis", AXES)
def test_statement_of_an_axis_is_the_printed_inequality(name, printed, axis):
    found = evaluated(getattr(statements, name).given(axis=axis))
    np.testing.assert_allclose(found, printed(axis), rtol=1e-11, atol=1e-11)


def test_plant_is_the_printed_one():
    """(2), (39), (41), (42) and section 4, typed from the paper."""
    n, m, e = 1.13e-3, 200.0, 0.01
    A = np.zeros((6, 6))
    A[0, 3] = A[1, 4] = A[2, 5] = 1
    A[3, 0], A[3, 4], A[4, 3], A[5, 2] = 3 * n**2, 2 * n, -2 * n, -(n**2)
    B = np.vstack([O33, np.eye(3) / m])
    C = np.hstack([np.eye(3), O33])
    L = np.array([
        [1.2491, 0.0127, 0.0054], [-0.025, 1.2886, -0.0213], [-0.0740, -0.0388, 1.1623],
        [0.3863, 0.0322, 0.0124], [-0.0282, 0.4142, -0.0153], [-0.0535, -0.0258, 0.3440],
    ])  # fmt: skip
    E1 = np.zeros((6, 6))
    E1[3, 1], E1[3, 2], E1[3, 4] = 2 * e, 4 * e, 8 * e
    E1[4, 0], E1[4, 3], E1[5, 4] = 2 * e, 4 * e, 6 * e
    E2 = np.zeros((6, 6))
    E2[0, 0] = E2[1, 1] = E2[4, 2] = E2[5, 5] = n**2
    E2[2, 0], E2[2, 2], E2[2, 4] = 2.5 * n**2, n**2, n
    E2[3, 1], E2[3, 3] = 0.25 * n**2, -n
    x0 = np.array([[3000.0, -4000, 20, -3, 4, -0.02]]).T
    printed = {"A": A, "B": B, "C": C, "L": L, "E1": E1, "E2": E2, "Q": I6, "R": np.eye(3), "x0": x0,
               "e0": np.vstack([np.zeros((3, 1)), x0[3:]]), "u_x": [[40.0]], "u_y": [[40.0]],
               "u_z": [[20.0]]}  # fmt: skip
    floats = statements.problem_38(CASE).floats()
    for name, value in printed.items():
        np.testing.assert_allclose(floats.constant(name), value, rtol=1e-14, atol=0, err_msg=name)
    for axis in AXES:
        np.testing.assert_array_equal(floats.constant(f"U_{axis}"), selector(axis))


def test_editions_name_the_cells_that_differ():
    """(24) has one input column; (29) needs -rho and P^-1: the errata of the tables."""
    assert {(c.row, c.column) for c in statements.EQ14.corrected({}, without=("u again",)).differences} == {
        ("x", "u again"), ("e", "u again"), ("u again", "u again"),
    }  # fmt: skip
    assert [(c.row, c.printed, c.corrected) for c in statements.EQ29_CORRECTED.differences] == [
        ("rho", "rho", "-rho"), ("x", "-P", "-inverse(P)"), ("e", "-P", "-inverse(P)"),
    ]  # fmt: skip


STEPS = (*derivations.DERIVATIONS, *derivations_bounds.DERIVATIONS)


@pytest.mark.parametrize("step", STEPS, ids=lambda step: step.__name__)
def test_every_step_of_the_proofs_is_accepted(step):
    certificate = step(CASE)
    assert [c.relation for c in check(certificate, CASE).conclusions] == ["holds"]
