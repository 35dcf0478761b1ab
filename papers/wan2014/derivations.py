"""The derivations of the paper's proofs, each checked for matrices of any entries: (9), (11), (16) to (28)."""

from typing import Any

from gainsay.proof import Certificate
from gainsay.statements import Statement, Step, identical, implication, matrix, positive, scalar, symmetric
from gainsay.tables import Case
from papers.wan2014.statements import EQ14, EQ18, EQ21, EQ22, EQ23, EQ24, EQ25, EQ25_CORRECTED

#: Lambda' Lambda <= I, as Lemma 1 needs it
BOUNDED = "eye(6) - Lambda.T@Lambda >= 0"
#: X = P^-1 and Y = K P^-1
SUBSTITUTION = {"X": "inverse(P)", "Y": "K@inverse(P)"}
#: the loop of (9) and (11) in [x; e], and the feedback of (10) in it
LOOP = {"Acl": "[[A + DA - B@K, B@K], [DA, A - L@C]]", "k": "[[-K, K]]", "Pbar": "diag(P, P)"}
SYMMETRIC = ("Q", "R", "U_x")


def follows(case: Case, name: str, sentence: str, **parts: Any) -> Certificate:
    """One step, in the quantity ``derivation.<name>``."""
    return implication(
        case,
        id=f"{name.replace('_', '-')}",
        quantity=f"derivation.{name}",
        sentence=sentence,
        invertible=("P", "Q", "R"),
        symmetric=SYMMETRIC,
        **parts,
    )


def same(statement: Statement, size: str) -> Step:
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
    return follows(
        case,
        "eq18",
        "The derivative of (17) along (9) and (11) is the form of (18).",
        given=[along <= 0],
        then=EQ18 <= 0,
        by=[Step("derivative", "eye(12)")],
        expand=LOOP,
    )


def dissipation_21(case: Case) -> Certificate:
    """(21) is (19) with (10) and (18) put in: the same matrix."""
    along = Statement(
        "(19)",
        "proof of Theorem 2",
        ("xi",),
        {("xi", "xi"): "sym(Pbar@Acl) + diag(Q, zeros(6,6)) + k.T@R@k"},
        EQ21.unknowns,
        EQ21.where,
    )
    return follows(
        case,
        "eq21",
        "(21) is dV/dt + x'Qx + u'Ru < 0 of (19) along (9), (10) and (11).",
        given=[EQ21 < 0],
        then=along < 0,
        by=[same(EQ21, "12")],
        expand=LOOP,
    )


def rewriting_22(case: Case) -> Certificate:
    """(22) with (23) is (21) with (3)."""
    return follows(
        case,
        "eq22",
        "(22) with the matrices of (23) is (21) with (3) put in.",
        given=[EQ22 < 0],
        then=EQ21 < 0,
        by=[same(EQ22, "12")],
        expand={**EQ23, "DA": "E1@Lambda@E2"},
    )


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
    return follows(
        case,
        "eq24",
        "Where (24) holds, (22) holds for every Lambda with Lambda'Lambda <= I.",
        given=[EQ24 < 0, BOUNDED],
        then=EQ22 < 0,
        expand=EQ23,
        by=[
            same(EQ24, "12"),
            Step("", "Delta.T - Phi@E/eps", scale="eps"),
            Step(BOUNDED, "row(E2, zeros(6,6))", scale="1/eps"),
        ],
    )


def _columns(*right: str) -> str:
    """Factor of a Schur complement: the identity over -C^-1 B' of the rows that go."""
    return f"col(eye(12), {', '.join(right)})"


_DOWN = "row(E2, zeros(6,6))/eps", "zeros(6,12)", "R@row(K, -K)", "-R@row(K, -K)", "Q@row(eye(6), zeros(6,6))"


def schur_25(case: Case) -> Certificate:
    """(25) as printed gives (24), with K'RK to spare."""
    return follows(
        case,
        "eq25",
        "Where (25) holds as printed, with R > 0, (24) holds.",
        given=[EQ25 < 0, "R > 0"],
        then=EQ24 < 0,
        expand=EQ23,
        by=[Step("(25)", _columns(*_DOWN), left_inverse="row(eye(12), zeros(12,24))"), Step("R > 0", "row(-K, K)")],
    )


def schur_25_corrected(case: Case) -> Certificate:
    """(25) with one input column gives (24): its Schur complement."""
    down = (*_DOWN[:3], _DOWN[4])
    return follows(
        case,
        "eq25_corrected",
        "Where (25) with one input column holds, (24) holds: it is its Schur complement.",
        given=[EQ25_CORRECTED < 0],
        then=EQ24 < 0,
        expand=EQ23,
        by=[Step(EQ25_CORRECTED.label, _columns(*down), left_inverse="row(eye(12), zeros(12,21))")],
    )


def _scaled(change: str) -> str:
    return f"diag({change}, {change}, eye(6), eye(6), eye(3), eye(3), eye(6))"


def congruence_14(case: Case) -> Certificate:
    """(14) gives (25): the congruence with diag(P, P, I) after X = P^-1 and Y = K P^-1."""
    return follows(
        case,
        "eq14",
        "Where X > 0 and Y satisfy (14), P = X^-1 and K = Y X^-1 satisfy (25).",
        given=[EQ14 < 0],
        then=EQ25 < 0,
        expand=SUBSTITUTION,
        by=[Step("(14)", _scaled("P"), left_inverse=_scaled("inverse(P)"))],
    )


def congruence_25(case: Case) -> Certificate:
    """(25) gives (14): the same congruence back, as the paper does it."""
    return follows(
        case,
        "eq25_to_eq14",
        "Where (25) holds, X = P^-1 and Y = K P^-1 satisfy (14).",
        given=[EQ25 < 0],
        then=EQ14 < 0,
        expand=SUBSTITUTION,
        by=[Step("(25)", _scaled("inverse(P)"), left_inverse=_scaled("P"))],
    )


def theorem_2(case: Case) -> Certificate:
    """From (14) to (19) in one step: what Theorem 2 needs of its LMI."""
    factor = f"col({', '.join(('diag(P, P)', *_DOWN))})"
    left = "row(diag(inverse(P), inverse(P)), zeros(12,24))"
    goal = Statement(
        "(19)",
        "proof of Theorem 2",
        ("xi",),
        {("xi", "xi"): "sym(Pbar@Acl) + diag(Q, zeros(6,6)) + k.T@R@k"},
        EQ21.unknowns,
        EQ21.where,
    )
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
        symmetric=SYMMETRIC,
        faith=(
            "That dV/dt <= -(x'Qx + u'Ru) < 0 along all motions means asymptotic stability and J <= V(0), as (20).",
        ),
    )


DERIVATIONS = (
    error_dynamics,
    derivative_18,
    dissipation_21,
    rewriting_22,
    lemma_1,
    robust_24,
    schur_25,
    schur_25_corrected,
    congruence_14,
    congruence_25,
    theorem_2,
)
