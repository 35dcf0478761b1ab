"""Appendix II of the paper: (B.1) to (B.5), (19) and (20) step by step."""

from gainsay.results import Results, task
from gainsay.statements import Step, implication
from gainsay.statements.unknowns import matrix
from gainsay.tables import Case
from papers.li2021.derivations import STRUCTURE
from papers.li2021.statements import EQ19, EQ20, EQ_B2, EQ_B3, EQ_B5


@task("Appendix II")
def appendix_2(case: Case, results: Results) -> None:
    """(B.1) and (B.2), (B.3) from (B.2) and from (19), (20) from (B.5)."""
    inside = "P / theta - K_t.T @ K_t / u_max**2 >= 0"
    results.prove(
        implication(
            case,
            id="appendix2-b1",
            quantity="appendix2.b1",
            sentence="(B.2) gives (B.1), that is K' K / u_max^2 <= P / theta: |K xi| <= u_max in the ellipsoid.",
            given=[EQ_B2 <= 0],
            then=inside,
            by=[Step("(B.2)", "col(-K_t / u_max**2, eye(12))")],
        ),
        source="(B.1), (B.2)",
    )
    results.prove(
        implication(
            case,
            id="appendix2-b2",
            quantity="appendix2.b2",
            sentence="(B.1), that is K' K / u_max^2 <= P / theta, gives (B.2).",
            given=[inside],
            then=EQ_B2 <= 0,
            by=[Step(inside, "row(zeros(12, 3), eye(12))"), Step("", "row(u_max * eye(3), K_t / u_max)")],
        ),
        source="(B.1), (B.2)",
    )
    results.prove(
        implication(
            case,
            id="appendix2-b3",
            quantity="appendix2.b3",
            sentence="With P of Theorem 1, (B.2) gives (B.3).",
            given=[EQ_B2 <= 0],
            then=EQ_B3 <= 0,
            expand={**STRUCTURE, "K_t": "row(zeros(3, 6), Cd)"},
            by=[Step("(B.2)", "diag(eye(3), G1)")],
        ),
        source="(B.3)",
    )
    results.prove(
        implication(
            case,
            id="eq19-b3",
            quantity="eq19.b3",
            sentence="(19) gives (B.3) for C_Delta_f = (I + F3) C_f and every F3 with F3 F3' <= delta_m^2 I.",
            given=[EQ19 <= 0, "F3 @ F3.T - dm**2 * eye(3) <= 0"],
            then=EQ_B3 <= 0,
            expand={"Cd": "Cf + F3 @ Cf"},
            unknowns={"F3": matrix(3, 3)},
            by=[
                Step(
                    "(19)",
                    "[[eye(3), zeros(3, 6), zeros(3, 6)], [zeros(6, 3), eye(6), zeros(6, 6)], "
                    "[zeros(6, 3), zeros(6, 6), eye(6)], [zeros(3, 3), Cf / eps3, zeros(3, 6)]]",
                ),
                Step("F3 @ F3.T - dm**2 * eye(3) <= 0", "row(eye(3), zeros(3, 6), zeros(3, 6))", scale="eps3"),
                Step("", "row(eps3 * F3.T, Cf, zeros(3, 6))", scale="1 / eps3"),
            ],
        ),
        source="(19)",
    )
    results.prove(
        implication(
            case,
            id="eq20-b5",
            quantity="eq20.b5",
            sentence="With P of Theorem 1 and x_f(0) = 0, (B.5) gives (20).",
            given=[EQ_B5 <= 0],
            then=EQ20 <= 0,
            expand={**STRUCTURE, "xi0": "col(x0, zeros(6, 1))"},
            by=[Step("(B.5)", "diag(eye(1), G1)")],
        ),
        source="(20)",
    )
    results.say("Appendix II", "(B.3) follows from (B.2) and from (19), (20) from (B.5)")


TASKS = (appendix_2,)
