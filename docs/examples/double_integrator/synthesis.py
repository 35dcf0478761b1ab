"""What the Riccati equation says."""

from gainsay.proof import build
from gainsay.results import Results, task
from gainsay.statements import identical
from gainsay.tables import Case
from papers.double_integrator.plant import LOOP


@task("(2)")
def solution(case: Case, results: Results) -> None:
    """P = [[r, 1], [1, r]] for every r; the velocity has no weight where r^2 = 2."""
    equation = identical(
        case,
        "riccati.identity",
        "P = [[r, 1], [1, r]] solves the Riccati equation with the weights 1 and r^2 - 2.",
        "A.T@S + S@A - S@B@B.T@S + diag(1, r**2 - 2)",
        "zeros(2, 2)",
        "r",
        definitions={"A": LOOP["A"], "B": LOOP["B"], "S": "[[r, 1], [1, r]]"},
    )
    root = build.certificate(
        "enclosed",
        tables=case,
        fields={"formula": "sqrt(2)"},
        statement="The positive root of r^2 = 2 lies in this interval.",
        quantities={"value": "riccati.p11"},
    )
    results.prove(equation, source="(2)")
    results.prove(root, source="(3)")


TASKS = (solution,)
