"""Lemma 3: a loop that satisfies (12) and has a pole outside the disk, from data that fit on a line."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from gainsay.errors import CertificateError
from gainsay.proof import check
from gainsay.tables import read_case
from papers.li2021 import plant, proofs_lemma3, statements

CASE = read_case(Path(__file__).resolve().parents[2], "li2021")
CONSTANTS = plant.constants(CASE)
#: every inertia 5 % low: Delta J2 is printed negative
DELTA = (-1, 1, -1)


def made() -> tuple[list, dict]:
    """The certificates and quantities of the task."""
    certificates, quantities = [], {}
    results = SimpleNamespace(
        case=CASE, certificate=certificates.append, prove=lambda c, **_: certificates.append(c),
        undecided=lambda *_, **__: None,
        quantity=lambda name, value, **_: quantities.update({name: value}), say=lambda *_: None,
        scan=lambda scan: quantities.update({point["disk_poles"]: value for value, point in scan.pairs}),
    )  # fmt: skip
    proofs_lemma3.disk_of_lemma_3(CASE, results)
    return certificates, quantities


def loop(share: float) -> np.ndarray:
    """(10) with an inertia off by a share of its envelope, as (7) has it: (I + E Delta W0) xi' = A_t xi."""
    k1, k2, l1, l2 = (float(proofs_lemma3.GAINS[name]) for name in ("k1", "k2", "l1", "l2"))
    eye, F, factors, rigid = np.eye(3), CONSTANTS.coupling, plant.uncertain(CONSTANTS), plant.rigid(CONSTANTS)
    order, delta = plant.uncertainty_factors(CONSTANTS), share * np.array(DELTA)
    H = np.diag([*delta[list(order.order_G)], *delta[list(order.order_D)]])
    torque = (np.diag(CONSTANTS.inertia) - F.T @ F) @ np.hstack([-k1 * eye, -k2 * eye])
    A = np.block([
        [rigid.A + factors.L @ H @ factors.K, rigid.B @ torque],
        [np.vstack([l1 * eye, l2 * eye]) @ rigid.C, np.block([[-l1 * eye, eye], [-(l2 + k1) * eye, -k2 * eye]])],
    ])  # fmt: skip
    error = np.zeros((12, 12))
    error[3:6, 3:6] = factors.E[3:, 3:] @ np.diag(delta) @ factors.W0[3:, 3:]
    return np.linalg.solve(np.eye(12) + error, A)


def light_loop() -> np.ndarray:
    """(10) with the controller of the proof, built as a satellite of that inertia, without e."""
    k1, k2, l1, l2 = (float(proofs_lemma3.GAINS[name]) for name in ("k1", "k2", "l1", "l2"))
    eye, kept = np.eye(3), np.diag(CONSTANTS.inertia) - CONSTANTS.coupling.T @ CONSTANTS.coupling
    gains = plant.Gains(
        A=np.block([[-l1 * eye, eye], [-(l2 + k1) * eye, -k2 * eye]]),
        B=np.vstack([l1 * eye, l2 * eye]),
        C=kept @ np.hstack([-k1 * eye, -k2 * eye]),
    )
    light = tuple(j + d * e for j, d, e in zip(CONSTANTS.inertia, DELTA, CONSTANTS.envelope, strict=True))
    return plant.closed_loop(plant.rigid(replace(CONSTANTS, inertia=light)), gains)


def reach(A: np.ndarray) -> float:
    return np.abs(np.linalg.eigvals(A) + 1.01).max()


def test_the_loop_of_an_inertia_that_is_5_percent_low_leaves_the_disk():
    assert reach(loop(0.0)) < 0.9  # well inside where the inertia is right
    assert reach(loop(1.0)) > 1.0
    assert light_loop() == pytest.approx(loop(1.0), abs=1e-12)


def test_the_poles_of_a_tilde_alone_keep_the_disk():
    _, quantities = made()
    plain = loop(1.0)
    error = np.zeros((12, 12))
    factors = plant.uncertain(CONSTANTS)
    error[3:6, 3:6] = factors.E[3:, 3:] @ np.diag(DELTA) @ factors.W0[3:, 3:]
    assert quantities["nominal"] == pytest.approx(reach((np.eye(12) + error) @ plain), abs=1e-9)
    assert quantities["nominal"] < 1 < quantities["loop"] == quantities["lemma3.disk_reach"]


def test_both_halves_are_proved():
    certificates, quantities = made()
    said = {c.quantity: c for certificate in certificates for c in check(certificate, CASE).conclusions if c.quantity}
    assert said["lemma3.eq12"].relation == "holds"
    assert said["lemma3.disk_reach"].relation == "greater_than" and said["lemma3.disk_reach"].value == "1.003"
    assert quantities["lemma3.disk_reach"] == pytest.approx(reach(loop(1.0)), abs=1e-9)


def test_a_pole_is_not_said_to_lie_farther_than_it_does(monkeypatch):
    monkeypatch.setattr(proofs_lemma3, "REACH", "1.01")
    with pytest.raises(CertificateError):
        made()


def test_a_controller_that_keeps_the_disk_does_not_refute_the_lemma(monkeypatch):
    """With the slow observer pole at -1.8 (l1 = 2.34, l2 = 0.972) the light satellite stays inside."""
    monkeypatch.setattr(proofs_lemma3, "GAINS", {"k1": "0.36", "k2": "1.3", "l1": "2.34", "l2": "0.972"})
    assert reach(loop(1.0)) < 1.0
    with pytest.raises(CertificateError):
        made()


def corrected() -> list:
    certificates = []
    results = SimpleNamespace(prove=lambda c, **_: certificates.append(c), say=lambda *_: None)
    proofs_lemma3.corrected_disk(CASE, results)
    return certificates


def test_as_corrected_12_keeps_the_poles_in_the_disk_for_every_inertia(monkeypatch):
    (certificate,) = corrected()
    assert [c.relation for c in check(certificate, CASE).conclusions] == ["holds"]
    monkeypatch.setattr(proofs_lemma3, "EQ12_CORRECTED", statements.EQ12)
    with pytest.raises(CertificateError):
        corrected()
