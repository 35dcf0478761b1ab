"""The contour kind against closed forms; fields that a proof would pass over."""

from fractions import Fraction
from types import SimpleNamespace

import numpy as np
import pytest
from flint import acb_mat, arb, fmpq
from scipy import linalg

from gainsay.exact.ball import precision
from gainsay.proof.kinds import contour
from tests.gainsay.proof_examples import SIMPLE, SYSTEM, A, I, make, proved, refused


def test_contour_of_a_disk_reaches_the_exact_radius():
    # (s + 1)(s + 2) + lambda = 0, |lambda| <= 1: |s + 1.5| is largest at lambda = -1, sqrt(1.25) = 1.1180...
    p = linalg.solve_discrete_lyapunov(((A + 1.5 * I) / 1.12).T, I)
    lft = {"A": SIMPLE, "H": "col(0, 1)", "Cz": "row(1, 0)", "blocks": [["full", 1, 1]], "arcs": ["0", "0.5", "1"]}
    witness = {"P": p, "d": [["1"], ["1"]]}
    certificate = make("contour", {**lft, "shift": "1.5", "radius": "1.12"}, witness)
    assert proved(certificate) == {("radius", "less_than", "1.12"), ("stable", "holds", None)}
    assert "arc 1" in refused("contour", {**lft, "shift": "1.5", "radius": "1.115"}, witness)
    refused("contour", {**lft, "arcs": ["0", "0.5"], "shift": "1.5", "radius": "1.12"}, witness)
    refused("contour", {**lft, "arcs": ["0", "0.5", "0.5", "1"], "shift": "1.5", "radius": "1.12"}, witness)
    refused("contour", {**lft, "shift": "1.5", "radius": "1.12"}, {**witness, "d": [["1"], ["-1"]]})
    refused("contour", {**lft, "shift": "1.5", "radius": "1.12"}, {**witness, "g": [["1"], ["0"]]})
    assert "D - Dw' D Dw" in refused("contour", {**lft, "Dw": "1", "shift": "1.5", "radius": "1.12"}, witness)
    refused("contour", {**lft, "arcs": ["0.25", "0.5", "1"], "shift": "1.5", "radius": "1.12"}, witness)


def test_contour_needs_the_nominal_eigenvalues_inside():
    # A = 1 stays away from the imaginary axis for |lambda| <= 1, on its wrong side
    fields = {
        "A": "1",
        "H": "0.1",
        "Cz": "1",
        "blocks": [["repeated", 1]],
        "arcs": ["0", "1"],
        "alpha": "0",
        "scale": "1",
    }
    make("contour", {**fields, "A": "-1"}, {"P": "1", "d": "1"})
    assert "nominal" in refused("contour", fields, {"P": "1", "d": "1"})


def test_contour_uses_that_a_parameter_is_real():
    # x'' = -(1 + 0.9 lambda) x - 0.2 x' is stable for real |lambda| <= 1, not for complex (|M| > 1 near resonance)
    plant = np.array([[0.0, 1.0], [-1.0, -0.2]])
    p = linalg.solve_continuous_lyapunov(plant.T, -I)
    fields = {
        "A": "[[0, 1], [-1, -0.2]]",
        "H": "col(0, 0.9)",
        "Cz": "row(-1, 0)",
        "blocks": [["repeated", 1]],
        "arcs": ["0", "1"],
        "alpha": "0",
        "scale": "1",
    }
    witness = {"P": p, "d": [["1"]], "g": [["10"]]}
    assert ("stable", "holds", None) in proved(make("contour", fields, witness))
    refused("contour", fields, {**witness, "g": [["0"]]})
    refused("contour", fields, {**witness, "g": [["-10"]]})
    refused("contour", {**fields, "H": "col(0, 1.1)"}, witness)  # unstable at lambda = -1
    refused("contour", {**fields, "blocks": [["full", 1, 1]]}, witness)


@pytest.mark.parametrize("scale", ["0.7", "1.9"])
def test_contour_sees_a_peak_between_the_ends_of_an_arc(scale):
    # |1/(1 - w^2 + 0.02 i w)| is at most 1/(0.02 sqrt(1 - 0.0001)) = 50.0025, near w = 1 alone; far below it elsewhere
    plant = np.array([[0.0, 1.0], [-1.0, -0.02]])
    fields = {"A": "[[0, 1], [-1, -0.02]]", "Cz": "row(1, 0)", "blocks": [["full", 1, 1]], "arcs": ["0", "1"],
              "alpha": "0", "scale": scale}  # fmt: skip
    witness = {"P": linalg.solve_continuous_lyapunov(plant.T, -I), "d": [["1"]]}
    assert ("stable", "holds", None) in proved(make("contour", {**fields, "H": "col(0, 0.01999)"}, witness))
    assert "arc 1" in refused("contour", {**fields, "H": "col(0, 0.02001)"}, witness)


@pytest.mark.parametrize(("shift", "end"), [("0.9", "left"), ("1.1", "right")])
def test_contour_sees_both_ends_of_the_boundary(shift, end):
    # 1/(s + 1) on |s + a| = 1 is largest, 1/0.9, at the end of the half circle that is nearest to -1, and there alone
    fields = {"A": "-1", "Cz": "1", "blocks": [["full", 1, 1]], "arcs": ["0", "1"], "shift": shift, "radius": "1"}
    assert ("radius", "less_than", "1") in proved(make("contour", {**fields, "H": "0.8999"}, {"P": "1", "d": "1"}))
    assert "arc 1" in refused("contour", {**fields, "H": "0.900001"}, {"P": "1", "d": "1"})


def arc_with(*forms):
    """An arc whose form at t = 0, 1, ... is known."""
    arc = contour._Arc.__new__(contour._Arc)
    arc.known, arc.exceeded = {t: (None, acb_mat([[form]])) for t, form in enumerate(forms)}, {}
    arc.form_unit, arc.skew, arc.plant = acb_mat([[1]]), None, SimpleNamespace(a=acb_mat([[0]]))
    return arc


def test_a_margin_that_was_proved_at_an_end_is_no_larger_one():
    arc = arc_with(2)
    assert [arc._exceeds(0, arb(loss)) for loss in (1, 3, 0.5, 1.5)] == [True, False, True, True]


def test_the_form_at_both_ends_of_a_piece_exceeds_what_lies_off_the_chord(monkeypatch):
    # off the chord by 1/10: 2/10 + 1/100 may be taken away
    monkeypatch.setattr(contour._Arc, "_from_chord", lambda self, low, high: arb(fmpq(1, 10)))
    for forms, holds in (((0.22, 0.22), True), ((0.22, 0.2), False), ((0.2, 0.22), False)):
        assert arc_with(*forms)._whole(0, 1) == holds


def test_fewer_inputs_and_outputs_leave_the_size_of_the_transfer_matrix_as_it_was():
    # 3 states, 9 inputs and 8 outputs of which one has a feedthrough; the size by numpy's singular values
    random = np.random.default_rng(4)
    a, b, c = random.normal(size=(3, 3)) - 4 * np.eye(3), random.normal(size=(3, 9)), random.normal(size=(8, 3))
    b[1] = b[0]  # of rank two alone
    d = np.zeros((8, 9))
    d[5] = random.normal(size=9)
    scales, sizes = [fmpq(k + 1, 3) for k in range(5)], [(1, 1, True)] * 4 + [(4, 3, False)]
    of_w = np.sqrt([1 / 3, 2 / 3, 1, 4 / 3, 5 / 3, 5 / 3, 5 / 3, 5 / 3, 4])
    of_z = np.sqrt([1 / 3, 2 / 3, 1, 4 / 3, 5 / 3, 5 / 3, 5 / 3, 1])
    with precision(128):
        plant = contour._Plant(*(acb_mat(m.tolist()) for m in (a, b, c, d)), arb(-1), arb(3), True)
        arc = contour._Arc(plant, scales, [fmpq(0)] * 5, sizes, (1, 1, fmpq(4)))
        assert arc.inputs.ncols() == arc.outputs.nrows() == 4
        for t in (Fraction(0), Fraction(1, 3), Fraction(1)):
            s = -1 + 3 * np.exp(1j * np.pi * float(t))
            whole = of_z[:, None] * (c @ np.linalg.solve(s * np.eye(3) - a, b) + d) / of_w
            narrow = np.array([[complex(x) for x in row] for row in arc._at(t)[0].tolist()])
            assert np.linalg.norm(narrow, 2) == pytest.approx(np.linalg.norm(whole, 2), rel=1e-12)


def test_contour_bounds_a_norm_for_every_parameter():
    # 1/(s^2 + 3 s + 2 + 0.1 lambda): largest norm 1/1.9 = 0.5263... at lambda = -1
    p = linalg.solve_continuous_lyapunov(A.T, -2 * I)
    lft = {"H": "col(0, 0.1)", "Cz": "row(1, 0)", "blocks": [["repeated", 1]], "arcs": ["0", "1"]}
    fields = {**SYSTEM, **lft, "alpha": "0", "scale": "1", "gamma": "0.528"}
    assert ("norm", "less_than", "0.528") in proved(make("contour", fields, {"P": p, "d": [["0.053"]]}))
    refused("contour", {**fields, "gamma": "0.526"}, {"P": p, "d": [["0.053"]]})


@pytest.mark.parametrize(
    ("kind", "fields", "witness", "named"),
    [
        # an uncertain system in the certificate, and a proof about the nominal one
        ("quadratic_bound", {"A": SIMPLE, "Cz": "row(1, 0)", "blocks": [["repeated", 1]]}, {"P": I}, "'H'"),
        ("quadratic_bound", {"A": SIMPLE, "Dw": "1"}, {"P": I}, "'H'"),
        ("quadratic_bound", {"A": SIMPLE, "cost": "1"}, {"P": I}, "'x0'"),
        ("unstable", {"matrix": SIMPLE, "alpha": "0", "shift": "1", "radius": "1"}, {"P": I}, "a line"),
        ("unstable", {"matrix": SIMPLE, "shift": "1"}, {"P": I}, "'radius'"),
        ("unstable", {"matrix": SIMPLE}, {"P": I}, "a line"),
        ("eigenvalues", {"matrix": SIMPLE, "measure": "abscissa", "shift": "1"}, None, "'shift'"),
        (
            "eigenvalues",
            {"matrix": SIMPLE, "measure": "radius", "shift": "1", "points": [["1", "0"]]},
            None,
            "'points'",
        ),
    ],
)
def test_fields_that_a_proof_would_pass_over_are_refused(kind, fields, witness, named):
    assert named in refused(kind, fields, witness)


@pytest.mark.parametrize(
    ("extra", "named"),
    [
        ({"alpha": "0", "scale": "1", "shift": "1", "radius": "1"}, "half plane"),
        ({"alpha": "0"}, "'scale'"),
        ({}, "half plane"),
        ({"alpha": "0", "scale": "1", "C": "row(1, 0)"}, "'gamma'"),
        ({"alpha": "0", "scale": "1", "D": "1"}, "'gamma'"),
    ],
)
def test_fields_that_a_contour_would_pass_over_are_refused(extra, named):
    fields = {"A": SIMPLE, "H": "col(0, 1)", "Cz": "row(1, 0)", "blocks": [["repeated", 1]], "arcs": ["0", "1"]}
    assert named in refused("contour", fields | extra, {"P": I, "d": [["1"]]})
