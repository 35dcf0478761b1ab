"""Identities and counterexamples: each expected answer is seen by hand."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gainsay.errors import CertificateError
from gainsay.proof import check
from gainsay.statements import diagonal, differing, identical, matrix, scalar, symmetric
from gainsay.statements.identities import _somewhere

CIRCLE, ON_IT = ["s**2 + c**2 - 1"], {"s": "3/5", "c": "4/5"}


def concluded(certificate, case):
    check(certificate, case)
    return {(c.quantity, c.relation) for c in certificate.conclusions}


def test_an_identity_of_numbers_and_of_matrices(project):
    case = project.case()
    made = identical(case, "audit.holds", "A square.", "(a + b)**2", "a**2 + 2*a*b + b**2", "a b")
    assert made.id == "audit-holds"
    assert concluded(made, case) == {("audit.holds", "holds")}
    made = identical(case, "", "A transpose.", "(A @ B).T", "B.T @ A.T", {"A": matrix(2, 3), "B": matrix(3, 2)}, id="t")
    assert concluded(made, case) == {("", "holds")}


def test_an_identity_on_a_circle_speaks_of_a_point_of_it(project):
    case = project.case()
    made = identical(case, "audit.holds", "On a circle.", "(s + c)**2", "1 + 2*s*c", "s c k", modulo=CIRCLE, at=ON_IT)
    assert made.witness["k"] == [["1"]]
    assert concluded(made, case) == {("audit.holds", "holds")}
    with pytest.raises(CertificateError, match="does not vanish"):
        identical(case, "audit.holds", "On a circle.", "(s + c)**2", "1 + 2*s*c", "s c", modulo=CIRCLE, at={"s": "1"})
    with pytest.raises(CertificateError):  # off the circle it is none
        identical(case, "audit.holds", "Anywhere.", "(s + c)**2", "1 + 2*s*c", "s c")


def test_what_is_no_identity_has_a_counterexample_and_what_is_one_has_none(project):
    case = project.case()
    made = differing(case, "audit.holds", "Products do not commute.", "A @ B", "B @ A",
                     {"A": matrix(2, 2), "B": symmetric(2)})  # fmt: skip
    assert concluded(made, case) == {("audit.holds", "fails")}
    made = differing(case, "audit.holds", "A sign.", "-v", "v", at={"v": "1/2"})
    assert made.witness["v"] == [["0.5"]]
    with pytest.raises(CertificateError, match="not proved to differ"):
        differing(case, "audit.holds", "A square.", "(a + b)**2", "a**2 + 2*a*b + b**2", "a b")
    with pytest.raises(CertificateError, match="not proved to differ"):
        differing(case, "audit.holds", "A sign.", "-v", "v", at={"v": "0"})


def test_formulas_of_different_shapes_differ(project):
    case = project.case()
    made = differing(case, "", "Sizes.", "A", "a", {"A": matrix(2, 2), "a": scalar()}, id="sizes")
    assert concluded(made, case) == {("", "fails")}


@given(st.integers(1, 5), st.integers(1, 5), st.sampled_from([symmetric, diagonal, None]))
def test_points_have_the_structure_asked_for_and_an_inverse(rows, columns, structured):
    unknown = matrix(rows, columns) if structured is None else structured(rows)
    point = np.array(_somewhere({"a": scalar(), "A": unknown})["A"])
    assert point.shape == (unknown.rows, unknown.columns)
    if structured is symmetric:
        assert (point == point.T).all()
    if structured is diagonal:
        assert not (point - np.diag(np.diag(point))).any()
    if unknown.rows == unknown.columns:
        assert abs(np.linalg.det(point)) > 0.5  # an integer that is not zero
