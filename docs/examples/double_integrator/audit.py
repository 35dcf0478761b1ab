"""What the printed gain does."""

from gainsay.proof import build
from gainsay.results import Results, task
from gainsay.systems.norms import bounded_real_certificate_matrix, hinf_norm
from gainsay.tables import Case
from gainsay.verdicts.scan import plausible, scan
from papers.double_integrator import runs
from papers.double_integrator.plant import FORMULAS, B, closed_loop, cost


@task("(3), (4)")
def printed(case: Case, results: Results) -> None:
    """The printed P is definite; the printed K gives these poles."""
    common = {"tables": case, "definitions": FORMULAS}
    results.prove(
        build.certificate(
            "definite",
            id="definite",
            statement="The printed P is positive definite.",
            fields={"constraint": "P > 0"},
            quantities={"definite": "audit.definite"},
            **common,
        ),
        source="(3)",
    )
    results.prove(
        build.certificate(
            "eigenvalues",
            id="abscissa",
            statement="The closed-loop poles lie left of this.",
            fields={"matrix": "Acl", "measure": "abscissa"},
            quantities={"abscissa": "audit.abscissa"},
            **common,
        ),
        source="(4)",
    )


@task("Section 3")
def peak(case: Case, results: Results) -> None:
    """The complementary sensitivity, from a disturbance at the input to the control."""
    loop, K, level = closed_loop(case), case.matrix("K"), case.claims["peak"].published
    results.prove(
        build.certificate(
            "bounded_real",
            id="peak",
            statement="The complementary sensitivity at the input stays below this.",
            tables=case,
            definitions=FORMULAS,
            fields={"A": "Acl", "B": "B", "C": "K", "gamma": level},
            witness={"P": bounded_real_certificate_matrix(loop, B, K, None, float(level))},
            quantities={"norm": "audit.peak"},
        ),
        source="Section 3",
        values={"audit.peak": hinf_norm(loop, B, K)[0]},
    )


@task("Example")
def over_missing_inputs(case: Case, results: Results) -> None:
    """Undershoot and cost over every plausible initial velocity."""
    rates = [plausible(case, "v0")]
    results.scan(scan(case, "run.undershoot", rates, lambda point: runs.undershoot(case, point["v0"])[1]))
    results.scan(scan(case, "run.cost", rates, lambda point: cost(case, point["v0"])))


TASKS = (printed, peak, over_missing_inputs)
