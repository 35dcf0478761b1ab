"""Ready proofs of a loop, on matrices whose poles and norms are known by hand."""

import pytest

from gainsay.errors import CertificateError, InputError
from gainsay.proof import check
from gainsay.proof.scope import MappingTables
from gainsay.systems import loop_proofs
from gainsay.systems.norm_proofs import prove_norm

CASE = MappingTables(numbers={"damping": "3"}, printed={"A": [["0", "1"], ["-2", "-3"]]})
#: (s + 1) (s + 2); the same from a number; and an oscillator whose poles 1 +- 2j are unstable
STABLE = {"A": "printed('A')", "same": "[[0, 1], [-2, -number('damping')]]", "wild": "[[1, 2], [-2, 1]]"}
PARTS = {"definitions": STABLE, "id": "a", "statement": "s"}


def concluded(certificate):
    assert check(certificate, CASE)
    return {(c.of, c.relation): c.value for c in certificate.conclusions}


@pytest.mark.parametrize("matrix", ["A", "same"])
def test_poles_left_of_a_line_are_proved_and_others_refused(matrix):
    proved = loop_proofs.poles_left_of(CASE, matrix, "-0.9", quantities={"abscissa": "q"}, **PARTS)
    assert concluded(proved) == {("abscissa", "less_than"): "-0.9"}
    with pytest.raises(InputError, match="outside the half plane"):
        loop_proofs.poles_left_of(CASE, matrix, "-1.1", **PARTS)


def test_poles_in_a_disk_around_their_middle():
    """The poles -1 and -2 are 1/2 from -3/2."""
    proved = loop_proofs.poles_in_disk(CASE, "A", "3/2", "0.51", quantities={"radius": "q"}, **PARTS)
    assert concluded(proved) == {("radius", "less_than"): "0.51"}
    with pytest.raises(InputError, match="outside the disk"):
        loop_proofs.poles_in_disk(CASE, "A", "3/2", "0.49", **PARTS)


def test_a_pole_on_the_wrong_side_is_proved():
    right = loop_proofs.pole_right_of(CASE, "wild", "0.99", quantities={"abscissa": "q"}, **PARTS)
    assert concluded(right) == {("abscissa", "greater_than"): "0.99"}
    far = loop_proofs.pole_outside_disk(CASE, "A", "0", "1.5", quantities={"radius": "q"}, **PARTS)
    assert concluded(far) == {("radius", "greater_than"): "1.5"}
    for refused in (
        lambda: loop_proofs.pole_right_of(CASE, "wild", "1.01", **PARTS),
        lambda: loop_proofs.pole_outside_disk(CASE, "A", "3/2", "0.51", **PARTS),
    ):
        with pytest.raises(CertificateError):
            refused()


def test_measures_of_the_spectrum_are_enclosed():
    low, high = concluded(loop_proofs.abscissa(CASE, "wild", quantity="q", **PARTS))["abscissa", "inside"].split("..")
    assert eval(low) <= 1 <= eval(high)
    points = [["-1.25", "0"], ["-2", "0"]]
    apart = concluded(loop_proofs.pole_distance(CASE, "A", points, quantity="q", **PARTS))["matching", "inside"]
    low, high = apart.split("..")
    assert eval(low) <= 0.25 <= eval(high)


def test_a_norm_is_bounded_above_its_value_alone():
    """1 + 2 / (s^2 + 3 s + 2) falls from 2 at rest to 1; without the 1 it is 1 at rest."""
    system = {"A": "A", "B": "[[0], [1]]", "C": "[[2, 0]]"}
    for formulas, norm in ((system, 1.0), ({**system, "D": "1"}, 2.0)):
        proved = loop_proofs.norm_below(CASE, formulas, f"{1.001 * norm}", quantities={"norm": "q"}, **PARTS)
        assert [c.relation for c in proved.conclusions] == ["less_than"]
        with pytest.raises(InputError, match="at or below"):
            loop_proofs.norm_below(CASE, formulas, f"{0.999 * norm}", **PARTS)
    with pytest.raises(CertificateError, match="nothing"):
        loop_proofs.values(CASE, ["nothing + 1"], STABLE)


class Kept:
    """Results that keep what they are given."""

    def __init__(self):
        self.case, self.proved = CASE, []

    def prove(self, certificate, *, source, values):
        self.proved.append((certificate, source, values))


@pytest.mark.parametrize(("norm", "value"), [("hinf", 1.0), ("h2", (1 / 3) ** 0.5)])
def test_a_norm_stands_beside_the_proof_of_its_bound(norm, value):
    """Of 2 / (s^2 + 3 s + 2): 1 at rest; the square of the other is 4/(2 * 2 * 3), that of b/(s^2 + a1 s + a0)."""
    system, results = {"A": "A", "B": "[[0], [1]]", "C": "[[2, 0]]"}, Kept()
    prove_norm(results, "audit.norm", norm, system, f"{1.001 * value}", definitions=STABLE, source="(1)")
    ((certificate, source, found),) = results.proved
    assert certificate.id == "audit-norm"
    assert source == "(1)"
    assert found == {"audit.norm": pytest.approx(value, rel=1e-9)}
    assert [c.quantity for c in certificate.conclusions if c.of == "norm"] == ["audit.norm"]
    concluded(certificate)
    with pytest.raises(InputError, match="at or below"):
        prove_norm(results, "audit.norm", norm, system, f"{0.999 * value}", definitions=STABLE)


def test_a_certificate_without_an_id_has_that_of_its_quantity():
    made = loop_proofs.abscissa(CASE, "A", definitions=STABLE, statement="s", quantity="audit.slowest_pole")
    assert made.id == "audit-slowest-pole"
    with pytest.raises(CertificateError, match="needs an id"):
        loop_proofs.poles_left_of(CASE, "A", "0", definitions=STABLE, statement="s")


def test_an_h2_norm_is_enclosed():
    """1 / (s + 1) has the norm sqrt(1/2) = 0.70710678."""
    system = {"A": "-eye(1)", "B": "eye(1)", "C": "eye(1)"}
    proved = loop_proofs.h2_norm_below(CASE, system, "0.70711", lower="0.70710", quantities={"norm": "q"}, **PARTS)
    assert concluded(proved) == {("norm", "at_most"): "0.70711", ("norm", "at_least"): "0.7071"}
    for low, high in (("0.7072", "0.7073"), ("0.7070", "0.7071")):
        with pytest.raises(InputError, match="the H2 norm"):
            loop_proofs.h2_norm_below(CASE, system, high, lower=low, **PARTS)
