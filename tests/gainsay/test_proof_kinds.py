"""Every kind of proof on examples with closed forms, and the same examples made false."""

from fractions import Fraction

import numpy as np
import pytest
from flint import fmpq, fmpq_poly
from hypothesis import given
from hypothesis import strategies as st
from scipy import linalg

from gainsay.errors import CertificateError
from gainsay.proof import build, check
from gainsay.proof.kinds.positive_on_interval import roots_between
from tests.gainsay.proof_examples import SIMPLE, SYSTEM, TABLES, A, I, make, proved, refused


def test_identity_with_and_without_relations():
    unknowns = {"c": {}, "s": {}, "X": {"shape": [2, 2], "structure": "symmetric"}}
    rotation = [("R", "[[c, -s], [s, c]]")]
    make("identity", {"left": "(X@X).T", "right": "X@X"}, unknowns=unknowns)
    fields = {"left": "R.T@R", "right": "eye(2)", "modulo": ["c**2 + s**2 - 1"]}
    point = {"c": "3/5", "s": "4/5", "X": [["0", "0"], ["0", "0"]]}
    certificate = make("identity", fields, point, unknowns=unknowns, definitions=rotation)
    assert proved(certificate) == {("identity", "holds", None)}
    del fields["modulo"]
    assert "row 1, column 1" in refused("identity", fields, unknowns=unknowns, definitions=rotation)
    assert "row 1, column 2" in refused("identity", {"left": "X", "right": "diag(X[0,0], X[1,1])"}, unknowns=unknowns)
    refused("identity", {"left": "sqrt(2)", "right": "sqrt(2)"})


def test_different_needs_a_point():
    unknowns = {"e": {}}
    fields = {"left": "e**2", "right": "2*e"}
    assert proved(make("different", fields, {"e": "1"}, unknowns=unknowns)) == {("identity", "fails", None)}
    refused("different", fields, {"e": "2"}, unknowns=unknowns)  # 4 = 4
    make("different", {"left": "sqrt(2)", "right": "1.4142"})
    refused("different", {"left": "sqrt(2)**2", "right": "2"})


def test_definite_and_not_definite():
    make("definite", {"constraint": "[[2, sqrt(2)], [..., 1.001]] > 0"})  # determinant 2.002 - 2
    refused("definite", {"constraint": "[[2, sqrt(2)], [..., 0.999]] > 0"})
    make("definite", {"constraint": "[[2, 2], [..., 2]] >= 0"})
    refused("definite", {"constraint": "[[2, 2], [..., 2]] > 0"})
    refused("definite", {"constraint": "[[2, 2], [0, 2]] > 0"})
    assert "not symmetric" in refused("definite", {"constraint": "[[2, sqrt(2)], [0, 2]] > 0"})
    assert "an inequality" in refused("definite", {"constraint": "[[0, 1], [-1, 0]] == [[0, 1], [-1, 0]]"})
    make("not_definite", {"constraint": "[[2, 2], [..., 2]] > 0"}, {"z": [1, -1]})
    refused("not_definite", {"constraint": "[[2, 2], [..., 2]] >= 0"}, {"z": [1, -1]})
    refused("not_definite", {"constraint": "[[2, 2], [..., 2]] > 0"}, {"z": [0, 0]})
    make("not_definite", {"constraint": "[[-1, 0], [0, 1]] < 0"}, {"z": [0, 1]})
    refused("not_definite", {"constraint": "[[-1, 0], [0, 1]] < 0"}, {"z": [1, 0]})


@pytest.mark.parametrize("matrix", [SIMPLE, "printed('A')", "box('A')"])
def test_lyapunov(matrix):
    # eigenvalues -1 and -2, so the abscissa is -1; within half a unit of the third decimal still below -0.9
    p = linalg.solve_continuous_lyapunov((A + 0.9 * I).T, -I)
    certificate = make("lyapunov", {"matrix": matrix, "alpha": "-0.9"}, {"P": p})
    assert proved(certificate) == {("abscissa", "less_than", "-0.9"), ("stable", "holds", None)}
    refused(
        "lyapunov", {"matrix": matrix, "alpha": "-1.1"}, {"P": linalg.solve_continuous_lyapunov((A + 1.1 * I).T, -I)}
    )
    assert "P > 0" in refused("lyapunov", {"matrix": matrix, "alpha": "-0.9"}, {"P": -p})


def test_lyapunov_over_a_polytope():
    # s^2 + k s + 1 is Hurwitz for each vertex, and x' diag(1, 1) x does not grow: P = I plus a small cross term
    p = np.array([[1.0, 0.1], [0.1, 1.0]])
    vertices = ["[[0, 1], [-1, -1]]", "[[0, 1], [-1, -2]]"]
    make("lyapunov", {"matrix": vertices, "alpha": "0"}, {"P": p})
    refused("lyapunov", {"matrix": [*vertices, "[[0, 1], [1, -2]]"], "alpha": "0"}, {"P": p})


def test_lyapunov_with_equality_is_at_most():
    certificate = make("lyapunov", {"matrix": "[[0, 1], [-1, 0]]", "alpha": "0"}, {"P": [["1", "0"], ["0", "1"]]})
    assert proved(certificate) == {("abscissa", "at_most", "0")}


def test_stein():
    # |s + 1.5| = 0.5 for both eigenvalues
    p = linalg.solve_discrete_lyapunov(((A + 1.5 * I) / 0.6).T, I)
    certificate = make("stein", {"matrix": "printed('A')", "shift": "1.5", "radius": "0.6"}, {"P": p})
    assert proved(certificate) == {("radius", "less_than", "0.6"), ("stable", "holds", None)}
    refused("stein", {"matrix": "printed('A')", "shift": "1.5", "radius": "0.4"}, {"P": p})
    refused("stein", {"matrix": "printed('A')", "shift": "1.5", "radius": "-0.6"}, {"P": p})


def test_descriptor_disk():
    # E^-1 A has the eigenvalues of the printed A: |s + 1.5| = 0.5 for both
    e = np.array([[2.0, 1.0], [0.0, 4.0]])
    fields = {"matrix": "M @ printed('A')", "descriptor": "M", "shift": "1.5", "radius": "0.6"}
    more = {"definitions": [("M", "[[2, 1], [0, 4]]")]}
    p = linalg.solve_discrete_lyapunov(((A + 1.5 * I) / 0.6).T, I)
    witness = {"P": p, "K": np.linalg.inv(e)}
    certificate = make("descriptor_disk", fields, witness, **more)
    assert proved(certificate) == {("radius", "less_than", "0.6"), ("stable", "holds", None)}
    for change in ({"radius": "0.4"}, {"radius": "-0.6"}, {"shift": "0"}, {"descriptor": "-M"}, {"descriptor": "0*M"}):
        refused("descriptor_disk", {**fields, **change}, witness, **more)
    assert "b^2 P > 0" in refused("descriptor_disk", fields, {**witness, "P": -p}, **more)
    refused("descriptor_disk", fields, {**witness, "K": e}, **more)
    refused("descriptor_disk", {**fields, "descriptor": "row(M, M)"}, witness, **more)
    refused("descriptor_disk", {**fields, "matrix": "col(M, M)", "descriptor": "col(M, M)"}, witness, **more)


def test_descriptor_disk_over_a_box():
    """m x' = -k x: the pole -k / m lies in |s + 1| < b for every m and k of a box, or not, at k = 1.1 and m = 0.9."""
    farthest = 1.1 / 0.9 - 1
    fields = {"matrix": "-k", "descriptor": "m", "shift": "1", "ranges": [["m", "0.9", "1.1"], ["k", "0.9", "1.1"]]}
    for radius, holds in ((farthest + 0.04, True), (farthest - 1e-6, False)):
        (make if holds else refused)("descriptor_disk", {**fields, "radius": f"{radius:.9f}"}, {"P": "1", "K": "1"})
    # m may vanish
    refused(
        "descriptor_disk", {**fields, "radius": "9", "ranges": [["m", "0", "1"], ["k", "1", "1"]]}, {"P": "1", "K": "2"}
    )
    # affine in each number, the others held, is what the corners need
    make("descriptor_disk", {**fields, "matrix": "-k*m", "radius": "0.2"}, {"P": "1", "K": "1"})
    assert "k**2" in refused("descriptor_disk", {**fields, "matrix": "-k*k", "radius": "0.9"}, {"P": "1", "K": "1"})


def test_unstable_by_inertia():
    plant = np.array([[0.0, 1.0], [2.0, -1.0]])  # eigenvalues 1 and -2
    fields = {"matrix": "[[0, 1], [2, -1]]", "alpha": "0.9"}
    p = linalg.solve_continuous_lyapunov((plant - 0.9 * I).T, -I)
    z = np.linalg.eigh(p)[1][:, 0]
    certificate = make("unstable", fields, {"P": p, "z": z})
    assert proved(certificate) == {("abscissa", "greater_than", "0.9"), ("stable", "fails", None)}
    refused("unstable", fields, {"P": p, "z": np.linalg.eigh(p)[1][:, 1]})
    refused(
        "unstable", {**fields, "alpha": "1.1"}, {"P": linalg.solve_continuous_lyapunov((plant - 1.1 * I).T, -I), "z": z}
    )
    disk = {"matrix": "[[0, 1], [2, -1]]", "shift": "0", "radius": "1.5"}
    p = linalg.solve_discrete_lyapunov((plant / 1.5).T, I)
    certificate = make("unstable", disk, {"P": p, "z": np.linalg.eigh(p)[1][:, 0]})
    assert proved(certificate) == {("radius", "greater_than", "1.5")}


def test_not_an_eigenvalue_over_a_box():
    found = proved(make("not_an_eigenvalue", {"matrix": "box('A')", "real": "-1.5", "imaginary": "0.5"}))
    distance = next(Fraction(v) for of, _, v in found if of == "distance")
    # nearest eigenvalues -1 and -2: |0.5 + 0.5 i|, less what the box moves them (below 0.01)
    assert 0 < distance < Fraction("0.71")
    refused("not_an_eigenvalue", {"matrix": "box('A')", "real": "-1.001", "imaginary": "0"})
    refused("not_an_eigenvalue", {"matrix": "printed('A')", "real": "-1", "imaginary": "0"})


@pytest.mark.parametrize(
    ("measure", "more", "expected"),
    [
        ("abscissa", {}, "-1"),
        ("radius", {"shift": "1.2"}, "0.8"),
        ("nearest", {"points": [["-1", "0.25"]]}, "0.25"),
        ("matching", {"points": [["-2", "0.5"], ["-1", "-0.25"]]}, "0.5"),
        ("matching", {"points": [["-1", "0"], ["-1", "0"]]}, "1"),  # both near -1: one must take -2
    ],
)
def test_eigenvalue_measures(measure, more, expected):
    ((_, _, value),) = proved(make("eigenvalues", {"matrix": SIMPLE, "measure": measure, **more}))
    low, high = (Fraction(x) for x in value.split(".."))
    assert low <= Fraction(expected) <= high
    assert high - low < Fraction("1e-15")


def test_eigenvalues_refuse_what_they_cannot_enclose():
    refused("eigenvalues", {"matrix": "[[1, 1], [0, 1]]", "measure": "abscissa"})
    refused("eigenvalues", {"matrix": SIMPLE, "measure": "median"})
    refused("eigenvalues", {"matrix": SIMPLE, "measure": "matching", "points": [["0", "0"]]})


B, C = np.array([[0.0], [1.0]]), np.array([[1.0, 0.0]])


def test_bounded_real_and_its_lower_bound():
    level = 0.5001
    p = linalg.solve_continuous_are(A, B, C.T @ C + 1e-7 * I, -(level**2) * np.eye(1))
    certificate = make("bounded_real", {**SYSTEM, "gamma": "0.5001"}, {"P": p})
    assert proved(certificate) == {("norm", "less_than", "0.5001"), ("stable", "holds", None)}
    refused("bounded_real", {**SYSTEM, "gamma": "0.4999"}, {"P": p})
    refused("bounded_real", {**SYSTEM, "D": "1", "gamma": "0.5001"}, {"P": p})
    # a system that is its feedthrough alone: norm 1
    still = {"A": "-1", "B": "0", "C": "0", "D": "1"}
    make("bounded_real", {**still, "gamma": "1.001"}, {"P": "1"})
    refused("bounded_real", {**still, "gamma": "0.999"}, {"P": "1"})
    make("norm_at_least", {**SYSTEM, "frequency": "0", "gamma": "0.5"}, {"u": [[1, 0]]})
    refused("norm_at_least", {**SYSTEM, "frequency": "0", "gamma": "0.50001"}, {"u": [[1, 0]]})
    # |G(i)| = 1/sqrt(2 * 5)
    make("norm_at_least", {**SYSTEM, "frequency": "1", "gamma": "0.3162"}, {"u": [[0.5, -2]]})
    refused("norm_at_least", {**SYSTEM, "frequency": "1", "gamma": "0.3163"}, {"u": [[0.5, -2]]})
    refused("norm_at_least", {**SYSTEM, "frequency": "1", "gamma": "0"}, {"u": [[0, 0]]})


def test_h2():
    # 1/(s^2 + a s + b): squared norm 1/(2 a b) = 1/12, norm 0.288675...
    p = linalg.solve_continuous_lyapunov(A.T, -C.T @ C - 1e-6 * I)
    s = linalg.solve_continuous_lyapunov(A.T, -C.T @ C + 1e-6 * I)
    fields = {**SYSTEM, "bound": "0.28868", "lower": "0.28867"}
    found = proved(make("h2", fields, {"P": p, "S": s}))
    assert {("norm", "at_most", "0.28868"), ("norm", "at_least", "0.28867")} <= found
    refused("h2", {**fields, "bound": "0.28867"}, {"P": p, "S": s})
    refused("h2", {**fields, "lower": "0.28868"}, {"P": p, "S": s})


def test_quadratic_bound_of_an_uncertain_spring():
    # x'' = -(2 + 0.1 lambda) x - 3 x'
    p = linalg.solve_continuous_lyapunov(A.T, -2 * I)
    fields = {
        "A": SIMPLE,
        "Q": "eye(2)",
        "x0": "col(1, 0)",
        "cost": "2.5",
        "H": "col(0, 0.1)",
        "Cz": "row(1, 0)",
        "blocks": [["repeated", 1]],
        "inputs": [{"of": "torque", "row": "row(0.1, 0.1)", "bound": "0.5"}],
    }
    witness = {"P": p, "D1": "0.5"}
    # P from A'P + PA = -2 I has P11 = 5/2 in closed form
    assert abs(p[0, 0] - 2.5) < 1e-12
    found = proved(make("quadratic_bound", fields, {"P": [["2.5", "0.5"], ["0.5", "0.5"]], "D1": "0.5"}))
    assert found == {("cost", "at_most", "2.5"), ("torque", "at_most", "0.5"), ("stable", "holds", None)}
    refused("quadratic_bound", {**fields, "cost": "2.49"}, witness)
    refused("quadratic_bound", {**fields, "H": "col(0, 3)"}, witness)  # unstable at lambda = -1
    refused("quadratic_bound", {**fields, "inputs": [{"of": "u", "row": "row(0.1, 0.1)", "bound": "0.1"}]}, witness)
    refused("quadratic_bound", fields, {"P": p, "D1": "-0.5"})
    refused("quadratic_bound", {**fields, "Q": "-eye(2)"}, witness)
    refused("quadratic_bound", {**fields, "blocks": [["repeated", 2]]}, witness)


def test_quadratic_bound_without_uncertainty_gives_the_lyapunov_cost():
    fields = {"A": SIMPLE, "Q": "2*eye(2)", "x0": "col(1, 0)", "cost": "2.5"}
    # integral of 2 |x|^2 = x0' P x0 with A'P + PA = -2 I, exactly P11 = 5/2
    assert proved(make("quadratic_bound", fields, {"P": [["2.5", "0.5"], ["0.5", "0.5"]]})) == {
        ("cost", "at_most", "2.5")
    }
    refused("quadratic_bound", fields, {"P": [["2.4", "0.5"], ["0.5", "0.5"]]})


@pytest.mark.parametrize("starts", ["[[1, 0], [0, 2]]", "[[0, 1], [2, 0]]"])
def test_quadratic_bound_of_several_starts_is_that_of_the_worst_in_whichever_column(starts):
    # x0' P x0 is 5/2 from (1, 0) and 2 from (0, 2), by hand
    fields = {"A": SIMPLE, "Q": "2*eye(2)", "x0": starts, "cost": "2.5"}
    witness = {"P": [["2.5", "0.5"], ["0.5", "0.5"]]}
    assert proved(make("quadratic_bound", fields, witness)) == {("cost", "at_most", "2.5")}
    refused("quadratic_bound", {**fields, "cost": "2.4"}, witness)


@pytest.mark.parametrize("names", [("cost",), ("stable",), ("u", "u")])
def test_a_bounded_input_has_a_name_of_its_own(names):
    """What is proved of one input must not read as proved of another, or as the cost: x' = -x from 1."""
    inputs = [{"of": name, "row": f"{10**-k}", "bound": f"{10**-k}"} for k, name in enumerate(names)]
    fields = {"A": "-1", "Q": "1", "x0": "1", "cost": "0.5", "inputs": inputs}
    assert "is taken" in refused("quadratic_bound", fields, {"P": "0.5"})
    accepted = [{**entry, "of": f"u{k}"} for k, entry in enumerate(inputs)]
    make("quadratic_bound", {**fields, "inputs": accepted}, {"P": "0.5"})


def test_robust_disk_and_norm():
    p = linalg.solve_discrete_lyapunov(((A + 1.7 * I) / 1.2).T, I)
    lft = {"H": "col(0, 0.1)", "Cz": "row(1, 0)", "blocks": [["full", 1, 1]]}
    fields = {"A": SIMPLE, **lft, "shift": "1.7", "radius": "1.2"}
    assert ("radius", "less_than", "1.2") in proved(make("robust_disk", fields, {"P": p, "D1": "0.5"}))
    # lambda = 1, H = 5: s^2 + 3 s - 3 has the root 0.79, outside the disk
    refused("robust_disk", {**fields, "H": "col(0, 5)"}, {"P": p, "D1": "0.5"})
    # a feedthrough of one makes 1 - Dw Delta singular at Delta = 1
    refused("robust_disk", {**fields, "Dw": "1"}, {"P": p, "D1": "0.5"})
    p = linalg.solve_continuous_lyapunov(A.T, -2 * I)
    fields = {**SYSTEM, **lft, "gamma": "2"}
    assert ("norm", "less_than", "2") in proved(make("robust_norm", fields, {"P": p, "D1": "0.5"}))
    # at lambda = 1 the gain at zero frequency is 1/1.9 > 0.52
    refused("robust_norm", {**fields, "gamma": "0.52"}, {"P": p, "D1": "0.5"})


def test_robust_levels_are_squared_once():
    dead = {"H": "0", "Cz": "0", "blocks": [["repeated", 1]]}
    make("robust_disk", {"A": "0.5", **dead, "shift": "0", "radius": "0.51"}, {"P": "1", "D1": "1"})
    refused("robust_disk", {"A": "0.5", **dead, "shift": "0", "radius": "0.49"}, {"P": "1", "D1": "1"})
    # 1/(s + 1): norm 1, and P = 1 leaves -2 + 1 + 1/gamma^2
    first = {"A": "-1", "B": "1", "C": "1", **dead}
    make("robust_norm", {**first, "gamma": "1.001"}, {"P": "1", "D1": "1"})
    refused("robust_norm", {**first, "gamma": "0.999"}, {"P": "1", "D1": "1"})


def test_skew_multipliers_only_for_real_repeated_numbers():
    lft = {"H": "0.1*eye(2)", "Cz": "eye(2)", "blocks": [["repeated", 2]]}
    p = linalg.solve_continuous_lyapunov(A.T, -2 * I)
    witness = {"P": p, "D1": 0.5 * I, "G1": [["0", "0.01"], ["-0.01", "0"]]}
    make("quadratic_bound", {"A": SIMPLE, **lft}, witness)
    refused("quadratic_bound", {"A": SIMPLE, **lft}, {**witness, "G1": [["0", "0.01"], ["0.01", "0"]]})


def test_enclosed():
    low_high = proved(make("enclosed", {"formula": "sqrt(number('n'))", "low": "0.0336", "high": "0.0337"}))
    assert ("value", "greater_than", "0.0336") in low_high  # 0.0336^2 = 1.12896e-3, 0.0337^2 = 1.13569e-3
    refused("enclosed", {"formula": "sqrt(number('n'))", "high": "0.0336"})
    assert proved(make("enclosed", {"formula": "1/4 + 0.25"})) == {("value", "inside", "0.5..0.5")}


LYAPUNOV = [["lyapunov", "sym(P@M) < 0"], ["positive", "P > 0"]]
P_UNKNOWN = {"P": {"shape": [2, 2], "structure": "symmetric"}}


def test_feasible_point_with_exact_equations():
    p = linalg.solve_continuous_lyapunov(A.T, -I)
    fields = {
        "constraints": [["lyapunov", "sym(P@M) + t*eye(2) <= 0"], ["trace", "trace(P) == 1"], ["room", "t > 0"]],
        "maximise": "t",
    }
    common = {
        "id": "c",
        "statement": "s",
        "tables": TABLES,
        "unknowns": {**P_UNKNOWN, "t": {}},
        "definitions": {"M": SIMPLE},
    }
    point = {"P": p / np.trace(p), "t": 0.9 / np.trace(p)}
    certificate = build.feasible_point(fields=fields, point=point, **common)
    found = {p.of: p for p in check(certificate, TABLES).proved}
    # trace P = 5/4 + 1/4 = 3/2 for A'P + PA = -I, so t = 0.9/1.5 = 0.6
    assert (found["objective"].relation, float(Fraction(found["objective"].value))) == ("at_least", 0.6)
    diagonal = [Fraction(certificate.witness["P"][i][i]) for i in range(2)]
    assert sum(diagonal) == 1
    fields["constraints"].append(["contradiction", "trace(P) == 2"])
    with pytest.raises(CertificateError, match="without a solution"):
        build.feasible_point(fields=fields, point=point, **common)


@pytest.mark.parametrize("constraints", [[], "x > 0", [["a"]], [["a", "x > 0"], ["a", "x < 2"]]])
def test_constraints_are_pairs_of_different_names(constraints):
    assert "constraint" in refused("feasible", {"constraints": constraints}, {"x": "1"}, unknowns={"x": {}})


def test_a_feasible_point_bounds_one_objective():
    """Of two, a bound from below of the one would read as a bound of the other: x = 1, and 100 x is at least 100."""
    fields = {"constraints": [["a", "x > 0"]], "minimise": "x", "maximise": "100 * x"}
    assert "one of the fields" in refused("feasible", fields, {"x": "1"}, unknowns={"x": {}})


def test_farkas_against_an_unstable_matrix():
    # M = [[1, 1], [0, 2]]: with V > 0 and M V + V M' = I, <V, sym(PM)> = trace P > 0, so P M + M'P < 0 fails
    m = np.array([[1.0, 1.0], [0.0, 2.0]])
    v = linalg.solve_continuous_lyapunov(m, I)
    common = {"id": "c", "statement": "s", "tables": TABLES, "unknowns": P_UNKNOWN}
    fields = {"constraints": LYAPUNOV}
    definitions = {"M": "[[1, 1], [0, 2]]"}
    multipliers = {"lyapunov": v, "positive": m @ v + v @ m.T}
    certificate = build.farkas(fields=fields, definitions=definitions, multipliers=multipliers, **common)
    assert {(p.of, p.relation) for p in check(certificate, TABLES).proved} == {("feasible", "fails")}
    with pytest.raises(CertificateError):  # a Hurwitz matrix has a Lyapunov function, so no multipliers exist
        build.farkas(fields=fields, definitions={"M": SIMPLE}, multipliers=multipliers, **common)
    with pytest.raises(CertificateError, match=">= 0 does not hold"):
        build.farkas(fields=fields, definitions=definitions, multipliers={**multipliers, "lyapunov": -v}, **common)


def test_farkas_with_a_congruence_for_every_value_of_a_parameter():
    # eps > 0 and -eps e^2 > 0 cannot both hold, whatever e
    fields = {"constraints": [["first", "eps*e**2 < 0"], ["eps", "eps > 0"]], "congruences": {"eps": "e"}}
    make("farkas", fields, {"first": "1", "eps": "1"}, unknowns={"eps": {}, "e": {}})
    del fields["congruences"]
    assert "still holds" in refused("farkas", fields, {"first": "1", "eps": "1"}, unknowns={"eps": {}, "e": {}})


def test_farkas_needs_strictness_or_a_negative_sum():
    unknowns = {"x": {}}
    refused("farkas", {"constraints": [["a", "x >= 0"], ["b", "x <= 0"]]}, {"a": "1", "b": "1"}, unknowns=unknowns)
    make("farkas", {"constraints": [["a", "x > 0"], ["b", "x <= 0"]]}, {"a": "1", "b": "1"}, unknowns=unknowns)
    make("farkas", {"constraints": [["a", "x >= 1"], ["b", "x <= 0"]]}, {"a": "1", "b": "1"}, unknowns=unknowns)
    refused("farkas", {"constraints": [["a", "x > 0"], ["b", "x <= 0"]]}, {"b": "1"}, unknowns=unknowns)
    make("farkas", {"constraints": [["a", "x == 1"], ["b", "x == 0"]]}, {"a": "1", "b": "-1"}, unknowns=unknowns)
    # a congruence may be zero, so it carries no strictness
    strict = {"constraints": [["a", "x > 0"], ["b", "x*e**2 <= 0"]], "congruences": {"a": "e"}}
    refused("farkas", strict, {"a": "1", "b": "1"}, unknowns={"x": {}, "e": {}})


def test_dual_bound_meets_the_optimum():
    # min x + y subject to x y >= 1, x >= 0: 2 at x = y = 1
    common = {"id": "c", "statement": "s", "tables": TABLES, "unknowns": {"x": {}, "y": {}}}
    fields = {"constraints": [["hyperbola", "[[x, 1], [..., y]] >= 0"]], "minimise": "x + y"}
    certificate = build.dual_bound(fields=fields, multipliers={"hyperbola": [[1.0, -0.999], [-0.999, 1.0]]}, **common)
    assert [(p.of, p.relation, p.value) for p in check(certificate, TABLES).proved] == [
        ("objective", "at_least", "1.998")
    ]
    refused("dual_bound", {**fields, "bound": "2.001"}, {"hyperbola": [[1, -1], [-1, 1]]}, unknowns=common["unknowns"])
    fields = {"constraints": [["disk", "[[1, x], [..., 1]] >= 0"]], "maximise": "x"}
    certificate = build.dual_bound(fields=fields, multipliers={"disk": [[0.5, -0.5], [-0.5, 0.5]]}, **common)
    assert [(p.of, p.relation, p.value) for p in check(certificate, TABLES).proved] == [("objective", "at_most", "1")]


def test_linear_box():
    # 0.50 and 0.25 stand for 0.495..0.505 and 0.245..0.255
    unknowns = {"v": {"shape": [1, 2]}}

    def fields(text, answer):
        return {"constraints": [["sum", text]], "boxes": {"v": "v"}, "answer": answer}

    make("linear_box", fields("v[0,0] + v[0,1] == 0.76", "holds"), {"v": [["0.505", "0.255"]]}, unknowns=unknowns)
    refused("linear_box", fields("v[0,0] + v[0,1] == 0.761", "holds"), {"v": [["0.506", "0.255"]]}, unknowns=unknowns)
    refused("linear_box", fields("v[0,0] + v[0,1] == 0.761", "holds"), {"v": [["0.505", "0.255"]]}, unknowns=unknowns)
    make("linear_box", fields("v[0,0] + v[0,1] == 0.761", "fails"), {"sum": "1"}, unknowns=unknowns)
    refused("linear_box", fields("v[0,0] + v[0,1] == 0.76", "fails"), {"sum": "1"}, unknowns=unknowns)
    make("linear_box", fields("v[0,0] - 3*v[0,1] >= -0.2", "fails"), {"sum": "1"}, unknowns=unknowns)  # at most -0.23
    refused("linear_box", fields("v[0,0] - 3*v[0,1] >= -0.2", "fails"), {"sum": "-1"}, unknowns=unknowns)


def test_farkas_over_a_box_of_printed_digits():
    # x in 0.495..0.505 and [[x, 1], [1, y]] >= 0 need y >= 1/0.505 > 1.98
    unknowns = {"v": {"shape": [1, 2]}, "y": {}}
    fields = {
        "constraints": [["schur", "[[v[0,0], 1], [..., y]] >= 0"], ["small", "y <= 1.98"]],
        "boxes": {"v": "v"},
    }
    z = np.array([[1.0, -0.505], [-0.505, 0.505**2]])
    common = {"id": "c", "statement": "s", "tables": TABLES, "unknowns": unknowns}
    multipliers = {"schur": z, "small": [[0.255025]]}
    certificate = build.farkas(fields=fields, multipliers=multipliers, **common)
    assert check(certificate, TABLES).proved[0].relation == "fails"
    fields["constraints"][1] = ["small", "y <= 1.99"]
    with pytest.raises(CertificateError):
        build.farkas(fields=fields, multipliers=multipliers, **common)


def test_positive_on_an_interval():
    t = {"t": {}}
    make("positive_on_interval", {"constraint": "t**2 - 2*t + 1.001 > 0", "low": "-5", "high": "5"}, unknowns=t)
    refused(
        "positive_on_interval", {"constraint": "t**2 - 2*t + 1 > 0", "low": "-5", "high": "5"}, unknowns=t
    )  # (t - 1)^2
    make("positive_on_interval", {"constraint": "t**2 - 2 < 0", "low": "-1.414", "high": "1.414"}, unknowns=t)
    refused("positive_on_interval", {"constraint": "t**2 - 2 < 0", "low": "-1.414", "high": "1.415"}, unknowns=t)
    # eigenvalues 1 + t and 1 - t
    make("positive_on_interval", {"constraint": "[[1, t], [..., 1]] > 0", "low": "-0.999", "high": "0.999"}, unknowns=t)
    refused("positive_on_interval", {"constraint": "[[1, t], [..., 1]] > 0", "low": "-0.999", "high": "1"}, unknowns=t)
    # negative definite beyond 1 in both eigenvalues of diag(1 - t, 1 - t): the determinant only touches zero
    refused("positive_on_interval", {"constraint": "(1 - t)*eye(2) > 0", "low": "0", "high": "2"}, unknowns=t)
    refused("positive_on_interval", {"constraint": "-(1 + t**2)*eye(2) > 0", "low": "0", "high": "2"}, unknowns=t)
    refused("positive_on_interval", {"constraint": "t*u > 0", "low": "0", "high": "2"}, unknowns={**t, "u": {}})


@given(st.lists(st.integers(-5, 5), min_size=1, max_size=5), st.integers(-6, 5), st.integers(0, 6))
def test_sturm_counts_the_roots_put_in(roots, low, width):
    product = fmpq_poly([1, 0, 1])  # 1 + t^2 has no real root
    for root in roots:
        product = product * fmpq_poly([-root, 1])
    low, high = fmpq(2 * low + 1, 2), fmpq(2 * (low + width) + 1, 2)  # halves: never a root
    assert roots_between(product, low, high) == len({r for r in roots if low < r < high})
