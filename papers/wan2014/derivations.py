"""The derivations of the paper's proofs, each checked for matrices of any entries: (9), (11), (15) to (37)."""

import re
from typing import Any

from gainsay.proof import Certificate
from gainsay.statements import (
    Statement,
    Step,
    identical,
    implication,
    matrix,
    positive,
    read_constraint,
    scalar,
    symmetric,
)
from gainsay.tables import Case
from papers.wan2014.statements import (
    EQ14,
    EQ15,
    EQ18,
    EQ21,
    EQ22,
    EQ23,
    EQ24,
    EQ25,
    EQ25_CORRECTED,
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

#: Lambda' Lambda <= I, as Lemma 1 needs it
BOUNDED = "eye(6) - Lambda.T@Lambda >= 0"
#: X = P^-1 and Y = K P^-1
SUBSTITUTION = {"X": "inverse(P)", "Y": "K@inverse(P)"}
#: the loop of (9) and (11) in [x; e], and the feedback of (10) in it
LOOP = {"Acl": "[[A + DA - B@K, B@K], [DA, A - L@C]]", "k": "[[-K, K]]", "Pbar": "diag(P, P)"}
_SYMMETRIC = ("Q", "R", "U_x")


def _follows(case: Case, name: str, sentence: str, **parts: Any) -> Certificate:
    return implication(
        case,
        id=f"{name.replace('_', '-')}",
        quantity=f"derivation.{name}",
        sentence=sentence,
        invertible=("P", "Q", "R"),
        symmetric=_SYMMETRIC,
        **parts,
    )


def _same(statement: Statement, size: str) -> Step:
    """The hypothesis itself: what follows is the same matrix, written otherwise."""
    return Step(statement.label, f"eye({size})", left_inverse=f"eye({size})")


def error_dynamics(case: Case) -> Certificate:
    """(9): (1) less (7) with (6), and (11): (10) put into (1)."""
    six, three = matrix(6, 1), matrix(3, 1)
    return identical(
        case,
        "derivation.eq9_eq11",
        "(1) less (7) with (6) is (9), and (10) put into (1) is (11), for all matrices.",
        "col((A + DA)@x + B@u - (A@xh + B@u + L@(C@x - C@xh)), (A + DA)@x - B@(K@xh))",
        "col((A - L@C)@e + DA@x, (A + DA - B@K)@x + B@K@e)",
        {
            "x": six,
            "xh": six,
            "u": three,
            "DA": matrix(6, 6),
            "A": matrix(6, 6),
            "L": matrix(6, 3),
            "C": matrix(3, 6),
            "K": matrix(3, 6),
            "mass": scalar(),
        },
        id="eq9-eq11",
        definitions={"B": "col(zeros(3,3), eye(3)*mass)", "e": "x - xh"},
    )


def derivative_18(case: Case) -> Certificate:
    """(18): the derivative of (17) along (9) and (11)."""
    along = Statement("derivative", "(17)", ("xi",), {("xi", "xi"): "sym(Pbar@Acl)"}, EQ18.unknowns, EQ18.where)
    return _follows(
        case, "eq18", "The derivative of (17) along (9) and (11) is the form of (18).",
        given=[along <= 0], then=EQ18 <= 0, by=[Step("derivative", "eye(12)")], expand=LOOP,
    )  # fmt: skip


def dissipation_21(case: Case) -> Certificate:
    """(21) is (19) with (10) and (18) put in: the same matrix."""
    along = Statement(
        "(19)", "proof of Theorem 2", ("xi",), {("xi", "xi"): "sym(Pbar@Acl) + diag(Q, zeros(6,6)) + k.T@R@k"},
        EQ21.unknowns, EQ21.where,
    )  # fmt: skip
    return _follows(
        case, "eq21", "(21) is dV/dt + x'Qx + u'Ru < 0 of (19) along (9), (10) and (11).",
        given=[EQ21 < 0], then=along < 0, by=[_same(EQ21, "12")], expand=LOOP,
    )  # fmt: skip


def rewriting_22(case: Case) -> Certificate:
    """(22) with (23) is (21) with (3)."""
    return _follows(
        case, "eq22", "(22) with the matrices of (23) is (21) with (3) put in.",
        given=[EQ22 < 0], then=EQ21 < 0, by=[_same(EQ22, "12")], expand={**EQ23, "DA": "E1@Lambda@E2"},
    )  # fmt: skip


def lemma_1(case: Case) -> Certificate:
    """Lemma 1, the direction that the proof of Theorem 2 uses: a completed square."""
    nominal, bounded = "G + delta*D@D.T + E.T@E/delta < 0", "eye(5) - F.T@F >= 0"
    return implication(
        case,
        id="lemma-1",
        quantity="lemma1.sufficient",
        sentence="Where some delta > 0 satisfies (13), (12) holds for every F with F'F <= I.",
        given=[nominal, bounded],
        then="G + D@F@E + E.T@F.T@D.T < 0",
        by=[
            Step(nominal, "eye(7)", left_inverse="eye(7)"),
            Step("", "D.T - F@E/delta", scale="delta"),
            Step(bounded, "E", scale="1/delta"),
        ],
        unknowns={"G": symmetric(7), "D": matrix(7, 4), "F": matrix(4, 5), "E": matrix(5, 7), "delta": positive()},
    )


def robust_24(case: Case) -> Certificate:
    """(24) gives (22) for every Lambda: Lemma 1 with Delta, Phi and E of (23)."""
    return _follows(
        case, "eq24", "Where (24) holds, (22) holds for every Lambda with Lambda'Lambda <= I.",
        given=[EQ24 < 0, BOUNDED], then=EQ22 < 0, expand=EQ23,
        by=[
            _same(EQ24, "12"),
            Step("", "Delta.T - Phi@E/eps", scale="eps"),
            Step(BOUNDED, "row(E2, zeros(6,6))", scale="1/eps"),
        ],
    )  # fmt: skip


def _columns(*right: str) -> str:
    """Factor of a Schur complement: the identity over -C^-1 B' of the rows that go."""
    return f"col(eye(12), {', '.join(right)})"


_DOWN = "row(E2, zeros(6,6))/eps", "zeros(6,12)", "R@row(K, -K)", "-R@row(K, -K)", "Q@row(eye(6), zeros(6,6))"


def schur_25(case: Case) -> Certificate:
    """(25) as printed gives (24), with K'RK to spare."""
    return _follows(
        case, "eq25", "Where (25) holds as printed, with R > 0, (24) holds.",
        given=[EQ25 < 0, "R > 0"], then=EQ24 < 0, expand=EQ23,
        by=[
            Step("(25)", _columns(*_DOWN), left_inverse="row(eye(12), zeros(12,24))"),
            Step("R > 0", "row(-K, K)"),
        ],
    )  # fmt: skip


def schur_25_corrected(case: Case) -> Certificate:
    """(25) with one input column gives (24): its Schur complement."""
    down = (*_DOWN[:3], _DOWN[4])
    return _follows(
        case, "eq25_corrected", "Where (25) with one input column holds, (24) holds: it is its Schur complement.",
        given=[EQ25_CORRECTED < 0], then=EQ24 < 0, expand=EQ23,
        by=[Step(EQ25_CORRECTED.label, _columns(*down), left_inverse="row(eye(12), zeros(12,21))")],
    )  # fmt: skip


def _scaled(change: str) -> str:
    return f"diag({change}, {change}, eye(6), eye(6), eye(3), eye(3), eye(6))"


def congruence_14(case: Case) -> Certificate:
    """(14) gives (25): the congruence with diag(P, P, I) after X = P^-1 and Y = K P^-1."""
    return _follows(
        case, "eq14", "Where X > 0 and Y satisfy (14), P = X^-1 and K = Y X^-1 satisfy (25).",
        given=[EQ14 < 0], then=EQ25 < 0, expand=SUBSTITUTION,
        by=[Step("(14)", _scaled("P"), left_inverse=_scaled("inverse(P)"))],
    )  # fmt: skip


def congruence_25(case: Case) -> Certificate:
    """(25) gives (14): the same congruence back, as the paper does it."""
    return _follows(
        case, "eq25_to_eq14", "Where (25) holds, X = P^-1 and Y = K P^-1 satisfy (14).",
        given=[EQ25 < 0], then=EQ14 < 0, expand=SUBSTITUTION,
        by=[Step("(25)", _scaled("inverse(P)"), left_inverse=_scaled("P"))],
    )  # fmt: skip


def theorem_2(case: Case) -> Certificate:
    """From (14) to (19) in one step: what Theorem 2 needs of its LMI."""
    factor = f"col({', '.join(('diag(P, P)', *_DOWN))})"
    left = "row(diag(inverse(P), inverse(P)), zeros(12,24))"
    goal = Statement(
        "(19)", "proof of Theorem 2", ("xi",), {("xi", "xi"): "sym(Pbar@Acl) + diag(Q, zeros(6,6)) + k.T@R@k"},
        EQ21.unknowns, EQ21.where,
    )  # fmt: skip
    return implication(
        case,
        id="theorem-2-dissipation",
        quantity="theorem2.dissipation",
        sentence="Where X > 0, Y and eps > 0 satisfy (14), V = x'X^-1 x + e'X^-1 e and K = Y X^-1 satisfy "
        "dV/dt < -(x'Qx + u'Ru) along (9) to (11) for every Lambda with Lambda'Lambda <= I.",
        given=[EQ14 < 0, "R > 0", BOUNDED],
        then=goal < 0,
        by=[
            Step("(14)", factor, left_inverse=left),
            Step("R > 0", "row(-K, K)"),
            Step("", "Delta.T - Phi@E/eps", scale="eps"),
            Step(BOUNDED, "row(E2, zeros(6,6))", scale="1/eps"),
        ],
        expand={**SUBSTITUTION, **EQ23, "DA": "E1@Lambda@E2", **LOOP},
        invertible=("P", "Q", "R"),
        symmetric=_SYMMETRIC,
        faith=(
            "That dV/dt <= -(x'Qx + u'Ru) < 0 along all motions means asymptotic stability and J <= V(0), as (20).",
        ),
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
    return _follows(
        case, "eq29", "(29) with -rho and P^-1 is (15) with X = P^-1.",
        given=[EQ29_CORRECTED < 0], then=EQ15 < 0, by=[_same(EQ29_CORRECTED, "13")], expand={"X": "inverse(P)"},
    )  # fmt: skip


def congruence_30(case: Case) -> Certificate:
    """(15) gives (30): the congruence with diag(rho^-1, I)."""
    return _follows(
        case, "eq30", "Where (15) holds, (30) holds with rho^-1 for its unknown.",
        given=[EQ15 < 0], then=EQ30 < 0, expand={"inverse_rho": "1/rho"},
        by=[Step("(15)", "diag(1/rho, eye(6), eye(6))", left_inverse="diag(rho, eye(6), eye(6))")],
    )  # fmt: skip


def _of_axis(statement: Statement, axis: str = "x") -> Statement:
    return statement.given(axis=axis)


def congruence_31(case: Case) -> Certificate:
    """(31) gives (36): the congruence with diag(P, P, I)."""
    given, goal = _of_axis(EQ31), _of_axis(EQ36)
    return _follows(
        case, "eq36", "Where (31) holds, P = X^-1 and K = Y X^-1 satisfy (36).",
        given=[given < 0], then=goal < 0, expand=SUBSTITUTION, positive=("u_x",),
        by=[Step(given.label, "diag(P, P, eye(3))", left_inverse="diag(inverse(P), inverse(P), eye(3))")],
    )  # fmt: skip


def schur_36(case: Case) -> Certificate:
    """(36) gives (35): its Schur complement over rho."""
    given, goal = _of_axis(EQ36), _of_axis(EQ35)
    return _follows(
        case, "eq35", "Where (36) holds, (35) holds: its Schur complement, divided by rho.",
        given=[given < 0], then=goal < 0, positive=("u_x",),
        by=[
            Step(
                given.label, "col(eye(12), U_x@row(K, -K)/(u_x**2*inverse_rho))", scale="inverse_rho",
                left_inverse="row(eye(12), zeros(12,3))",
            )
        ],
    )  # fmt: skip


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
    return _follows(
        case, "eq31_one_row", "Where (31) holds, 2 U Y X^-1 Y' U' < u^2/rho: its form with X once.",
        given=[given < 0], then=goal < 0, positive=("u_x",),
        by=[
            Step(given.label, "[[eye(6), zeros(6,3)], [-eye(6), zeros(6,3)], [zeros(3,6), eye(3)]]", scale="1/2",
                 left_inverse="[[eye(6), zeros(6,6), zeros(6,3)], [zeros(3,6), zeros(3,6), eye(3)]]")
        ],
    )  # fmt: skip


def two_rows_31(case: Case) -> Certificate:
    """The form in one row gives (31) back, so that nothing is lost."""
    goal, one = _of_axis(EQ31), _of_axis(EQ31_ONE_ROW)
    both = Statement(
        "one row, X", "(31)", ("sum", "difference", "u"),
        {("sum", "sum"): "-X", **{(("difference" if a == "x" else a), ("difference" if b == "x" else b)): text
                                  for (a, b), text in one.blocks.items()}},
        goal.unknowns, goal.where,
    )  # fmt: skip
    return _follows(
        case, "eq31_two_rows", "Where X > 0 and the form of (31) with X once holds, (31) holds.",
        given=[both < 0], then=goal < 0, positive=("u_x",),
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
    )  # fmt: skip


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
    return _follows(
        case, "times_rho", "The sub-problem that is solved is (14), (30) and (31) times rho after the substitution.",
        given=[read_constraint(f"{before} < 0", "printed")], then=whole < 0, positive=("u_x", "rho"),
        expand={"inverse_rho": "1/rho", "weight": "1"},
        by=[Step("printed", "eye(37)", scale="rho", left_inverse="eye(37)")],
    )  # fmt: skip


DERIVATIONS = (
    error_dynamics, derivative_18, dissipation_21, rewriting_22, lemma_1, robust_24, schur_25, schur_25_corrected,
    congruence_14, congruence_25, theorem_2, bound_15, schur_29, congruence_30, congruence_31, schur_36, theorem_3,
    one_row_31, two_rows_31, schur_37, times_rho,
)  # fmt: skip
