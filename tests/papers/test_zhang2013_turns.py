"""Another formula, sign or gain turns each identity and feasibility of zhang2013: none is proved whatever it says."""

from pathlib import Path

import numpy as np
import pytest

from gainsay.errors import CertificateError
from gainsay.lmi import Solved
from gainsay.statements import Step, implication
from gainsay.systems.delay_spectrum import unstable_root_count
from gainsay.tables import read_case
from papers.zhang2013 import derivations, derivations_misprints
from papers.zhang2013.plant import Spacecraft
from papers.zhang2013.statements import (
    PRINTED_LOOP,
    corrected_23,
    corrected_26,
    design_loop,
    equation_23,
    for_gains,
    reduced_theorem_1,
    theorem_2,
)

CASE = read_case(Path(__file__).parents[2], "zhang2013")
#: quantity -> the task that proves it, what stands in its formulas, what takes the place of it
IDENTITIES = {
    "eq2.identity": ("model", "-q - F.T * a", "-q + F.T * a"),  # the body drives its modes the other way
    "eq5.identity": ("model", "(w2 - p - L @ x)", "(w2 - p + L @ x)"),  # another estimate than (4) gives
    "eq7.identity": ("model", "+ K @ xd", "+ K @ x"),  # a torque that is not delayed
    "lemma1.holds": ("lemma", "(3 * W1 + W2)", "(4 * W1 + W2)"),  # a lemma that asks for more
    "eq15.identity": ("lemma", "-(3 * ", "-(2 * "),
    "eq16.identity": ("lemma", " + 3 * ", " + 4 * "),
    "eq17.identity": ("derivative", "(1 - mu)", "(1 + mu)"),  # a delay that changes the other way
    "eq18.identity": ("derivative", "- 3 * ", "- 1 * "),  # the weights of (9b) in (9a)
    "eq19.identity": ("derivative", "- 1 * ", "- 3 * "),
    "eq21.identity": ("derivative", "zeros(1, 3), C_d)", "zeros(1, 3), 2 * C_d)"),
    "eq22.identity": ("derivative", "+ B_bar @ w", "- B_bar @ w"),  # w that pushes the other way
}


class Silent:
    """Results that keep nothing."""

    def prove(self, certificate, **more) -> None:
        pass

    def certificate(self, certificate) -> None:
        pass

    def say(self, *words) -> None:
        pass


def proved_alone(monkeypatch, quantity: str, old: str, new: str) -> None:
    """Run the task that proves an identity with another formula on one side, and no other identity."""
    build = derivations.identical

    def changed(case, of, sentence, left, right, unknowns, **more):
        if of != quantity:
            return None
        assert old in left + right
        whole = left.replace(old, new), right if old in left else right.replace(old, new)
        return build(case, of, sentence, *whole, unknowns, **more)

    monkeypatch.setattr(derivations, "identical", changed)
    monkeypatch.setattr(derivations, "differing", lambda *given, **more: None)
    getattr(derivations, IDENTITIES[quantity][0])(CASE, Silent())


@pytest.mark.parametrize("quantity", IDENTITIES)
def test_another_formula_is_no_identity(monkeypatch, quantity):
    _, old, new = IDENTITIES[quantity]
    with monkeypatch.context() as patch:
        proved_alone(patch, quantity, old, old)  # as it stands it is one
    with pytest.raises(CertificateError):
        proved_alone(monkeypatch, quantity, old, new)


def test_every_identity_of_the_claims_is_turned_here():
    claimed = {c.quantity for c in CASE.claims.values() if c.kind == "identity" and c.comparator == "holds"}
    assert claimed - {"theorem1.slack_useless", "eq23.identity", "eq26.identity"} == set(IDENTITIES)


@pytest.mark.parametrize(
    ("made", "printed", "corrected"),
    [("printed_23_differs", "equation_23", corrected_23), ("printed_26_differs", "equation_26", corrected_26)],
)
def test_with_its_five_blocks_corrected_the_congruence_is_one(monkeypatch, made, printed, corrected):
    getattr(derivations_misprints, made)(CASE)
    monkeypatch.setattr(derivations_misprints, printed, corrected)
    with pytest.raises(CertificateError):  # they no longer differ
        getattr(derivations_misprints, made)(CASE)


def test_slack_of_another_form_is_not_without_loss(monkeypatch):
    build = derivations.implication

    def changed(case, **given):
        return build(case, **{**given, "then": given["then"].replace("(d_M * R)", "(2 * d_M * R)")})

    monkeypatch.setattr(derivations, "implication", changed)
    with pytest.raises(CertificateError):
        derivations.slack(CASE, Silent())


@pytest.mark.parametrize(("weight", "holds"), [("R2", True), ("R1[0:1, 0:1]", False)])
def test_what_forces_p22_to_be_positive(weight, holds):
    """Block (4,4) does, by R2; with the weight of another block in its place nothing follows."""
    given = equation_23("a")
    column = "col(zeros(5, 1), eye(1), zeros(9, 1))"
    steps = [Step(given.label, column, left_inverse=f"({column}).T"), Step(f"{weight} > 0", "eye(1)", scale="d_M")]

    def follows():
        return implication(
            CASE, id="p22", quantity="theorem2.p22_positive", sentence="It follows.", positive=("d_M",),
            given=[given < 0, f"{weight} > 0"], then="l2 * sym(P22) > 0", by=steps,
        )  # fmt: skip

    if holds:
        follows()
        return
    with pytest.raises(CertificateError):
        follows()


@pytest.mark.slow
@pytest.mark.parametrize(("K", "d_M"), [("-printed('K')", "0.03"), ("printed('K')", "5")])
def test_theorem_1_refuses_what_is_unstable(K, d_M):
    """A spacecraft pushed away from zero, and one that hears of its attitude five seconds late."""
    rows = np.array(CASE.printed("K").exact, dtype=object) * (-1 if K.startswith("-") else 1)
    loop = Spacecraft.of(CASE).design_loop(rows, CASE.printed("L").exact)
    assert unstable_root_count(loop, float(d_M)) > 0
    found = reduced_theorem_1(CASE, design_loop(K, "printed('L')"), d_M=d_M).solve()
    assert not isinstance(found, Solved)
    assert isinstance(reduced_theorem_1(CASE, PRINTED_LOOP).solve(), Solved)


@pytest.mark.slow
def test_the_unstable_observer_is_accepted_as_printed_and_refused_as_corrected():
    rows = [CASE.designs["unsound"].exact(name) for name in "KL"]
    K, L = (f"[[{', '.join(str(x) for x in row[0])}]]" for row in rows)
    accepts = {name: theorem_2(CASE, name, **for_gains(K, L), l1="1").solve() for name in ("printed", "corrected")}
    assert isinstance(accepts["printed"], Solved) and not isinstance(accepts["corrected"], Solved)
