"""A small system and short ways to make certificates, for the tests of the kinds of proof."""

import numpy as np
import pytest

from gainsay.errors import CertificateError
from gainsay.proof import MappingTables, build, check

A = np.array([[0.0, 1.0], [-2.0, -3.0]])  # (s + 1)(s + 2)
I = np.eye(2)  # noqa: E741
TABLES = MappingTables(
    numbers={"n": "1.13e-3"},
    printed={"A": [["0.000", "1.000"], ["-2.000", "-3.000"]], "v": [["0.50", "0.25"]]},
)
SIMPLE = "[[0, 1], [-2, -3]]"


def make(kind, fields, witness=None, **more):
    parts = {"id": "c", "statement": "A statement.", "tables": TABLES, "fields": fields, **more}
    return build.certificate(kind, witness=witness, **parts)


def proved(certificate):
    return {(p.of, p.relation, p.value) for p in check(certificate, TABLES).proved}


def refused(kind, fields, witness=None, **more):
    with pytest.raises(CertificateError) as caught:
        make(kind, fields, witness, **more)
    assert "\n" not in str(caught.value)
    return str(caught.value)


SYSTEM = {"A": SIMPLE, "B": "col(0, 1)", "C": "row(1, 0)"}  # 1/((s + 1)(s + 2)): norm 1/2 at zero frequency
