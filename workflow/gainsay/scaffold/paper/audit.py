"""What the printed gain does, whatever the paper's LMIs say."""

from gainsay.results import Results, task
from gainsay.scans import plausible, scans
from gainsay.statements import differing, identical
from gainsay.systems.loop_proofs import abscissa
from gainsay.systems.norm_proofs import prove_norm
from gainsay.tables import Case
from papers.example.plant import LOOP
from papers.example.response import numbers, respond


@task("(2)")
def poles(case: Case, results: Results) -> None:
    """The slowest pole, enclosed by the checker."""
    proof = abscissa(
        case,
        "Acl",
        definitions=LOOP,
        statement="The slowest closed-loop pole lies in this interval.",
        quantity="audit.abscissa",
    )
    results.prove(proof, source="(2)")


@task("Section 3")
def torque_gain(case: Case, results: Results) -> None:
    """How much of a disturbance torque the controller asks for, at most: the bounded real lemma."""
    loop, level = {"A": "Acl", "B": "B", "C": "K"}, case.claims["torque-gain"].published
    prove_norm(results, "audit.torque_gain", "hinf", loop, level, definitions=LOOP, source="Section 3")


@task("(4)")
def square(case: Case, results: Results) -> None:
    """Completing the square: for all numbers at once with the sign corrected; refuted at one point as printed."""
    printed = differing(
        case,
        "audit.identity_printed",
        "(4) as printed does not complete the square.",
        "x**2 + 2 * x * y",
        "(x + y)**2 + y**2",
        at={"x": 1, "y": 1},
    )
    corrected = identical(
        case,
        "audit.identity",
        "(4) with the sign corrected completes the square.",
        "x**2 + 2 * x * y",
        "(x + y)**2 - y**2",
        "x y",
    )
    results.prove(printed, source="(4)")
    results.prove(corrected, source="(4)")


@task("Section 4")
def over_missing_inputs(case: Case, results: Results) -> None:
    """What is said of Figure 1, over every plausible value of the initial rate that the paper leaves out."""
    for scan in scans(
        case,
        ["run.settling", "run.torque"],
        [plausible(case, "rate0")],
        lambda point: numbers(case, respond(case, point["rate0"])),
    ):
        results.scan(scan)


TASKS = (poles, torque_gain, square, over_missing_inputs)
