"""Robustness tools of li2021: arcs, scalings, gradients, and what their certificates are worth."""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from gainsay.errors import CertificateError, ComputationError
from gainsay.lmi import Solved, solve
from gainsay.proof import check
from gainsay.tables import read_case
from papers.li2021 import arcs, certify, design, identities, lmis, plant, proofs, robust

ROOT = Path(__file__).resolve().parents[2]
RNG = np.random.default_rng(11)


@pytest.fixture(scope="module")
def case():
    return read_case(ROOT, "li2021")


@pytest.fixture(scope="module")
def gains(case):
    return plant.controller(case, "proposed")


def form_at(case, gains, delta):
    return robust.loop(plant.constants(case), gains, delta).balanced()


def random_loops(case, gains, delta, count=400):
    """Loops at vertices and inside the box of gain variations and inertias."""
    k = plant.constants(case)
    for _ in range(count):
        signs = np.sign(RNG.standard_normal(12)) * RNG.choice([1.0, 1.0, 0.5])
        inertia = np.sign(RNG.standard_normal(3))
        factors = 1 + delta * signs
        yield plant.closed_loop(plant.rigid(k, inertia), gains, factors[:6], factors[6:9], factors[9:])


def test_nodes_lie_on_the_circle_exactly():
    for angle in (0.0, 0.3, np.pi / 2, 2.0, np.pi):
        c, s = arcs.point(arcs.node(angle))
        assert c * c + s * s == 1
        assert abs(float(c) - np.cos(angle)) < 3e-6 and abs(float(s) - np.sin(angle)) < 3e-6


def test_scaled_norm_gradient():
    # second method: central differences
    M = RNG.standard_normal((27, 27)) + 1j * RNG.standard_normal((27, 27))
    x, step = 0.3 * RNG.standard_normal(25), RNG.standard_normal(25)
    slope = arcs.scaled_norm(x, M, 9)[1] @ step
    difference = (arcs.scaled_norm(x + 1e-6 * step, M, 9)[0] - arcs.scaled_norm(x - 1e-6 * step, M, 9)[0]) / 2e-6
    assert slope == pytest.approx(difference, rel=1e-6)


def test_design_gradient(case, gains):
    # second method: central differences, every wish active
    wishes = design.Wishes(
        0.05, gamma=10.0, disk_radius=0.5, abscissa_flexible=-0.01, norm=0.5, static_gain=0.5, steady=1e-4, torque=0.1,
        drawn_abscissa=-0.3,
    )  # fmt: skip
    disk, constant = (1.01, 1.0), plant.disturbance(case, plant.constants(case)) @ [1, 0, 1]
    objective = design.Objective(plant.constants(case), wishes, disk, case.matrix("x0").ravel(), constant, nodes=5)
    x = np.concatenate([design.pack(gains), objective.scalings(gains)])
    step = RNG.standard_normal(x.size) * np.concatenate([np.abs(design.pack(gains)), np.ones(x.size - 72)])
    slope = objective(x)[1] @ step
    difference = (objective(x + 1e-6 * step)[0] - objective(x - 1e-6 * step)[0]) / 2e-6
    assert slope == pytest.approx(difference, rel=1e-5)


def test_one_arc_holds_pointwise(case, gains):
    a, b, first, last = 1.01, 1.0, 0.75, 0.85
    form = form_at(case, gains, 0.05)
    _, scale = arcs.best_scaling(form.response(-a + b * np.exp(0.8j)))
    arc = arcs.certify(form, a, b, (arcs.node(first), arcs.node(last)), scale)
    D = np.diag(arc.multipliers[robust.OF_CHANNEL])
    assert (
        np.linalg.eigvalsh(arcs.matrix(form, a, b, (arc.first, arc.last), arc.multipliers, arc.weight, arc.P))[-1] < 0
    )
    for angle in np.linspace(first + 1e-5, last - 1e-5, 7):
        M = form.response(-a + b * np.exp(1j * angle))
        # law: the certificate says M* D M < D on its arc
        assert np.linalg.eigvalsh(M.conj().T @ D @ M - D)[-1] < 0


def test_arc_matrix_is_the_form_it_stands_for(case, gains):
    # identity: on the circle P cancels, and Q enters with a weight that is not negative between the nodes only
    a, b, weight = 1.01, 1.0, 3.0
    form, d = form_at(case, gains, 0.05), np.exp(0.2 * RNG.standard_normal(25))
    P = RNG.standard_normal((12, 12)) + 1j * RNG.standard_normal((12, 12))
    ends = (arcs.node(0.6), arcs.node(0.9))
    D = np.diag(d[robust.OF_CHANNEL])
    N = arcs.matrix(form, a, b, ends, d, weight, P + P.conj().T)
    for angle, sign in ((0.61, 1), (0.75, 1), (0.89, 1), (0.5, -1), (1.0, -1), (-0.75, -1), (2.5, -1)):
        z = np.exp(1j * angle)
        w = RNG.standard_normal(27) + 1j * RNG.standard_normal(27)
        x = np.linalg.solve((-a + b * z) * np.eye(12) - form.A, form.H @ w)
        M, v = form.response(-a + b * z), np.concatenate([x, w])
        rest = (v.conj() @ N @ v - w.conj() @ (M.conj().T @ D @ M - D) @ w).real
        core = np.linalg.norm(np.sqrt(np.diag(D)) * (form.Cz @ x)) ** 2
        assert np.sign(rest) == sign
        # closed form of the weight: 2 |n| (cos of the distance to the middle of the arc - cos of its half width)
        half = 0.15
        assert rest / (weight * core) == pytest.approx(
            4 * np.cos(half) * (np.cos(angle - 0.75) - np.cos(half)), rel=1e-4
        )


@pytest.mark.slow
def test_arcs_cover_and_hold_pointwise(case, gains):
    a, b = 1.01, 1.0
    form = form_at(case, gains, 0.05)
    chain = arcs.cover(form, a, b)
    assert chain[0].first == arcs.node(0.0) and chain[-1].last == arcs.node(np.pi)
    for one, following in pairwise(chain):
        assert one.last == following.first
    for arc in chain:
        D = np.diag(arc.multipliers[robust.OF_CHANNEL])
        ends = [complex(*map(float, arcs.point(e))) for e in (arc.first, arc.last)]
        for share in (0.0, 0.3, 0.7, 1.0):
            z = np.exp(1j * ((1 - share) * np.angle(ends[0]) + share * np.angle(ends[1])))
            M = form.response(-a + b * z)
            # law: the certificate says M* D M < D on its arc
            assert np.linalg.eigvalsh(M.conj().T @ D @ M - D)[-1] < 0


@pytest.mark.slow
def test_certified_variation_is_not_beaten_by_samples(case, gains):
    # law: no loop inside the certified box leaves the disk
    delta = 0.06
    arcs.cover(form_at(case, gains, delta), 1.01, 1.0)
    worst = max(np.abs(np.linalg.eigvals(A) + 1.01).max() for A in random_loops(case, gains, delta))
    assert worst < 1


@pytest.mark.slow
def test_cover_refuses_what_a_sample_breaks(case):
    # the controller of [39] leaves the disk at a vertex of 5 %, so no arcs can exist
    comparison = plant.controller(case, "comparison")
    worst = max(np.abs(np.linalg.eigvals(A) + 1.01).max() for A in random_loops(case, comparison, 0.05, 2000))
    assert worst > 1
    with pytest.raises(ComputationError, match="no certificate"):
        arcs.cover(form_at(case, comparison, 0.05), 1.01, 1.0, narrowest=0.05)


def test_shared_scaling_bounds_the_pointwise_one(case, gains):
    form = form_at(case, gains, 0.05)
    points = -1.01 + np.exp(1j * np.linspace(0, np.pi, 4))
    responses = np.array([form.response(z) for z in points])
    common, _ = robust.shared_scaling(responses)
    assert common >= max(arcs.best_scaling(M)[0] for M in responses) - 1e-3


def test_original_coordinates(case, gains):
    # identity: the norm condition holds in the paper's own coordinates as in the balanced ones
    P, d = certify.norm_evidence(case, gains, 0.05)
    form = robust.loop(plant.constants(case), gains, 0.05)
    D = np.diag(d[robust.OF_CHANNEL])
    V, Z = np.hstack([form.A, form.H, form.B]), np.hstack([form.Cz, form.Dw, form.Dd])
    whole = Z.T @ D @ Z
    whole[:12] += P @ V
    whole[:, :12] += (P @ V).T
    whole[:12, :12] += form.C.T @ form.C
    whole[12:39, 12:39] -= D
    whole[39:, 39:] -= 100 * np.eye(3)
    scale = 1 / np.sqrt(-np.diag(whole))
    assert np.linalg.eigvalsh(scale[:, None] * whole * scale)[-1] < 0


def test_lemma3_point_gives_a_controller(case):
    # law: a point of the transformed (12) yields gains that satisfy (12) itself; here by the change of variables undone
    model = lmis.Model.of(case)
    found = solve(lmis.lemma3_synthesis(model, 3.0, 5.0))
    assert isinstance(found, Solved)
    X, Y, Ah, Bh, Ch = (found[name] for name in ("X", "Y", "Ah", "Bh", "Ch"))
    U = np.eye(6) - X @ Y
    B = np.linalg.solve(U, Bh)
    A = np.linalg.solve(U, Ah - X @ model.A @ Y - Bh @ model.C @ Y - X @ model.B @ Ch)
    loop = np.block([[model.A, model.B @ Ch], [B @ model.C, A]])
    assert np.abs(np.linalg.eigvals(loop) + 1.01).max() < 1
    gain = np.hstack([model.C, np.zeros((3, 6))]) @ np.linalg.solve(-loop, np.vstack([model.B, np.zeros((6, 3))]))
    assert np.linalg.norm(gain, 2) < 5.0


def test_disk_block_certificate_and_its_refusal(case):
    found = proofs.disk_block(case)
    assert check(found, case).conclusions[0].relation == "fails"
    witness = dict(found.witness)
    witness["S"] = [["-1" if i == j else "0" for j in range(6)] for i in range(6)]
    with pytest.raises(CertificateError):
        check(found.changed(witness=witness), case)


def test_factorisation_certificates_need_the_right_factor(case):
    for which in "DG":
        found = identities.factorisation(case, which)
        assert check(found, case).conclusions[0].relation == "holds"
        wrong = {"left": found.fields["left"], "right": found.fields["right"].replace("diag(u", "2 * diag(u", 1)}
        with pytest.raises(CertificateError):
            check(found.changed(fields=wrong), case)


@pytest.mark.slow
def test_full_certificate_at_five_percent(case, gains):
    evidence = certify.gather(case, gains, 0.05)
    found = certify.certificate(
        case, "test", gains, certify.PRINTED, evidence, quantity="certified.printed.delta_m", statement="A test."
    )
    assert check(found, case).conclusions[0].value == "0.05"
    # the same numbers prove nothing of the controller of [39]
    swapped = [(n, dict(certify.COMPARISON).get(n, t)) for n, t in found.definitions]
    with pytest.raises(CertificateError):
        check(found.changed(definitions=swapped, data={}), case)
