"""The solution of (13) behind the erratum on Theorem 2, and how firmly the printed gains fail (12)."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from gainsay.errors import CertificateError
from gainsay.lmi import Infeasible
from gainsay.proof import check
from gainsay.tables import read_case
from papers.li2021 import plant, proofs
from papers.li2021.proofs import lemma_3, printed_gains
from papers.li2021.statements import EQ12, TABLES

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def case():
    return read_case(ROOT, "li2021")


def test_point_undoes_the_congruence(case):
    """X, Y, Ah, Fb, Ch of any controller lead back to it (identities: Fa = N A_f, Fb = N B_f, P = [Y N; N -N])."""
    nominal, rng = plant.rigid(plant.constants(case)), np.random.default_rng(3)
    S, N = 2 * np.eye(6) + 0.1, -3 * np.eye(6) - 0.2
    Af, Bf, Cf = (rng.normal(size=shape) for shape in ((6, 6), (6, 3), (3, 6)))
    Y, X = S - N, np.linalg.inv(S)
    P, change = np.block([[Y, N], [N, -N]]), np.block([[X, np.eye(6)], [X, np.zeros((6, 6))]])
    loop = np.block([[nominal.A, nominal.B @ Cf], [Bf @ nominal.C, Af]])
    values = {"X": X, "Y": Y, "Ah": (change.T @ P @ loop @ change)[6:, :6], "Fb": N @ Bf, "Ch": Cf @ X}
    found = proofs.theorem_1_unknowns(case, values)
    for name, value in {"S": S, "N": N, "Fa": N @ Af, "Fb": N @ Bf, "Cf": Cf}.items():
        np.testing.assert_allclose(found[name], value, atol=1e-9)


@pytest.mark.slow
def test_certificate_holds_and_needs_a_small_variation(case):
    """The same point fails at Table 1's own delta_m = 0.05: the certificate is about the scalars that it names."""
    found = proofs.solution_of_13(case, lemma_3(case, uncertain=True, g=TABLES["g"]).by_margin().values)
    assert check(found, case).conclusions[0].relation == "holds"
    printed = [("dm", "number('delta_m')") if name == "dm" else (name, f) for name, f in found.definitions]
    with pytest.raises(CertificateError):
        check(found.changed(definitions=tuple(printed)), case)


@pytest.mark.slow
def test_digits_cut_off_in_print_do_not_decide_equation_12(case):
    """At lambda = 1 the margin by which (12) fails hardly moves over the half units of the printed gains."""
    rng, rows = np.random.default_rng(0), [row for row in EQ12.rows if row != "3"]

    def margin(gains):
        texts = {f"{letter}f": str(getattr(gains, letter).tolist()) for letter in "ABC"}
        found = printed_gains(case, *rows, **texts).by_margin()
        assert isinstance(found, Infeasible)
        return -found.farkas.value

    printed = margin(plant.controller(case, "proposed"))
    assert printed > 0
    for _ in range(3):
        moved = {}
        for letter in "ABC":
            matrix = case.printed(f"{letter}f")
            half = np.array(matrix.half_units, dtype=float)
            moved[letter] = matrix.floats + half * rng.choice((-1, 1), half.shape)
        assert margin(SimpleNamespace(**moved)) == pytest.approx(printed, rel=0.01)
