"""Laws and closed forms that a certificate must not get round: feedthrough, several blocks, ends of an interval."""

import numpy as np
import pytest
from flint import fmpq, fmpq_poly
from scipy import linalg

from gainsay.errors import CertificateError
from gainsay.proof import check
from gainsay.proof.certificate import LONGEST_TEXT
from gainsay.proof.kinds.positive_on_interval import roots_between
from tests.gainsay.proof_examples import SIMPLE, TABLES, make, proved, refused


@pytest.mark.parametrize(("through", "gamma", "p", "holds"), [
    # D + 1/(s + 1): its norm is 2 for D = 1, at s = 0, and 1 for D = -1, at infinity
    ("1", "2.1", "2", True), ("-1", "1.5", "1", True), ("1", "1.5", "1", False), ("1", "1.99", "2", False),
])  # fmt: skip
def test_feedthrough_counts_with_its_sign_in_the_bounded_real_lemma(through, gamma, p, holds):
    fields = {"A": "-1", "B": "1", "C": "1", "D": through, "gamma": gamma}
    if holds:
        assert ("norm", "less_than", gamma) in proved(make("bounded_real", fields, {"P": p}))
    else:
        assert "bounded real inequality" in refused("bounded_real", fields, {"P": p})


@pytest.mark.parametrize(("through", "gamma", "holds"), [("1", "2", True), ("-1", "0.5", False), ("1", "2.001", False)])
def test_feedthrough_counts_with_its_sign_in_a_gain(through, gamma, holds):
    # at w = 0 the gain is |D + 1|
    fields = {"A": "-1", "B": "1", "C": "1", "D": through, "frequency": "0", "gamma": gamma}
    if holds:
        make("norm_at_least", fields, {"u": [["1", "0"]]})
    else:
        assert "not proved" in refused("norm_at_least", fields, {"u": [["1", "0"]]})


def lagging_springs(places: tuple[int, ...]) -> tuple[dict, dict]:
    """Three channels in a row: springs x'' = -(1 + 0.9 l) x - 0.2 x' at some places, lags x' = -x + 0.1 l x elsewhere.

    Every spring is stable for real |l| <= 1; for complex l it is not, so that its g must not be zero.
    """
    parts = [(np.array([[0, 1], [-1, -0.2]]), [[0], [0.9]], [[-1, 0]]) if k in places else
             (-np.eye(1), [[0.1]], [[1.0]]) for k in range(3)]  # fmt: skip
    A, H, Cz = (linalg.block_diag(*(part[k] for part in parts)) for k in range(3))
    texts = {name: str(M.tolist()) for name, M in (("A", A), ("H", H), ("Cz", Cz))}
    fields = {**texts, "blocks": [["repeated", 1]] * 3, "arcs": ["0", "1"], "alpha": "0", "scale": "1"}
    return fields, {"P": linalg.solve_continuous_lyapunov(A.T, -np.eye(len(A))), "d": [["1", "1", "1"]]}


@pytest.mark.parametrize("place", range(3))
def test_a_real_parameter_is_that_of_its_own_block(place):
    fields, witness = lagging_springs((place,))
    for given in range(3):
        g = [["10" if k == given else "0" for k in range(3)]]
        if given == place:
            assert ("stable", "holds", None) in proved(make("contour", fields, {**witness, "g": g}))
        else:
            assert "arc 1" in refused("contour", fields, {**witness, "g": g})


@pytest.mark.parametrize("through", ["1", "-1.2", "2"])
def test_an_interconnection_that_is_not_well_posed_is_refused(through):
    # I - Dw l is singular at l = 1/Dw
    fields = {"A": "-1", "H": "0.1", "Cz": "0.1", "Dw": through, "blocks": [["full", 1, 1]], "arcs": ["0", "0.5", "1"],
              "shift": "1.5", "radius": "1.2"}  # fmt: skip
    assert "D - Dw' D Dw" in refused("contour", fields, {"P": "1", "d": [["1"], ["1"]]})


@pytest.mark.parametrize(("low", "high", "count"), [(0, 3, 1), (-3, 0, 1), (0, 0, 1), (0, 5, 1), (1, 4, 0), (-1, 6, 2)])
def test_roots_at_the_ends_of_an_interval_count(low, high, count):
    # x (x - 5): what stands at an end makes at least one
    assert roots_between(fmpq_poly([0, -5, 1]), fmpq(low), fmpq(high)) == count


@pytest.mark.parametrize(
    "unknown", [{"shape": [0, 0]}, {"shape": [2, 2], "structure": "hermitian"}, {"shape": [1, 0], "structure": "full"}]
)
def test_unknowns_without_entries_or_of_no_known_structure_are_refused(unknown):
    assert "unknown 'X'" in refused("identity", {"left": "X", "right": "X"}, unknowns={"X": unknown})


@pytest.mark.parametrize(
    "P", [None, 1j, {"a": 1}, [["a", "0"], ["0", "1"]], [["nan", "0"], ["0", "1"]], [["1/0", "0"], ["0", "1"]],
          [["1e99999", "0"], ["0", "1"]], [["\u0661", "0"], ["0", "1"]], [[1.0], [0.0, 1.0]], [[None, 0], [0, 1]]]
)  # fmt: skip
def test_a_witness_that_is_no_matrix_of_numbers_is_refused(P):
    refused("lyapunov", {"matrix": SIMPLE, "alpha": "0"}, {"P": P})


@pytest.mark.parametrize("id", ["c\n", "c\x1b[31m", "", 5, None])
def test_an_id_that_is_none_stands_in_no_message(id):
    certificate = make("definite", {"constraint": "eye(2) > 0"}).changed(id=id)
    with pytest.raises(CertificateError) as caught:
        check(certificate, TABLES)
    assert str(caught.value).isprintable()


def test_a_text_beyond_its_limit_is_refused():
    fields = {"left": "1", "right": "1"}
    make("identity", fields, statement="a" * LONGEST_TEXT)
    assert "at most" in refused("identity", fields, statement="a" * (LONGEST_TEXT + 1))
