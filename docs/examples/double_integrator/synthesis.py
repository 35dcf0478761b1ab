"""What the Riccati equation says."""

from flint import arb
from scipy.linalg import solve_continuous_are

from gainsay.errors import ComputationError
from gainsay.exact.ball import lower, precision, upper
from gainsay.proof import build
from gainsay.results import Results, task
from gainsay.tables import Case
from papers.double_integrator.plant import FORMULAS, A, B, Q


@task("(3)")
def solution(case: Case, results: Results) -> None:
    """The positive root of r^2 = 2 as a ball, held against the stabilising solution by another method."""
    P = solve_continuous_are(A, B, Q, [[1.0]])
    with precision(128):
        r = arb(2).sqrt()
    if not abs(P[0, 0] - float(r)) < 1e-9:
        raise ComputationError("(3)", f"{P[0, 0]!r} by Schur vectors, {float(r)!r} by hand")
    results.enclosed("riccati.p11", lower(r), upper(r), source="(3)",
                     method="root of r^2 = 2; the Riccati equation by Schur vectors gives it too")  # fmt: skip


@task("(2)")
def identity(case: Case, results: Results) -> None:
    """P = [[r, 1], [1, r]] in the Riccati equation, for every r; the weight of the velocity is zero where r^2 = 2."""
    results.prove(
        build.certificate(
            "identity",
            id="riccati",
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
