"""Requirements proved together at a level: what the parts give, and what is refused."""

import numpy as np
import pytest
from scipy import linalg

from gainsay.errors import CertificateError
from gainsay.proof import MappingTables, build, check

TABLES = MappingTables(
    numbers={"radius": "1.5", "gamma": "2"}, printed={"A": [["0.000", "1.000"], ["-2.000", "-3.000"]]}
)
A = np.array([[0.0, 1.0], [-2.0, -3.0]])
CHANNELS = {"A": "A", "H": "col(0, level)", "Cz": "row(1, 0)", "blocks": [["repeated", 1]]}
DISK = {
    "name": "disk",
    "kind": "contour",
    "fields": {**CHANNELS, "arcs": ["0", "0.5", "1"], "shift": "number('radius')", "radius": "b"},
}
NORM = {
    "name": "norm",
    "kind": "robust_norm",
    "fields": {**CHANNELS, "B": "col(0, 1)", "C": "row(1, 0)", "gamma": "number('gamma')"},
}
STEIN = linalg.solve_discrete_lyapunov(((A + 1.5 * np.eye(2)) / 1.5).T, np.eye(2))
# bounded real lemma with multiplier one at level 0.5: both channels enter the second state, 1/4 + 1/4
RICCATI = linalg.solve_continuous_are(A, [[0.0], [1.0]], np.diag([2.05, 0.05]), [[-2.0]])
WITNESS = {
    "disk.P": (STEIN + STEIN.T) / 2,
    "disk.d": [["1"], ["1"]],
    "norm.P": (RICCATI + RICCATI.T) / 2,
    "norm.D1": "1",
}


def made(parts=(DISK, NORM), level="0.5", witness=WITNESS, field="level", quantity="level"):
    return build.certificate(
        "level",
        id="a",
        statement="s",
        tables=TABLES,
        definitions={"level": level, "A": "printed('A')", "b": "number('radius')"},
        fields={"level": field, "parts": list(parts)},
        witness=witness,
        quantities={quantity: "x"},
    )


def refused(**changes):
    with pytest.raises(CertificateError) as caught:
        made(**changes)
    return str(caught.value)


def test_every_part_speaks_of_the_level():
    certificate = made()
    found = {(p.of, p.relation, p.value) for p in check(certificate, TABLES).proved}
    assert found == {
        ("level", "at_least", "0.5"),
        ("disk.radius", "less_than", "1.5"),
        ("disk.stable", "holds", None),
        ("norm.norm", "less_than", "2"),
        ("norm.stable", "holds", None),
    }
    # what the parts read is among the data: another table is another certificate
    assert set(certificate.data) == {"number", "printed"}
    other = MappingTables(
        numbers={"radius": "1.4", "gamma": "2"}, printed={"A": [["0.000", "1.000"], ["-2.000", "-3.000"]]}
    )
    with pytest.raises(CertificateError, match="radius"):
        check(certificate, other)


def test_a_level_that_one_part_cannot_meet_is_refused():
    # closed form: s^2 + 3 s + 2 + 2.1 lambda is unstable at lambda = -1
    assert "a, disk" in refused(level="2.1")
    # the norm at lambda = -1 is 1 / (2 - 1.6) = 2.5, above 2, the poles still inside
    assert "a, norm" in refused(level="1.6")
    made(parts=(DISK,), level="1.6", witness={k: v for k, v in WITNESS.items() if k.startswith("disk")})


def test_parts_that_are_not_what_they_should_be_are_refused():
    assert "not a definition" in refused(field="0.9")
    assert "not a definition" in refused(field="lvl")
    assert "different name" in refused(parts=(DISK, {**NORM, "name": "disk"}))
    assert "expected one of" in refused(parts=(DISK, {**NORM, "kind": "nothing"}))
    assert "proves no requirement met" in refused(parts=({**DISK, "kind": "level"}, NORM))
    trivial = {"name": "disk", "kind": "definite", "fields": {"constraint": "level > 0"}}
    assert "proves no requirement met" in refused(parts=(trivial, NORM))
    assert "belongs to no part" in refused(parts=(DISK,))
    assert "missing" in refused(witness={k: v for k, v in WITNESS.items() if k != "norm.P"})
    assert "unknown field" in refused(parts=(DISK, {**NORM, "fields": {**NORM["fields"], "extra": "1"}}))
    assert "'gamma' is missing" in refused(parts=(DISK, {**NORM, "fields": {**CHANNELS, "B": "1", "C": "1"}}))
    assert "expected name, kind and fields" in refused(parts=())
    assert "expected name, kind and fields" in refused(parts=(DISK, {"name": "norm"}))


def test_a_level_speaks_of_the_tables_own_requirements():
    """With a wider disk or a higher norm than the paper's any level is reached: that is no level of the paper's."""
    for part, field, value in (
        (DISK, "radius", "1000"),
        (DISK, "shift", "2 * number('radius')"),
        (DISK, "radius", "1000*b"),
        (NORM, "gamma", "1e9"),
        (NORM, "gamma", "number('gamma') + 1"),
        (NORM, "gamma", "level"),
    ):
        changed = {**part, "fields": {**part["fields"], field: value}}
        parts = (changed, NORM) if part is DISK else (DISK, changed)
        assert "entry of the parameter table" in refused(parts=parts)
    torque = {"A": "A", "x0": "col(1, 0)", "inputs": [{"of": "u", "row": "level * row(1, 0)", "bound": "1e6"}]}
    part = {"name": "torque", "kind": "quadratic_bound", "fields": torque}
    assert "bound is '1e6'" in refused(parts=(DISK, NORM, part))


def test_every_part_depends_on_the_level():
    fixed = {**DISK, "fields": {**DISK["fields"], "H": "col(0, 0.5)"}}
    assert "does not depend on the level" in refused(parts=(fixed, NORM), level="0.9")
    assert "does not depend" in refused(parts=({**fixed, "fields": {**fixed["fields"], "D": "level0"}}, NORM))


def test_what_stays_on_faith_names_the_smaller_levels():
    assert any("smaller level" in sentence for sentence in check(made(), TABLES).faith)


class WithRequirements(MappingTables):
    """Tables in which the quantity x is a level of some requirements."""

    def __init__(self, *wanted):
        super().__init__(
            numbers={"radius": "1.5", "gamma": "2"}, printed={"A": [["0.000", "1.000"], ["-2.000", "-3.000"]]}
        )
        self.wanted = frozenset(wanted)

    def requirements(self, quantity):
        return self.wanted if quantity == "x" else frozenset()


def test_a_level_concludes_on_a_quantity_of_its_own_requirements_alone():
    certificate = made()
    own = ("radius=radius", "shift=radius", "gamma=gamma")
    assert check(certificate, WithRequirements(*own)).conclusions
    for other in (own[:2], (*own, "bound=gamma"), ("radius=gamma", "shift=radius", "gamma=radius"), ()):
        with pytest.raises(
            CertificateError, match="what is required is gamma=gamma; radius=radius; shift=radius, and of"
        ):
            check(certificate, WithRequirements(*other))


def test_a_proof_that_requires_nothing_concludes_on_no_level():
    fields = {"constraint": "number('gamma') > 0"}
    quantities = {"definite": "x"}
    plain = build.certificate("definite", id="a", statement="s", tables=TABLES, fields=fields, quantities=quantities)
    assert check(plain, WithRequirements()).conclusions
    with pytest.raises(CertificateError, match="what is required is nothing, and of 'x'"):
        check(plain, WithRequirements("gamma=gamma"))


def test_a_part_that_proves_a_requirement_missed_is_no_part():
    """A gain above gamma, an eigenvalue outside the disk: their levels are named as the requirements are."""
    gain = {"A": "A", "B": "col(0, 100 * level)", "C": "row(1, 0)", "frequency": "0", "gamma": "number('gamma')"}
    outside = {"matrix": "level * A", "shift": "number('radius')", "radius": "number('radius')"}
    for part, witness in (
        ({"name": "norm", "kind": "norm_at_least", "fields": gain}, {"norm.u": [["1", "0"]]}),
        (
            {"name": "disk", "kind": "unstable", "fields": outside},
            {"disk.P": [["-1", "0"], ["0", "-1"]], "disk.z": [["1"], ["0"]]},
        ),
    ):
        assert "proves no requirement met" in refused(parts=(part,), level="1000", witness=witness)


def test_what_is_no_formula_makes_no_part_depend_on_the_level():
    """A label, or the sort of a block, that reads like the level's name."""
    inputs = [{"of": "level", "row": "row(1, 0)", "bound": "number('gamma')"}]
    torque = {"name": "torque", "kind": "quadratic_bound", "fields": {"A": "A", "x0": "col(0.1, 0)", "inputs": inputs}}
    assert "does not depend on the level" in refused(parts=(torque,), level="1000", witness={"torque.P": np.eye(2)})
    fixed = {**DISK["fields"], "H": "col(0, 0.5)"}
    with pytest.raises(CertificateError, match="does not depend on the level"):
        build.certificate(
            "level",
            id="a",
            statement="s",
            tables=TABLES,
            definitions={"repeated": "1000", "A": "printed('A')", "b": "number('radius')"},
            fields={"level": "repeated", "parts": [{**DISK, "fields": fixed}]},
            witness={k: v for k, v in WITNESS.items() if k.startswith("disk")},
            quantities={"level": "x"},
        )
