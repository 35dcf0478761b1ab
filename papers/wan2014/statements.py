"""The inequalities of the paper, each written once, and the programs made of them."""

from collections.abc import Mapping
from typing import Any

from gainsay.statements import Stated, Statement, diagonal, matrix, positive, read_constraint, scalar, symmetric
from gainsay.statements.statement import Constraint
from papers.wan2014.plant import AXES

#: A and B of (2)
A_FORMULA = "[[zeros(3,3), eye(3)], [diag(3*n**2, 0, -n**2), [[0, 2*n, 0], [-2*n, 0, 0], [0, 0, 0]]]]"
#: the observer's error matrix of (9)
OBSERVER = {"n": "number('mean_motion')", "A": A_FORMULA, "L": "printed('L')", "C": "printed('C')"}


def plant(case: Any) -> dict[str, str]:
    """Return (2), (39), (41), (42), the weights, the start and the thrust bounds as formulas over the tables."""
    powers = case.printed("E2_power").rows
    entries = [[f"c[{i},{j}]*n**{p.value}" for j, p in enumerate(row)] for i, row in enumerate(powers)]
    return {
        **OBSERVER,
        "B": "[[zeros(3,3)], [eye(3)/number('mass')]]",
        "E1": "number('eccentricity')*printed('E1_over_e')",
        "c": "printed('E2_coefficient')",
        "E2": "[" + ", ".join("[" + ", ".join(row) + "]" for row in entries) + "]",
        "Q": "printed('Q')",
        "R": "printed('R')",
        "x0": "printed('x0')",
        # e(0) of the simulations: the estimate starts at the measured position, at rest
        "e0": "col(zeros(3,1), x0[3:6,0])",
        **{f"U_{axis}": f"unit(3,{i})@unit(3,{i}).T" for i, axis in enumerate(AXES)},
        **{f"u_{axis}": f"number('thrust_max_{axis}')" for axis in AXES},
    }


#: unknowns of Theorems 2 and 3
THEOREM = {"X": symmetric(6), "Y": matrix(3, 6), "eps": positive(), "rho": positive()}
#: unknowns of the proofs, before X = P^-1 and Y = K P^-1
PROOF = {"P": symmetric(6), "K": matrix(3, 6), "eps": positive(), "rho": positive(), "Lambda": matrix(6, 6)}


def _statement(label: str, source: str, rows: tuple[str, ...], blocks: dict, **unknowns: Any) -> Statement:
    known = {**THEOREM, **PROOF, **unknowns}
    return Statement(label, source, rows, blocks, known, plant)


EQ14 = _statement(
    "(14)",
    "Theorem 2",
    ("x", "e", "E2", "0", "u", "u again", "Q"),
    {
        ("x", "x"): "sym(A@X - B@Y) + eps*E1@E1.T",
        ("x", "e"): "B@Y + eps*E1@E1.T",
        ("x", "E2"): "X@E2.T",
        ("x", "u"): "Y.T",
        ("x", "u again"): "-Y.T",
        ("x", "Q"): "X",
        ("e", "e"): "sym((A - L@C)@X) + eps*E1@E1.T",
        ("e", "u"): "-Y.T",
        ("e", "u again"): "Y.T",
        ("E2", "E2"): "-eps*eye(6)",
        ("0", "0"): "-eps*eye(6)",
        ("u", "u"): "-inverse(R)",
        ("u again", "u again"): "-inverse(R)",
        ("Q", "Q"): "-inverse(Q)",
    },
)
#: without the row that says eps > 0 again and without the second column of the input
EQ14_CORRECTED = EQ14.corrected({}, without=("0", "u again"))

EQ15 = _statement(
    "(15)",
    "Theorem 2",
    ("rho", "x", "e"),
    {("rho", "rho"): "-rho", ("rho", "x"): "x0.T", ("rho", "e"): "e0.T", ("x", "x"): "-X", ("e", "e"): "-X"},
)
#: the matrix of (18), the form of dV/dt
EQ18 = _statement(
    "(18)",
    "proof of Theorem 2",
    ("x", "e"),
    {("x", "x"): "sym(P@(A + DA - B@K))", ("x", "e"): "P@B@K + DA.T@P", ("e", "e"): "sym(P@(A - L@C))"},
    DA=matrix(6, 6),
)
EQ21 = _statement(
    "(21)",
    "proof of Theorem 2",
    ("x", "e"),
    {
        ("x", "x"): "sym(P@(A + DA - B@K)) + Q + K.T@R@K",
        ("x", "e"): "P@B@K + DA.T@P - K.T@R@K",
        ("e", "e"): "sym(P@(A - L@C)) + K.T@R@K",
    },
    DA=matrix(6, 6),
)
#: Psi, Delta, Phi and E of (23)
EQ23 = {
    "Psi": "[[sym(P@(A - B@K)) + Q + K.T@R@K, P@B@K - K.T@R@K], [..., sym(P@(A - L@C)) + K.T@R@K]]",
    "Delta": "[[P@E1, zeros(6,6)], [P@E1, zeros(6,6)]]",
    "Phi": "[[Lambda, zeros(6,6)], [zeros(6,6), zeros(6,6)]]",
    "E": "[[E2, zeros(6,6)], [zeros(6,6), zeros(6,6)]]",
}
EQ22 = _statement("(22)", "proof of Theorem 2", ("xi",), {("xi", "xi"): "Psi + Delta@Phi@E + E.T@Phi.T@Delta.T"})
EQ24 = _statement("(24)", "proof of Theorem 2", ("xi",), {("xi", "xi"): "Psi + eps*Delta@Delta.T + E.T@E/eps"})
#: (25) with the blocks of (26)
EQ25 = _statement(
    "(25)",
    "proof of Theorem 2",
    ("x", "e", "E2", "0", "u", "u again", "Q"),
    {
        ("x", "x"): "sym(P@(A - B@K)) + eps*P@E1@E1.T@P",
        ("x", "e"): "P@B@K + eps*P@E1@E1.T@P",
        ("x", "E2"): "E2.T",
        ("x", "u"): "K.T",
        ("x", "u again"): "-K.T",
        ("x", "Q"): "eye(6)",
        ("e", "e"): "sym(P@(A - L@C)) + eps*P@E1@E1.T@P",
        ("e", "u"): "-K.T",
        ("e", "u again"): "K.T",
        ("E2", "E2"): "-eps*eye(6)",
        ("0", "0"): "-eps*eye(6)",
        ("u", "u"): "-inverse(R)",
        ("u again", "u again"): "-inverse(R)",
        ("Q", "Q"): "-inverse(Q)",
    },
)
EQ25_CORRECTED = EQ25.corrected({}, without=("u again",))
#: (27), as a number that is at most zero
EQ27 = _statement("(27)", "proof of Theorem 2", ("1",), {("1", "1"): "x0.T@P@x0 + e0.T@P@e0 - rho"})
EQ29 = _statement(
    "(29)",
    "proof of Theorem 2",
    ("rho", "x", "e"),
    {("rho", "rho"): "rho", ("rho", "x"): "x0.T", ("rho", "e"): "e0.T", ("x", "x"): "-P", ("e", "e"): "-P"},
)
EQ29_CORRECTED = EQ29.corrected({("rho", "rho"): "-rho", ("x", "x"): "-inverse(P)", ("e", "e"): "-inverse(P)"})
#: what the errata follow from
EDITIONS = (EQ14_CORRECTED, EQ29_CORRECTED)
#: Theorem 3 with rho^-1 as the unknown
INVERSE = {"inverse_rho": positive(), "w": positive()}
EQ30 = _statement(
    "(30)",
    "Theorem 3",
    ("rho", "x", "e"),
    {
        ("rho", "rho"): "-inverse_rho",
        ("rho", "x"): "inverse_rho*x0.T",
        ("rho", "e"): "inverse_rho*e0.T",
        ("x", "x"): "-X",
        ("e", "e"): "-X",
    },
    **INVERSE,
)
#: (31) for an axis
EQ31 = _statement(
    "(31) {axis}",
    "Theorem 3",
    ("x", "e", "u"),
    {
        ("x", "x"): "-X",
        ("x", "u"): "Y.T@U_{axis}.T",
        ("e", "e"): "-X",
        ("e", "u"): "-Y.T@U_{axis}.T",
        ("u", "u"): "-u_{axis}**2*inverse_rho*eye(3)",
    },
    **INVERSE,
)
#: (31) with its two rows X made one: 2 U Y X^-1 Y' U' < u^2 / rho
EQ31_ONE_ROW = EQ31.corrected({("u", "u"): "-u_{axis}**2*inverse_rho/2*eye(3)"}, without=("e",), edition="in one row")
#: (35), what is asked to be negative
EQ35 = _statement(
    "(35) {axis}",
    "proof of Theorem 3",
    ("x", "e"),
    {
        ("x", "x"): "K.T@U_{axis}.T@U_{axis}@K/u_{axis}**2 - inverse_rho*P",
        ("x", "e"): "-K.T@U_{axis}.T@U_{axis}@K/u_{axis}**2",
        ("e", "e"): "K.T@U_{axis}.T@U_{axis}@K/u_{axis}**2 - inverse_rho*P",
    },
    **INVERSE,
)
EQ36 = _statement(
    "(36) {axis}",
    "proof of Theorem 3",
    ("x", "e", "u"),
    {
        ("x", "x"): "-P",
        ("x", "u"): "K.T@U_{axis}.T",
        ("e", "e"): "-P",
        ("e", "u"): "-K.T@U_{axis}.T",
        ("u", "u"): "-u_{axis}**2*inverse_rho*eye(3)",
    },
    **INVERSE,
)
EQ37 = _statement(
    "(37)",
    "Theorem 3",
    ("w", "rho"),
    {("w", "w"): "-w", ("w", "rho"): "eye(1)", ("rho", "rho"): "-inverse_rho"},
    **INVERSE,
)


def thrust(statement: Statement) -> list[Constraint]:
    """Return the members of (31) or of an edition of it, one an axis, below zero."""
    return [statement.given(f"(31) {axis}", axis=axis) < 0 for axis in AXES]


def problem_38(case: Any) -> Stated:
    """Return (38) as printed, e(0) that of the simulations."""
    held = [EQ14 < 0, EQ30 < 0, thrust(EQ31), EQ37 < 0, "X > 0"]
    return Stated(case, held, minimise="w", label="(38)")


#: block rows 1, 3, 5, 7 of (14): what is left of it without estimation error
FEEDBACK = EQ14.sub("x", "E2", "u", "Q", label="(14) 1,3,5,7")
#: the same times rho after X <- rho X, Y <- rho Y, eps <- rho eps, for the input weight `weight` R
FEEDBACK_TIMES_RHO = FEEDBACK.corrected(
    {("u", "u"): "-rho*inverse(weight*R)", ("Q", "Q"): "-rho*inverse(Q)"}, edition="times rho"
)
#: (30) at e(0) = 0 after the same substitution
START_TIMES_RHO = EQ30.sub("rho", "x").corrected({("rho", "rho"): "-eye(1)", ("rho", "x"): "x0.T"}, edition="times rho")
#: (31) in one row after the same substitution
THRUST_TIMES_RHO = EQ31_ONE_ROW.corrected({("u", "u"): "-u_{axis}**2/2*eye(3)"}, edition="times rho")


def state_feedback(case: Any, saturated: bool = True, weight: str = "1", **texts: str) -> Stated:
    """Return block rows 1, 3, 5, 7 of (14) with (30) at e(0) = 0 and (31): what the printed X, Y, K solve.

    Linear in rho after X <- rho X, Y <- rho Y, eps <- rho eps.

    Parameters
    ----------
    case : gainsay.tables.Case
    saturated : bool
        Whether (31) is imposed.
    weight : str
        Factor of R: 1 as printed; 2 where its term is counted twice, as the two columns of (14) do.
    **texts
        Unknowns that are given by formulas instead.
    """
    unknowns = {name: unknown for name, unknown in THEOREM.items() if name not in texts}
    limits = thrust(THRUST_TIMES_RHO) if saturated else []
    held = [
        FEEDBACK_TIMES_RHO.defining(texts, label="(14) 1,3,5,7", unknowns=unknowns, weight=weight) < 0,
        START_TIMES_RHO.defining(texts, label="(30)", unknowns=unknowns) < 0,
        [
            Constraint(c.label, c.left, c.relation, c.right, c.statement.defining(texts, unknowns=unknowns))
            for c in limits
            if c.statement is not None
        ],
    ]
    return Stated(case, held, minimise="rho", unknowns=unknowns, label="(14) 1,3,5,7 with (30), (31)")


def unscaled_subproblem(case: Any, minimise: str | None = None, *, boxes: Mapping[str, str], **more: Any) -> Stated:
    """Return the same sub-problem in the paper's unknowns, linear in 1/rho; `boxes` keep printed digits."""
    held = [FEEDBACK < 0, EQ30.sub("rho", "x") < 0, thrust(EQ31_ONE_ROW), *more.pop("held", ())]
    return Stated(case, held, minimise=minimise, boxes=boxes, label="box of (43)", **more)


def printed_digits(case: Any, minimise: str | None = None) -> Stated:
    """Return all points of the sub-problem that round to (43)."""
    return unscaled_subproblem(case, minimise, boxes={"X": "X", "Y": "Y"})


def near_optimal(case: Any, rho: float) -> Stated:
    """Return all points of the sub-problem in the paper's unknowns with a bound below rho."""
    level = read_constraint(f"inverse_rho > {1 / rho!r}", "near the optimum")
    return unscaled_subproblem(case, boxes={}, held=[level]).changed(label="near-optimal sub-problem")


#: velocities' part of the identity: B' v = 0 exactly where it takes v to zero
_VELOCITIES = "[[zeros(3,3), zeros(3,3)], [zeros(3,3), eye(3)]]"
#: V of the refutation: B' (V1 - V2) = 0, so that Y drops out
MULTIPLIERS = Statement(
    "V",
    "(14)",
    ("x", "e"),
    {("x", "x"): "V1", ("x", "e"): f"[[eye(3)], [zeros(3,3)]]@V2 + {_VELOCITIES}@V1", ("e", "e"): "V3"},
    {"V1": symmetric(6), "V2": matrix(3, 6), "V3": symmetric(6), "level": scalar()},
    OBSERVER,
)


def farkas_multipliers(case: Any) -> Stated:
    """Return the multipliers that refute (14): V >= 0 of trace 1 with rows 4-6 of V1 and V2 equal, and W >= l I.

    W = A'V1 + V1 A + Ac'V3 + V3 Ac. The weighted sum of the first two block rows and columns of (14) is then tr(W X)
    plus a non-negative multiple of eps.
    """
    held = [
        MULTIPLIERS >= 0,
        read_constraint("sym(V1@A) + sym(V3@(A - L@C)) - level*eye(6) >= 0", "W"),
        read_constraint("trace(V1) + trace(V3) == 1", "trace V"),
    ]
    return Stated(case, held, minimise="-level", label="Farkas multipliers of (14)")


def closed_loop(case: Any, gain: str) -> dict[str, str]:
    """Return the closed loop (9), (11) in xi = [x; e] for the formula of a gain; the dead channel of (42) left out."""
    return {
        **plant(case),
        "K": gain,
        "Acl": "[[A - B@K, B@K], [zeros(6,6), A - L@C]]",
        "H": "[[E1[0:6,0:5]], [E1[0:6,0:5]]]",
        "Cz": "[[E2[0:5,0:6], zeros(5,6)]]",
        "k": "[[-K, K]]",
        "weight": "diag(Q, zeros(6,6)) + k.T@R@k",
        "xi0": "col(x0, e0)",
    }


#: fields of `quadratic_bound` for that closed loop
SYSTEM = {"A": "Acl", "x0": "xi0", "H": "H", "Cz": "Cz", "blocks": [["repeated", 1]] * 5}
_LYAPUNOV = {"P": symmetric(12), "S": diagonal(5)}


def dissipation(case: Any, gain: str, weight: str) -> Statement:
    """dV/dt + xi' weight xi under one multiplier a channel, V = xi' P xi; S-procedure with |Lambda_ii(t)| <= 1."""
    return Statement(
        "dissipation",
        "(19)",
        ("xi", "w"),
        {("xi", "xi"): f"sym(P@Acl) + Cz.T@S@Cz + {weight}", ("xi", "w"): "P@H", ("w", "w"): "-S"},
        _LYAPUNOV,
        closed_loop(case, gain),
    )


def cost_bound(case: Any, gain: str) -> Stated:
    """Return the least certified bound on J from xi(0), over all 12x12 P and one multiplier a channel."""
    held = [dissipation(case, gain, "weight") < 0, "P > 0"]
    return Stated(case, held, minimise="xi0.T@P@xi0", label="full Lyapunov cost")


def thrust_bound(case: Any, gain: str, axis: int) -> Stated:
    """Return the least certified square of the thrust along an axis (N^2), likewise."""
    reach = Statement(
        "reach",
        "(5)",
        ("xi", "u"),
        {("xi", "xi"): "P", ("xi", "u"): f"k[{axis},0:12].T", ("u", "u"): "square"},
        {**_LYAPUNOV, "square": positive()},
        closed_loop(case, gain),
    )
    start = read_constraint("1 - xi0.T@P@xi0 > 0", "start inside")
    held = [dissipation(case, gain, "zeros(12,12)") < 0, reach > 0, start]
    return Stated(case, held, minimise="square", label=f"full Lyapunov thrust {AXES[axis]}")


#: Theorem 2 with separate Lyapunov matrices for estimate and error, V = xhat' X^-1 xhat + e' P e; multipliers fixed
JOINT = Statement(
    "joint",
    "Theorem 2",
    ("estimate", "e", "channel", "output", "Q", "u"),
    {
        ("estimate", "estimate"): "sym(A@X - B@Y)",
        ("estimate", "e"): "L@C",
        ("estimate", "output"): "X@E2[0:5,0:6].T",
        ("estimate", "Q"): "X",
        ("estimate", "u"): "Y.T",
        ("e", "e"): "sym(P@(A - L@C))",
        ("e", "channel"): "P@E1[0:6,0:5]",
        ("e", "output"): "E2[0:5,0:6].T",
        ("e", "Q"): "eye(6)",
        ("channel", "channel"): "-M",
        ("output", "output"): "-inverse(M)",
        ("Q", "Q"): "-inverse(Q)",
        ("u", "u"): "-inverse(R)",
    },
    {"X": symmetric(6), "Y": matrix(3, 6), "P": symmetric(6), "rho": positive()},
    lambda case: {**plant(case), "M": "design('joint', 'M')"},
)
JOINT_START = Statement(
    "start",
    "(15)",
    ("rho", "estimate"),
    {("rho", "rho"): "rho - e0.T@P@e0", ("rho", "estimate"): "x0.T - e0.T", ("estimate", "estimate"): "X"},
    JOINT.unknowns,
    JOINT.where,
)


def joint_design(case: Any, **texts: str) -> Stated:
    """Return the corrected theorem: the least bound over K = Y X^-1 and both Lyapunov matrices, no thrust limits."""
    held = [JOINT.defining(texts) < 0, JOINT_START.defining(texts) > 0, "P > 0"]
    return Stated(case, held, minimise="rho", label="joint design")
