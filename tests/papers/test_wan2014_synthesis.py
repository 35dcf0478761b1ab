"""wan2014 synthesis: programs against their matrices, bounds against trajectories, proofs against forgery."""

from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import expm, solve_continuous_lyapunov

from gainsay.errors import CertificateError
from gainsay.lmi import Infeasible, Solved, infimum
from gainsay.proof import check
from gainsay.tables.folder import read_case
from papers.wan2014 import conditions_digits as digits
from papers.wan2014 import plant, proofs, searches, statements
from tests.papers.wan2014_model import model_of

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def case():
    return read_case(ROOT, "wan2014")


@pytest.fixture(scope="module")
def model(case):
    return model_of(case)


@pytest.fixture(scope="module")
def observer(case, model):
    return model.A - case.matrix("L") @ case.matrix("C")


@pytest.fixture(scope="module")
def xi0(case):
    x0 = case.matrix("x0").reshape(6, 1)
    return np.vstack([x0, np.zeros((3, 1)), x0[3:]])


@pytest.fixture(scope="module")
def multipliers(case):
    return statements.farkas_multipliers(case).infimum().solved


class Loop:
    """The closed loop of (9) and (11) in [x; e], put together in numpy."""

    def __init__(self, case, model, observer, K):
        alive = np.flatnonzero(np.abs(model.E1).max(axis=0) > 0)
        self.A = np.block([[model.A - model.B @ K, model.B @ K], [np.zeros((6, 6)), observer]])
        self.E = np.vstack([model.E1, model.E1])[:, alive]
        self.F = np.hstack([model.E2, np.zeros((6, 6))])[alive]
        self.k = np.hstack([-K, K])
        self.Q = self.k.T @ case.matrix("R") @ self.k
        self.Q[:6, :6] += case.matrix("Q")


def _random_point(seed=0):
    rng = np.random.default_rng(seed)
    X = rng.normal(size=(6, 6))
    return {"X": X + X.T, "Y": rng.normal(size=(3, 6)), "eps": 0.7, "rho": 1.3}


def test_programs_speak_of_the_closed_loop(case, model, observer, xi0):
    loop = Loop(case, model, observer, case.matrix("K"))
    floats = statements.cost_bound(case, "printed('K')").floats()
    for name, value in {"Acl": loop.A, "H": loop.E, "Cz": loop.F, "weight": loop.Q, "xi0": xi0}.items():
        np.testing.assert_allclose(floats.constant(name), value, rtol=1e-13, atol=1e-18)


def test_dissipation_is_that_of_the_argument(case, model, observer):
    # V = xi'P xi along xi' = A xi + H w, the cost's weight, and s_i (z_i^2 - w_i^2) for w = Lambda z, |Lambda_i| <= 1
    loop = Loop(case, model, observer, case.matrix("K"))
    stated = statements.cost_bound(case, "printed('K')").floats()
    formula = statements.dissipation(case, "printed('K')", "weight").formula
    rng = np.random.default_rng(5)
    P, s = rng.normal(size=(12, 12)), rng.uniform(1, 2, 5)
    P = P + P.T
    block = stated.value(formula).value({"P": P, "S": np.diag(s)})
    for _ in range(3):
        xi, w = rng.normal(size=12), rng.normal(size=5)
        z = loop.F @ xi
        right = 2 * xi @ P @ (loop.A @ xi + loop.E @ w) + xi @ loop.Q @ xi + s @ (z**2 - w**2)
        point = np.append(xi, w)
        assert point @ block @ point == pytest.approx(right, rel=1e-9)


def test_reach_is_that_of_the_argument(case, model, observer):
    # [[P, k'], [k, u]] > 0 is P > k'k / u: |k xi|^2 <= u xi'P xi; the start lies in xi'P xi < 1
    loop = Loop(case, model, observer, case.matrix("K"))
    for axis in range(3):
        stated = statements.thrust_bound(case, "printed('K')", axis)
        by_label = {c.label: c.expression for c in stated.program().constraints}
        P = np.eye(12)
        block = by_label["reach"].value({"P": P, "S": np.eye(5), "square": 3.0})
        np.testing.assert_allclose(block[:12, :12], P)
        np.testing.assert_allclose(block[:12, 12], loop.k[axis])
        assert block[12, 12] == 3.0
        xi0 = stated.floats().constant("xi0").ravel()
        start = by_label["start inside"].value({"P": P, "S": np.eye(5), "square": 3.0})
        assert start.item() == pytest.approx(1 - xi0 @ xi0, rel=1e-12)


def test_joint_inequality_is_that_of_the_argument(case, model, observer):
    # V = xhat'X^-1 xhat + e'Pe along xhat' = (A - BK) xhat + LC e, e' = (A - LC) e + E1 w, u = -K xhat, K = Y X^-1,
    # the cost of xhat + e and u, and m_i (z_i^2 - w_i^2), z = E2 (xhat + e): the inequality at one vector
    stated = statements.joint_design(case)
    M = stated.floats().constant("M")
    rng = np.random.default_rng(6)
    X, P, Y = rng.normal(size=(6, 6)), rng.normal(size=(6, 6)), rng.normal(size=(3, 6))
    X, P = X @ X.T + np.eye(6), P + P.T
    (block,) = (c.expression for c in stated.program().constraints if c.label == "joint")
    value = -block.value({"X": X, "Y": Y, "P": P, "rho": 1.0})
    Q, R, K = case.matrix("Q"), case.matrix("R"), Y @ np.linalg.inv(X)
    for _ in range(3):
        xhat, e, w = rng.normal(size=6), rng.normal(size=6), rng.normal(size=5)
        u, eta = -K @ xhat, np.linalg.solve(X, xhat)
        z = model.E2[:5] @ (xhat + e)
        slope = 2 * eta @ ((model.A - model.B @ K) @ xhat + (model.A - observer) @ e)
        slope += 2 * e @ P @ (observer @ e + model.E1[:, :5] @ w)
        right = slope + (xhat + e) @ Q @ (xhat + e) + u @ R @ u + z @ M @ z - w @ M @ w
        point = np.concatenate([eta, e, w, M @ z, Q @ (xhat + e), R @ K @ xhat])
        assert point @ value @ point == pytest.approx(right, rel=1e-8)


def test_multipliers_leave_trace_W_X_alone(case, model, observer, multipliers):
    # the identity behind the refutation, at random X, Y, eps: <V, core of (14)> = tr(W X) + eps |V^(1/2) [E1; E1]|^2
    V1, V3 = multipliers["V1"], multipliers["V3"]
    V2 = np.vstack([multipliers["V2"], V1[3:]])
    V = np.block([[V1, V2], [V2.T, V3]])
    A, E1 = model.A, model.E1
    W = A.T @ V1 + V1 @ A + observer.T @ V3 + V3 @ observer
    assert np.linalg.eigvalsh(V)[0] > 0 and np.linalg.eigvalsh(W)[0] > 0
    both = np.vstack([E1, E1])
    core = statements.Stated(case, [statements.EQ14.sub("x", "e") < 0]).floats()
    for seed in range(3):
        p = _random_point(seed)
        value = core.value(statements.EQ14.sub("x", "e").formula).value(p)
        expected = np.trace(W @ p["X"]) + p["eps"] * np.trace(both.T @ V @ both)
        assert np.sum(V * value) == pytest.approx(expected, rel=1e-9)


def test_refutation_is_accepted_and_cannot_be_forged(case, multipliers):
    certificate = proofs.infeasible_14(case, multipliers.values)
    assert [(c.quantity, c.relation) for c in check(certificate, case).conclusions] == [("eq14.feasible", "fails")]
    # the same multipliers say nothing about (14) without the plant's coupling through A - LC
    (label, text), *rest = certificate.fields["constraints"]
    weaker = text.replace("sym((A - L@C)@X)", "-sym((A - L@C)@X)")
    assert weaker != text
    with pytest.raises(CertificateError):
        check(certificate.changed(fields={**certificate.fields, "constraints": [[label, weaker], *rest]}), case)


def test_a_problem_with_a_solution_is_not_refuted(case):
    # with the states measured (error block left out) the same machinery finds a point: the refutation is no artefact
    assert isinstance(statements.state_feedback(case).solve(), Solved)


@pytest.mark.slow
def test_problem_38_has_no_point(case):
    assert isinstance(statements.problem_38(case).solve(), Infeasible)


def test_wrong_diagonal_by_hand(case, observer):
    # entry (4,4) of sym((A - LC) X) with the printed X; the eps term only adds
    assert 2 * observer[3] @ case.matrix("X")[:, 3] > 0
    proofs.wrong_diagonal(case)


def test_small_certificates(case):
    for build in (proofs.input_counted_twice, proofs.empty_row_14, proofs.infeasible_29):
        check(build(case), case)


def test_consistent_digits(case):
    X, K = digits.consistent_point(case)
    for value, name in ((X, "X"), (K, "K"), (K @ X, "Y")):
        for i, row in enumerate(case.printed(name).rows):
            for j, entry in enumerate(row):
                assert float(entry.low) <= value[i, j] <= float(entry.high)
    proofs.consistent_digits(case, X, K)


def test_no_consistent_digits_is_an_error(case, monkeypatch):
    monkeypatch.setattr(digits, "_step", lambda X, K, *_: (0 * X, 0 * K))
    with pytest.raises(ArithmeticError, match="half units remain"):
        digits.consistent_point(case)


def _corners(channels, count=6):
    """Constant uncertainties with entries in -1..1: corners and points inside."""
    rng = np.random.default_rng(1)
    return [np.diag(rng.choice([-1.0, 1.0, 0.3], channels)) for _ in range(count)]


@pytest.mark.slow
def test_bounds_hold_on_trajectories_and_are_tight(case, model, observer, xi0):
    """Cost of every constant Lambda by a Lyapunov equation, thrust by the matrix exponential: an independent route."""
    loop = Loop(case, model, observer, case.matrix("K"))
    found = infimum(statements.cost_bound(case, "printed('K')").program())
    cost, near = found.upper, {part: found.solved.values[part] / found.upper for part in ("P", "S")} | {"square": 100.0}
    programs = [statements.thrust_bound(case, "printed('K')", i).program() for i in range(3)]
    bounds = [np.sqrt(infimum(program, near=near).upper) for program in programs]
    costs, peaks = [], []
    for Lambda in _corners(loop.E.shape[1]):
        A = loop.A + loop.E @ Lambda @ loop.F
        P = solve_continuous_lyapunov(A.T, -loop.Q)
        costs.append((xi0.T @ P @ xi0).item())
        step, x, peak = expm(A * 0.5), xi0, np.zeros(3)
        for _ in range(1200):
            peak = np.maximum(peak, np.abs(loop.k @ x).ravel())
            x = step @ x
        peaks.append(peak)
    assert max(costs) <= cost < 1.05 * max(costs)
    assert (np.max(peaks, axis=0) <= np.array(bounds) * (1 + 1e-12)).all()
    # 3000 k11 - 4000 k12 + 20 k13 with the printed digits: the thrust at the start, which no bound can undercut
    assert bounds[0] == pytest.approx(29.0145574, rel=1e-4) and bounds[0] >= 29.0145574


def test_certified_bounds_are_checked_by_the_checker(case):
    point = statements.cost_bound(case, "printed('K')").solve()
    quantities = {"cost": "full_lyapunov.cost_bound", "stable": "full_lyapunov.stable"}
    certificate = proofs.cost_certificate(case, "printed('K')", point.values, id="c", quantities=quantities)
    assert {c.quantity for c in certificate.conclusions} == set(quantities.values())
    lower = {**certificate.fields, "cost": "3.8e9"}  # below the cost of a trajectory, so no proof can exist
    with pytest.raises(CertificateError):
        check(certificate.changed(fields=lower), case)


def test_lqr_solves_the_riccati_equation_and_uses_the_limit(case, model):
    weight = 1e4
    K = searches.lqr_gain(case, weight)
    A, B, Q, R = model.A, model.B, case.matrix("Q"), weight * case.matrix("R")
    P = solve_continuous_lyapunov((A - B @ K).T, -(Q + K.T @ R @ K))
    # stationarity: K = R^-1 B' P for the cost matrix P of K itself
    np.testing.assert_allclose(np.linalg.solve(R, B.T @ P), K, rtol=1e-7, atol=1e-9)


def test_joint_design_is_a_correct_theorem(case):
    """Its bound is above the cost that a full Lyapunov matrix certifies for its own gain."""
    joint = statements.joint_design(case).solve()
    K = searches.gain(joint.values)
    rows = ", ".join("[" + ", ".join(repr(float(k)) for k in row) + "]" for row in K)
    own = statements.cost_bound(case, f"[{rows}]").solve()
    assert own.objective <= joint.objective


@pytest.mark.slow
def test_subproblem_agrees_with_an_independent_statement(case, model):
    """The sub-problem stated again in cvxpy: kilometres, tens of m/s, units of 20 N, costs in 1e9."""
    import cvxpy as cp

    m, unit, newtons, money = model, np.diag([1e-3] * 3 + [0.1] * 3), 20.0, 1e9
    inverse = np.linalg.inv(unit)
    A, B, E1, E2, x0 = (
        unit @ m.A @ inverse,
        unit @ m.B * newtons,
        unit @ m.E1,
        m.E2 @ inverse,
        unit @ case.matrix("x0").reshape(6, 1),
    )
    P, Y, eps, rho = cp.Variable((6, 6), symmetric=True), cp.Variable((3, 6)), cp.Variable(), cp.Variable()
    core = A @ P + P @ A.T - B @ Y - Y.T @ B.T + eps * (E1 @ E1.T)
    root, o = money**-0.5, np.zeros
    form = cp.bmat([
        [core, P @ E2.T, root * newtons * Y.T, root * P @ inverse],
        [E2 @ P, -eps * np.eye(6), o((6, 3)), o((6, 6))],
        [root * newtons * Y, o((3, 6)), -rho * np.eye(3), o((3, 6))],
        [root * inverse @ P, o((6, 6)), o((6, 3)), -rho * np.eye(6)],
    ])  # fmt: skip
    constraints = [form << 0, cp.bmat([[np.eye(1), x0.T], [x0, P]]) >> 0]
    for i, limit in enumerate(plant.thrust_limits(case) / newtons):
        row = Y[i : i + 1, :]
        constraints.append(cp.bmat([[P, row.T], [row, np.array([[limit**2 / 2]])]]) >> 0)
    stated = cp.Problem(cp.Minimize(rho), constraints)
    stated.solve(solver=cp.CLARABEL)
    ours = statements.state_feedback(case).solve()
    assert rho.value * money == pytest.approx(ours.objective, rel=1e-4)
    K = Y.value @ np.linalg.inv(P.value) @ unit * newtons
    np.testing.assert_allclose(K[:2, [0, 1, 3, 4]], searches.gain(ours.values)[:2, [0, 1, 3, 4]], rtol=0.02)
