"""The solution of (13) behind the erratum on Theorem 2, and how firmly the printed gains fail (12)."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.linalg import solve_continuous_lyapunov

from gainsay.errors import CertificateError
from gainsay.lmi import solve
from gainsay.proof import check
from gainsay.tables import read_case
from papers.li2021 import conditions as lmis
from papers.li2021 import derivations_equivalence as equivalence
from papers.li2021 import plant

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def case():
    return read_case(ROOT, "li2021")


def test_point_undoes_the_congruence(case):
    """X, Y, Ah, Bh, Ch of any controller lead back to it (identities: Fa = N A_f, Fb = N B_f, P = [X N; N -N])."""
    model, rng = lmis.Model.of(case), np.random.default_rng(3)
    S, N = 2 * np.eye(6) + 0.1, -3 * np.eye(6) - 0.2
    Af, Bf, Cf = (rng.normal(size=shape) for shape in ((6, 6), (6, 3), (3, 6)))
    X, Y = S - N, np.linalg.inv(S)
    P, change = np.block([[X, N], [N, -N]]), np.block([[Y, np.eye(6)], [Y, np.zeros((6, 6))]])
    loop = np.block([[model.A, model.B @ Cf], [Bf @ model.C, Af]])
    values = {"X": X, "Y": Y, "Ah": (change.T @ P @ loop @ change)[6:, :6], "Bh": N @ Bf, "Ch": Cf @ Y}
    found = equivalence.point(model, values)
    for name, value in {"S": S, "N": N, "Fa": N @ Af, "Fb": N @ Bf, "Cf": Cf}.items():
        np.testing.assert_allclose(found[name], value, atol=1e-9)


@pytest.mark.slow
def test_certificate_holds_and_needs_a_small_variation(case):
    """The same point fails at Table 1's own delta_m = 0.05: the certificate is about the scalars that it names."""
    program = lmis.lemma3_synthesis(
        lmis.Model.of(case), case.number("lambda"), case.number("gamma"), case.number("eps1")
    )
    found = equivalence.certificate(case, solve(lmis.pushed(program)).values)
    assert check(found, case).conclusions[0].relation == "holds"
    printed = [("dm", "number('delta_m')") if name == "dm" else (name, f) for name, f in found.definitions]
    with pytest.raises(CertificateError):
        check(found.changed(definitions=tuple(printed)), case)


@pytest.mark.slow
def test_digits_cut_off_in_print_do_not_decide_equation_12(case):
    """At lambda = 1 the margin by which (12) fails hardly moves over the half units of the printed gains."""
    model, rng = lmis.Model.of(case), np.random.default_rng(0)

    def margin(gains):
        loop = plant.closed_loop(plant.rigid(plant.constants(case)), gains)
        T = np.linalg.cholesky(solve_continuous_lyapunov(loop, -np.eye(12)))
        return solve(lmis.pushed(lmis.lemma3_analysis(model, gains, case.number("lambda"), T, np.inf))).objective

    printed = margin(plant.controller(case, "proposed"))
    assert printed > 0
    for _ in range(3):
        moved = {}
        for letter in "ABC":
            matrix = case.printed(f"{letter}f")
            half = np.array(matrix.half_units, dtype=float)
            moved[letter] = matrix.floats + half * rng.choice((-1, 1), half.shape)
        assert margin(SimpleNamespace(**moved)) == pytest.approx(printed, rel=0.01)
