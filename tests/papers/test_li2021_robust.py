"""Robustness tools of li2021: arcs, scalings, gradients, and what their certificates are worth."""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from gainsay.errors import CertificateError, ComputationError
from gainsay.lmi import Solved
from gainsay.proof import check
from gainsay.tables import read_case
from papers.li2021 import conditions_arcs as arcs
from papers.li2021 import conditions_robust as robust
from papers.li2021 import derivations_identities as identities
from papers.li2021 import plant, proofs, searches
from papers.li2021 import proofs_requirements as certify
from papers.li2021 import searches_smooth as design
from papers.li2021.figures import FIGURES
from papers.li2021.proofs import lemma_3
from papers.li2021.statements import equation_17

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


@pytest.mark.parametrize("power", [2, 4, 40, 120])
def test_schatten_norm_is_that_of_the_singular_values(power):
    generator = np.random.default_rng(4)
    stack = generator.standard_normal((37, 5, 5)) + 1j * generator.standard_normal((37, 5, 5))
    U, s, Vh = np.linalg.svd(stack)
    value, slope = robust.schatten(stack, power)
    top = s.max()
    assert value == pytest.approx(top * ((s / top) ** power).sum() ** (1 / power), rel=1e-12)
    # the derivative by singular values is (s / value)^(power - 1), along their vectors
    np.testing.assert_allclose(slope, (U * ((s / value) ** (power - 1))[:, None, :]) @ Vh, atol=1e-12)


def test_scaled_norm_gradient():
    # second method: central differences
    M = RNG.standard_normal((27, 27)) + 1j * RNG.standard_normal((27, 27))
    x, step = 0.3 * RNG.standard_normal(25), RNG.standard_normal(25)
    slope = arcs.scaled_norm(x, M, 8)[1] @ step
    difference = (arcs.scaled_norm(x + 1e-6 * step, M, 8)[0] - arcs.scaled_norm(x - 1e-6 * step, M, 8)[0]) / 2e-6
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


def test_arcs_cover_and_hold_pointwise(case, gains):
    a, b = 1.01, 1.0
    form = form_at(case, gains, 0.05)
    ends, scales = arcs.cover(form, a, b)
    assert ends[0] == 0 and ends[-1] == 1 and len(scales) == len(ends) - 1
    for (low, high), scale in zip(pairwise(ends), scales, strict=True):
        assert low < high
        D = np.diag(np.exp(2 * scale)[robust.OF_CHANNEL])
        for t in np.linspace(low, high, 5):
            M = form.response(-a + b * np.exp(1j * np.pi * t))
            # law: the scaling of an arc gives M* D M < D on it
            assert np.linalg.eigvalsh(M.conj().T @ D @ M - D)[-1] < 0


def test_one_matrix_shows_the_whole_circle(case, gains):
    a, b = 1.01, 1.0
    form = form_at(case, gains, 0.02)
    circle = -a + b * np.exp(1j * np.linspace(0, np.pi, 40))
    P, d = arcs.one_matrix(form, a, b, robust.shared_scaling(np.array([form.response(s) for s in circle]))[1])
    D = np.diag(d[robust.OF_CHANNEL])
    V, Z = np.hstack([form.A + a * np.eye(12), form.H]), np.hstack([form.Cz, form.Dw])
    N = V.T @ P @ V + Z.T @ D @ Z
    N[:12, :12] -= b**2 * P
    N[12:, 12:] -= D
    assert np.linalg.eigvalsh(P)[0] > 0
    assert np.linalg.eigvalsh(N)[-1] < 0
    with pytest.raises(ComputationError, match="no single P"):
        arcs.one_matrix(form_at(case, gains, 0.06), a, b, np.zeros(25))


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
    with pytest.raises(ComputationError, match="no scaling"):
        arcs.cover(form_at(case, comparison, 0.05), 1.01, 1.0, narrowest=0.01)


def test_shared_scaling_bounds_the_pointwise_one(case, gains):
    form = form_at(case, gains, 0.05)
    points = -1.01 + np.exp(1j * np.linspace(0, np.pi, 4))
    responses = np.array([form.response(z) for z in points])
    common, _ = robust.shared_scaling(responses)
    assert common >= max(arcs.best_scaling(M)[0] for M in responses) - 1e-3


def test_original_coordinates(case, gains):
    # identity: the norm condition holds in the paper's own coordinates as in the balanced ones
    balanced = form_at(case, gains, 0.05)
    P, d = certify.back(balanced, *certify.norm_evidence(case, balanced))
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
    model = plant.rigid(plant.constants(case))
    found = lemma_3(case, lam="3", g="25").solve()
    assert isinstance(found, Solved)
    X, Y, Ah, Fb, Ch = (found[name] for name in ("X", "Y", "Ah", "Fb", "Ch"))
    U = np.eye(6) - Y @ X
    B = np.linalg.solve(U, Fb)
    A = np.linalg.solve(U, Ah - Y @ model.A @ X - Fb @ model.C @ X - Y @ model.B @ Ch)
    loop = np.block([[model.A, model.B @ Ch], [B @ model.C, A]])
    assert np.abs(np.linalg.eigvals(loop) + 1.01).max() < 1
    gain = np.hstack([model.C, np.zeros((3, 6))]) @ np.linalg.solve(-loop, np.vstack([model.B, np.zeros((6, 3))]))
    assert np.linalg.norm(gain, 2) < 5.0


def test_disk_block_certificate_and_its_refusal(case):
    found = proofs.open_loop_in_disk(case, equation_17(False, False).sub("1a", "5a"))
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


@pytest.fixture(scope="module")
def whole(case, gains):
    """All three requirements of the printed gains at 5 %."""
    evidence = certify.gather(case, gains, 0.05)
    return certify.certificate(
        case, "test", certify.PRINTED, evidence, quantity="certified.printed.delta_m", statement="A test."
    )


def refused(certificate, case, **parts):
    with pytest.raises(CertificateError) as caught:
        check(certificate.changed(**parts), case)
    return str(caught.value)


@pytest.mark.slow
def test_full_certificate_at_five_percent(case, whole):
    proof = check(whole, case)
    assert proof.conclusions[0].value == "0.05"
    found = {(p.of, p.relation, p.value) for p in proof.proved}
    # the three requirements of Table 1
    assert {("disk.radius", "less_than", "1"), ("norm.norm", "less_than", "10"), ("torque.torque", "at_most", "2")} <= (
        found
    )
    # the same numbers prove nothing of the controller of [39]
    swapped = [(n, dict(certify.COMPARISON).get(n, t)) for n, t in whole.definitions]
    refused(whole, case, definitions=swapped, data={})


@pytest.mark.slow
def test_full_certificate_refuses_forged_arcs(case, whole):
    def with_disk(**fields):
        disk, *others = whole.fields["parts"]
        return {**whole.fields, "parts": [{**disk, "fields": {**disk["fields"], **fields}}, *others]}

    ends, rows = whole.fields["parts"][0]["fields"]["arcs"], whole.witness["disk.d"]
    # a gap at the end, and one in the middle closed by stretching an arc over it with a scaling not its own
    message = refused(whole, case, fields=with_disk(arcs=ends[:-1]), witness={**whole.witness, "disk.d": rows[:-1]})
    assert "from 0 to 1" in message
    shorter = {**whole.witness, "disk.d": [rows[0], rows[-1]]}
    assert "is not proved" in refused(whole, case, fields=with_disk(arcs=["0", ends[1], "1"]), witness=shorter)
    # a wrong multiplier, and a larger variation
    wrong = [[str(100 * float(x)) if j == 3 else x for j, x in enumerate(row)] for row in rows]
    assert "arc 1" in refused(whole, case, witness={**whole.witness, "disk.d": wrong})
    larger = [(n, "0.09" if n == "dm" else t) for n, t in whole.definitions]
    refused(whole, case, definitions=larger)
    # a conclusion beyond the level
    beyond = [c.__class__(c.quantity, c.relation, "0.051", c.of) for c in whole.conclusions]
    assert "does not follow" in refused(whole, case, conclusions=tuple(beyond))


def test_every_figure_has_a_caption_and_every_point_of_the_trade_off_its_quantities(case):
    assert {figure.name for figure in FIGURES} == set(case.paper.figures)
    numbers = {int(name.removeprefix("tradeoff_")) for name in searches.TRADE_OFF}
    assert numbers == set(range(1, len(numbers) + 1))
    for number in numbers:
        assert {f"tradeoff.{number}.{what}" for what in ("delta_m", "static_gain", "norm", "disk_radius")} <= set(
            case.quantities
        )
    assert f"tradeoff.{len(numbers) + 1}.delta_m" not in case.quantities


def test_more_room_allowed_never_reaches_less(case):
    # law: whatever meets a narrower wish meets a wider one; each committed design meets its own wish
    for name, (wish, _) in searches.TRADE_OFF.items():
        measured = searches.measures(case, plant.controller(case, name))
        assert all(measured[key] <= bound for key, bound in wish.items()), name
        for other, (wider, _) in searches.TRADE_OFF.items():
            if searches._narrower(wish, wider):
                assert case.designs[name]["level"][0, 0] <= case.designs[other]["level"][0, 0], (name, other)
    widest = max(searches.TRADE_OFF, key=lambda name: case.designs[name]["level"][0, 0])
    assert all(np.array_equal(case.designs["best"][letter], case.designs[widest][letter]) for letter in "ABC")
