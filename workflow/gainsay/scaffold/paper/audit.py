"""What the printed gain does, whatever the paper's LMIs say."""

import numpy as np

from gainsay.proof import build
from gainsay.results import Results, task
from gainsay.systems.norms import bounded_real_certificate_matrix, hinf_norm
from gainsay.tables import Case
from gainsay.verdicts.scan import plausible, scan
from papers.example import response
from papers.example.plant import FORMULAS, closed_loop


@task("(2)")
def poles(case: Case, results: Results) -> None:
    """The slowest pole, enclosed by the checker."""
    certificate = build.certificate(
        "eigenvalues",
        id="abscissa",
        statement="The slowest closed-loop pole lies in this interval.",
        tables=case,
        definitions=FORMULAS,
        fields={"matrix": "Acl", "measure": "abscissa"},
        quantities={"abscissa": "audit.abscissa"},
    )
    results.prove(certificate, source="(2)")


@task("Section 3")
def torque_gain(case: Case, results: Results) -> None:
    """How much of a disturbance torque the controller asks for, at most: the bounded real lemma."""
    A, K = closed_loop(case), case.matrix("K")
    B = np.array([[0.0], [1 / case.number("J")]])
    level = case.claims["torque-gain"].published
    certificate = build.certificate(
        "bounded_real",
        id="torque-gain",
        statement="The control torque is less than this multiple of the disturbance torque, in the L2 norm.",
        tables=case,
        definitions=FORMULAS,
        fields={"A": "Acl", "B": "B", "C": "K", "gamma": level},
        witness={"P": bounded_real_certificate_matrix(A, B, K, None, float(level))},
        quantities={"norm": "audit.torque_gain"},
    )
    results.prove(certificate, source="Section 3", values={"audit.torque_gain": hinf_norm(A, B, K)[0]})


@task("(4)")
def square(case: Case, results: Results) -> None:
    """Completing the square: for all numbers at once with the sign corrected; refuted at one point as printed."""
    left, unknowns = "x**2 + 2 * x * y", {name: {"shape": [1, 1], "structure": "full"} for name in ("x", "y")}
    printed = build.certificate(
        "different",
        id="square-printed",
        statement="(4) as printed does not complete the square.",
        tables=case,
        unknowns=unknowns,
        fields={"left": left, "right": "(x + y)**2 + y**2"},
        witness={"x": [["1"]], "y": [["1"]]},
        quantities={"identity": "audit.identity_printed"},
    )
    corrected = build.certificate(
        "identity",
        id="square-corrected",
        statement="(4) with the sign corrected completes the square.",
        tables=case,
        unknowns=unknowns,
        fields={"left": left, "right": "(x + y)**2 - y**2"},
        quantities={"identity": "audit.identity"},
    )
    results.prove(printed, source="(4)")
    results.prove(corrected, source="(4)")


@task("Section 4")
def over_missing_inputs(case: Case, results: Results) -> None:
    """What is said of Figure 1, over every plausible value of the initial rate that the paper leaves out."""
    rates = [plausible(case, "rate0")]
    for quantity in ("run.settling", "run.torque"):
        results.scan(
            scan(case, quantity, rates, lambda point, name=quantity: response.numbers(case, point["rate0"])[name])
        )


TASKS = (poles, torque_gain, square, over_missing_inputs)
