"""What the printed numbers do."""

from gainsay.proof import build
from gainsay.results import Results, task
from gainsay.scans import plausible, scans
from gainsay.systems.loop_proofs import abscissa
from gainsay.systems.norm_proofs import prove_norm
from gainsay.tables import Case
from papers.double_integrator.plant import LOOP, numbers, respond


@task("(3)")
def definite(case: Case, results: Results) -> None:
    """The printed P is positive definite."""
    proof = build.certificate(
        "definite",
        tables=case,
        definitions=LOOP,
        fields={"constraint": "P > 0"},
        statement="The printed P is positive definite.",
        quantities={"definite": "audit.definite"},
    )
    results.prove(proof, source="(3)")


@task("(4)")
def poles(case: Case, results: Results) -> None:
    """The slowest pole under the printed K, enclosed by the checker."""
    proof = abscissa(
        case,
        "Acl",
        definitions=LOOP,
        statement="The closed-loop poles lie left of this.",
        quantity="audit.abscissa",
    )
    results.prove(proof, source="(4)")


@task("Section 3")
def peak(case: Case, results: Results) -> None:
    """The complementary sensitivity, from a disturbance at the input to the control."""
    loop, level = {"A": "Acl", "B": "B", "C": "K"}, case.claims["peak"].published
    prove_norm(results, "audit.peak", "hinf", loop, level, definitions=LOOP, source="Section 3")


@task("Example")
def over_missing_inputs(case: Case, results: Results) -> None:
    """Undershoot and cost over every plausible initial velocity."""
    for scan in scans(
        case,
        ["run.undershoot", "run.cost"],
        [plausible(case, "v0")],
        lambda point: numbers(case, respond(case, point["v0"])),
    ):
        results.scan(scan)


TASKS = (definite, poles, peak, over_missing_inputs)
