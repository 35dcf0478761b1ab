"""What the Riccati equation says."""

from scipy.linalg import solve_continuous_are

from gainsay.proof import build
from gainsay.tables import Case
from gainsay.tables.results import Results, task
from papers.double_integrator.plant import FORMULAS, A, B, Q


@task("(3)")
def solution(case: Case, results: Results) -> None:
    """The stabilising solution, by another method than the paper's."""
    P = solve_continuous_are(A, B, Q, [[1.0]])
    results.quantity("riccati.p11", P[0, 0], method="Riccati equation by Schur vectors", source="(3)")


@task("(2)")
def identity(case: Case, results: Results) -> None:
    """P = [[r, 1], [1, r]] in the Riccati equation, for every r; the weight of the velocity is zero where r^2 = 2."""
    results.prove(
        build.certificate(
            "identity",
            id="riccati",
            paper=case.name,
            statement="P = [[r, 1], [1, r]] solves the Riccati equation with the weights 1 and r^2 - 2.",
            tables=case,
            definitions={"A": FORMULAS["A"], "B": FORMULAS["B"], "S": "[[r, 1], [1, r]]"},
            unknowns={"r": {"shape": [1, 1], "structure": "full"}},
            fields={"left": "A.T@S + S@A - S@B@B.T@S + diag(1, r**2 - 2)", "right": "zeros(2, 2)"},
            quantities={"identity": "riccati.identity"},
        ),
        source="(2)",
    )


TASKS = (solution, identity)
