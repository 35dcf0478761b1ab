"""Derivations of the bounds on cost and thrust, (15) and (29) to (37), each checked for matrices of any entries."""

import re

from gainsay.proof import Certificate
from gainsay.statements import Statement, Step, implication, matrix, positive, read_constraint, symmetric
from gainsay.tables import Case
from papers.wan2014.derivations import SUBSTITUTION, follows, same
from papers.wan2014.statements import (
    EQ15,
    EQ27,
    EQ29_CORRECTED,
    EQ30,
    EQ31,
    EQ31_ONE_ROW,
    EQ35,
    EQ36,
    EQ37,
    FEEDBACK,
    FEEDBACK_TIMES_RHO,
    START_TIMES_RHO,
    THRUST_TIMES_RHO,
)


def bound_15(case: Case) -> Certificate:
    """(15) gives V(0) < rho of (27)."""
    return implication(
        case,
        id="theorem-2-bound",
        quantity="theorem2.bound",
        sentence="Where X > 0 and rho satisfy (15), V(0) of (17) is below rho, as (27).",
        given=[EQ15 < 0],
        then=EQ27 < 0,
        by=[Step("(15)", "col(1, P@x0, P@e0)", left_inverse="row(1, zeros(1,6), zeros(1,6))")],
        expand={"X": "inverse(P)"},
        invertible=("P",),
    )


def schur_29(case: Case) -> Certificate:
    """(29) with its two slips corrected is (15)."""
    return follows(
        case,
        "eq29",
        "(29) with -rho and P^-1 is (15) with X = P^-1.",
        given=[EQ29_CORRECTED < 0],
        then=EQ15 < 0,
        by=[same(EQ29_CORRECTED, "13")],
        expand={"X": "inverse(P)"},
    )


def congruence_30(case: Case) -> Certificate:
    """(15) gives (30): the congruence with diag(rho^-1, I)."""
    return follows(
        case,
        "eq30",
        "Where (15) holds, (30) holds with rho^-1 for its unknown.",
        given=[EQ15 < 0],
        then=EQ30 < 0,
        expand={"inverse_rho": "1/rho"},
        by=[Step("(15)", "diag(1/rho, eye(6), eye(6))", left_inverse="diag(rho, eye(6), eye(6))")],
    )


def _of_axis(statement: Statement, axis: str = "x") -> Statement:
    return statement.given(axis=axis)


def congruence_31(case: Case) -> Certificate:
    """(31) gives (36): the congruence with diag(P, P, I)."""
    given, goal = _of_axis(EQ31), _of_axis(EQ36)
    return follows(
        case,
        "eq36",
        "Where (31) holds, P = X^-1 and K = Y X^-1 satisfy (36).",
        given=[given < 0],
        then=goal < 0,
        expand=SUBSTITUTION,
        positive=("u_x",),
        by=[Step(given.label, "diag(P, P, eye(3))", left_inverse="diag(inverse(P), inverse(P), eye(3))")],
    )


def schur_36(case: Case) -> Certificate:
    """(36) gives (35): its Schur complement over rho."""
    given, goal = _of_axis(EQ36), _of_axis(EQ35)
    return follows(
        case,
        "eq35",
        "Where (36) holds, (35) holds: its Schur complement, divided by rho.",
        given=[given < 0],
        then=goal < 0,
        positive=("u_x",),
        by=[
            Step(
                given.label,
                "col(eye(12), U_x@row(K, -K)/(u_x**2*inverse_rho))",
                scale="inverse_rho",
                left_inverse="row(eye(12), zeros(12,3))",
            )
        ],
    )


def theorem_3(case: Case) -> Certificate:
    """(31) and V <= rho bound the thrust: (33), (34) and (35) in one step, for a state xi = [x; e]."""
    given = _of_axis(EQ31)
    kept = "rho - x.T@P@x - e.T@P@e >= 0"
    held = "U_x@(K@e - K@x)"
    return implication(
        case,
        id="theorem-3-thrust",
        quantity="theorem3.thrust",
        sentence="Where (31) holds and V = x'X^-1 x + e'X^-1 e is at most rho, U_i u with u = -Y X^-1 (x - e) has a "
        "modulus of at most the bound of (5), as (33) to (35).",
        given=[given < 0, kept],
        then=f"u_x**2 - ({held}).T@({held}) >= 0",
        by=[
            Step(given.label, f"col(P@x, P@e, {held}*(-1)*rho/u_x**2)", scale="u_x**2/rho"),
            Step(kept, "1", scale="u_x**2/rho"),
        ],
        expand={**SUBSTITUTION, "inverse_rho": "1/rho"},
        unknowns={"x": matrix(6, 1), "e": matrix(6, 1), "rho": positive(), "P": symmetric(6), "K": matrix(3, 6)},
        invertible=("P",),
        positive=("u_x", "rho"),
        symmetric=("U_x",),
        faith=("That V does not grow along the motions, by (19): then V <= V(0) <= rho at all times.",),
    )


def one_row_31(case: Case) -> Certificate:
    """(31) gives its form in one row, which the programs use."""
    given, goal = _of_axis(EQ31), _of_axis(EQ31_ONE_ROW)
    return follows(
        case,
        "eq31_one_row",
        "Where (31) holds, 2 U Y X^-1 Y' U' < u^2/rho: its form with X once.",
        given=[given < 0],
        then=goal < 0,
        positive=("u_x",),
        by=[
            Step(
                given.label,
                "[[eye(6), zeros(6,3)], [-eye(6), zeros(6,3)], [zeros(3,6), eye(3)]]",
                scale="1/2",
                left_inverse="[[eye(6), zeros(6,6), zeros(6,3)], [zeros(3,6), zeros(3,6), eye(3)]]",
            )
        ],
    )


def two_rows_31(case: Case) -> Certificate:
    """The form in one row gives (31) back, so that nothing is lost."""
    goal, one = _of_axis(EQ31), _of_axis(EQ31_ONE_ROW)
    both = Statement(
        "one row, X",
        "(31)",
        ("sum", "difference", "u"),
        {
            ("sum", "sum"): "-X",
            **{
                (("difference" if a == "x" else a), ("difference" if b == "x" else b)): text
                for (a, b), text in one.blocks.items()
            },
        },
        goal.unknowns,
        goal.where,
    )
    return follows(
        case,
        "eq31_two_rows",
        "Where X > 0 and the form of (31) with X once holds, (31) holds.",
        given=[both < 0],
        then=goal < 0,
        positive=("u_x",),
        by=[
            Step(
                both.label,
                "[[0.5*eye(6), 0.5*eye(6), zeros(6,3)], [0.5*eye(6), -0.5*eye(6), zeros(6,3)], "
                "[zeros(3,6), zeros(3,6), eye(3)]]",
                scale="2",
                left_inverse="[[eye(6), eye(6), zeros(6,3)], [eye(6), -eye(6), zeros(6,3)], "
                "[zeros(3,6), zeros(3,6), eye(3)]]",
            )
        ],
    )


def schur_37(case: Case) -> Certificate:
    """(37) is 0 < rho < w."""
    return implication(
        case,
        id="eq37-bound",
        quantity="eq37.bounds_rho",
        sentence="Where (37) holds, rho < w: minimising w minimises the bound rho.",
        given=[EQ37 < 0],
        then="rho - w < 0",
        by=[Step("(37)", "col(1, rho)", left_inverse="row(1, 0)")],
        expand={"inverse_rho": "1/rho"},
        unknowns={"rho": positive(), "w": positive()},
    )


def times_rho(case: Case) -> Certificate:
    """(14), (30) and (31) times rho, after X <- rho X, Y <- rho Y, eps <- rho eps: the sub-problem that is solved."""
    printed = FEEDBACK, EQ30.sub("rho", "x"), EQ31_ONE_ROW.given(axis="x")
    solved = FEEDBACK_TIMES_RHO, START_TIMES_RHO, THRUST_TIMES_RHO.given(axis="x")
    before, after = (f"diag({', '.join(s.formula for s in three)})" for three in (printed, solved))
    before = re.sub(r"\b(X|Y|eps)\b", r"(\1/rho)", before)
    whole = Statement("sub-problem", "(38)", ("all",), {("all", "all"): after}, EQ30.unknowns, FEEDBACK.where)
    return follows(
        case,
        "times_rho",
        "The sub-problem that is solved is (14), (30) and (31) times rho after the substitution.",
        given=[read_constraint(f"{before} < 0", "printed")],
        then=whole < 0,
        positive=("u_x", "rho"),
        expand={"inverse_rho": "1/rho", "weight": "1"},
        by=[Step("printed", "eye(37)", scale="rho", left_inverse="eye(37)")],
    )


DERIVATIONS = (
    bound_15,
    schur_29,
    congruence_30,
    congruence_31,
    schur_36,
    theorem_3,
    one_row_31,
    two_rows_31,
    schur_37,
    times_rho,
)
