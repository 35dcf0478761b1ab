"""Certificates of the paper's algebra: (2) to (6), factorisations, the reduction (7), Lemmas 1 and 2, and misprints."""

from collections.abc import Iterator

from gainsay.proof import Certificate, build
from gainsay.statements import differing, identical, matrix, scalar
from gainsay.tables import Case
from papers.li2021.statements import (
    FACTORS,
    G0_33,
    G0_33_CORRECTED,
    PLANT,
    ROTATION_32,
    ROTATION_32_CORRECTED,
)

RATE = "[[1, 0, -st], [0, cf, sf*ct], [0, -sf, cf*ct]]"
EULER_RATES = "[[dphi], [dtheta], [dpsi]]"
#: the display after (4)
AFTER_4 = f"({RATE}) @ {EULER_RATES} - n * [[ct*sp], [sf*st*sp + cf*cp], [cf*st*sp - sf*cp]]"
CIRCLES = ["cf**2 + sf**2 - 1", "ct**2 + st**2 - 1", "cp**2 + sp**2 - 1"]
#: sines and cosines to first order in angles e phi, e theta, e psi
FIRST_ORDER = (("sf", "e*phi"), ("cf", "1"), ("st", "e*theta"), ("ct", "1"), ("sp", "e*psi"), ("cp", "1"))
#: a point at which the relations of an identity meet, 1 for all other letters
MEETING = {**dict.fromkeys(("sf", "st", "sp"), "3/5"), **dict.fromkeys(("cf", "ct", "cp"), "4/5"), "e": "0"}


def rotation(entry: str) -> str:
    """(2) with a formula for its entry (3,2)."""
    return f"[[ct*cp, ct*sp, -st], [-cf*sp + sf*st*cp, cf*cp + sf*st*sp, sf*ct], [sf*sp + cf*st*cp, {entry}, cf*ct]]"


def kinematics(case: Case) -> tuple[Certificate, ...]:
    """(2) to (6) in this order, and that (2) as printed is no rotation."""
    R, angles = rotation(ROTATION_32_CORRECTED.formula), "cf sf ct st cp sp"
    turned = (
        ("R", R),
        ("w", f"({RATE}) @ {EULER_RATES}"),
        ("cross", "[[0, -w[2, 0], w[1, 0]], [w[2, 0], 0, -w[0, 0]], [-w[1, 0], w[0, 0], 0]]"),
    )
    moved = R
    for letter, angle in (("f", "phi"), ("t", "theta"), ("p", "psi")):
        moved = moved.replace(f"s{letter}", f"(S{letter} + e*C{letter}*d{angle})")
        moved = moved.replace(f"c{letter}", f"(C{letter} - e*S{letter}*d{angle})")
    moved = moved.replace("S", "s").replace("C", "c")
    small, rates = "e phi theta psi", "dphi dtheta dpsi"
    motion = (
        ("w1", "e*dphi - n*e*psi"),
        ("w2", "e*dtheta - n"),
        ("w3", "e*dpsi + n*e*phi"),
        ("v1", "e*ddphi - n*e*dpsi"),
        ("v2", "e*ddtheta"),
        ("v3", "e*ddpsi + n*e*dphi"),
        ("g1", "-e*theta"),
        ("g2", "e*phi"),
        ("g3", "1"),
    )
    newton = (
        "[[J1*v1 + (J3 - J2)*w2*w3 - 3*n**2*(J3 - J2)*g2*g3], [J2*v2 + (J1 - J3)*w3*w1 - 3*n**2*(J1 - J3)*g3*g1], "
        "[J3*v3 + (J2 - J1)*w1*w2 - 3*n**2*(J2 - J1)*g1*g2], [v1], [v2], [v3]]"
    )
    six = (
        "[[J1*ddphi - n*(J1 + J3 - J2)*dpsi + 4*n**2*(J2 - J3)*phi], [J2*ddtheta + 3*n**2*(J1 - J3)*theta], "
        "[J3*ddpsi + n*(J1 + J3 - J2)*dphi + n**2*(J2 - J1)*psi], [ddphi - n*dpsi], [ddtheta], [ddpsi + n*dphi]]"
    )
    return (
        differing(
            case,
            "eq2.printed",
            "The matrix of (2) with its entry (3,2) as printed is not orthogonal where sines are 3/5.",
            "R @ R.T",
            "eye(3)",
            definitions=[("R", rotation(ROTATION_32.formula))],
            at={name: MEETING[name] for name in angles.split()},
        ),
        identical(
            case,
            "eq2.rotation",
            "(2) with cos phi sin theta sin psi in its entry (3,2) is orthogonal.",
            f"({R}) @ ({R}).T",
            "eye(3)",
            angles,
            modulo=CIRCLES,
            at=MEETING,
        ),
        identical(
            case,
            "eq2.small",
            "The small-angle form of (2), corrected, is (2) to first order.",
            R,
            "[[1, e*psi, -e*theta], [-e*psi, 1, e*phi], [e*theta, -e*phi, 1]]",
            small,
            definitions=FIRST_ORDER,
            modulo=["e**2"],
            at=MEETING,
        ),
        identical(
            case,
            "eq3.kinematics",
            "With (3) the matrix R of (2), corrected, obeys dR/dt = -[w x] R.",
            moved,
            "R - e * cross @ R",
            f"{angles} {rates} e",
            definitions=turned,
            modulo=["e**2", *CIRCLES],
            at=MEETING,
        ),
        identical(
            case,
            "eq4.rate",
            "The display after (4) is (3) less n times the second column of (2), corrected.",
            AFTER_4,
            f"({RATE}) @ {EULER_RATES} - n * ({R})[0:3, 1:2]",
            f"{angles} {rates} n",
        ),
        identical(
            case,
            "eq5.linear",
            "(5) is the display after (4) to first order in angles and rates.",
            AFTER_4.replace(EULER_RATES, f"(e * {EULER_RATES})"),
            "[[e*dphi - n*e*psi], [e*dtheta - n], [e*dpsi + n*e*phi]]",
            f"{small} {rates} n",
            definitions=FIRST_ORDER,
            modulo=["e**2"],
            at=MEETING,
        ),
        identical(
            case,
            "eq6.linear",
            "D, G and N-bar of (6) are (1) with (5) and the torque 3 n^2 a3 x (J a3), to first order.",
            newton,
            f"e * {six}",
            f"{small} {rates} ddphi ddtheta ddpsi n J1 J2 J3",
            definitions=motion,
            modulo=["e**2"],
            at=MEETING,
        ),
    )


def factorisation(case: Case, which: str) -> Certificate:
    """Delta D or Delta G equals its product of factors for every delta."""
    deltas = {"D": "diag(u1, u1, u3, u3, u2, u2)", "G": "diag(u2, u2, u1, u3, u3, u1)"}[which]
    changed = (("I1", "J1 + u1*d1"), ("I2", "J2 + u2*d2"), ("I3", "J3 + u3*d3"))
    left = {"D": "n * (I1 + I3 - I2) * turn - D0", "G": "n**2 * diag(4*(I2 - I3), 3*(I1 - I3), I2 - I1) - G0"}[which]
    return identical(
        case,
        f"factorisation.{which.lower()}",
        f"Delta {which} = Xi_{which} Delta_{which} Gamma_{which} for every delta, Gamma_{which} corrected.",
        left,
        f"X{which} @ {deltas} @ printed('Gamma{which}')",
        "u1 u2 u3",
        definitions=(*PLANT, *FACTORS, *changed),
    )


#: where (6) and its factors are misprinted: id, sentence, two formulas that differ, quantity
MISPRINTS = (
    ("g0-parentheses", "G0(3,3) as printed, n^2 J20 - J10, is not n^2 (J20 - J10).",
     G0_33.formula, G0_33_CORRECTED.formula, "misprint.g0"),
    ("d0-third-row", "D0 as printed, with two rows, is not D(J0) of (6).",
     "n * (J1 + J3 - J2) * turn[0:2, 0:3]", "D0", "misprint.d0"),
    ("gamma-d-third-row", "The third row of Gamma_D as printed, filled with zeros, is not the one needed.",
     "[[0, 1, 0, -1, 0, 0]]", "printed('GammaD').T[2:3, 0:6]", "misprint.gamma_d"),
    ("gamma-g-rows", "Gamma_G as printed has five rows and columns; Xi_G Delta_G Gamma_G needs 6x3.",
     "[[4, 0, 0, 1, 0], [0, 0, 1, -1, 0], [0, 0, 1, -1, 0], [0, 1, -1, 0, 0], [0, 1, 0, 0, 1]].T",
     "printed('GammaG')", "misprint.gamma_g"),
)  # fmt: skip


def misprints(case: Case) -> Iterator[Certificate]:
    """What is printed is not what the definition gives."""
    for name, what, left, right, quantity in MISPRINTS:
        yield differing(case, quantity, what, left, right, id=name, definitions=PLANT)


def reduction(case: Case) -> Certificate:
    """Eliminating eta'' from (6) gives (J0 - F'F) q'' + (D0 - F'F Nbar) q' + G0 q = u + d~, for every motion."""
    damping = ", ".join(f"2 * number('modal_damping_{i}') * number('modal_frequency_{i}')" for i in (1, 2, 3, 4))
    stiffness = ", ".join(f"number('modal_frequency_{i}')**2" for i in (1, 2, 3, 4))
    return identical(
        case,
        "eq7.reduction",
        "With eta'' from its second equation (6) is (7) with d~ = F'Cm eta' + F'Lambda eta + d.",
        "J0 @ acc + D0 @ v + G0 @ q + F.T @ (-Cm @ rate - Lambda @ eta - F @ (acc + n * turn @ v))",
        "(J0 - F.T @ F) @ acc + (D0 - n * F.T @ F @ turn) @ v + G0 @ q - F.T @ (Cm @ rate + Lambda @ eta)",
        dict.fromkeys(("q", "v", "acc"), matrix(3, 1)) | dict.fromkeys(("eta", "rate"), matrix(4, 1)),
        definitions=(*PLANT, ("Cm", f"diag({damping})"), ("Lambda", f"diag({stiffness})")),
    )


def completed_square(case: Case) -> Certificate:
    """Lemma 2: (Theta/l + l Gamma)(.)'/2 - (Theta Gamma' + Gamma Theta') is half a square, here times l^2."""
    return identical(
        case,
        "lemma2.identity",
        "(T + l^2 G)(T + l^2 G)' - 2 l^2 (T G' + G T') = (T - l^2 G)(T - l^2 G)' at size 2.",
        "(T + l**2 * G) @ (T + l**2 * G).T - 2 * l**2 * (T @ G.T + G @ T.T)",
        "(T - l**2 * G) @ (T - l**2 * G).T",
        {"T": matrix(2, 2), "G": matrix(2, 2), "l": scalar()},
        id="lemma2-square",
        faith=(
            "That the identity at size 2 stands for every size.",
            "The step from the identity to Lemma 2: a square is not negative, and division by 2 l^2 > 0.",
        ),
    )


def negative_multiplier(case: Case) -> Certificate:
    """Lemma 1 without mu > 0: Y = 0, H = E = 1 and mu = -1 meet its condition, but its conclusion fails at F = 1."""
    return build.certificate(
        "feasible",
        id="lemma1-negative-mu",
        tables=case,
        statement="With Y = 0, H = E = 1, mu = -1: Y + H H'/mu + mu E'E < 0, yet Y + H F E + (H F E)' > 0 for F = 1.",
        unknowns={"Y": scalar().entry(), "f": scalar().entry()},
        fields={
            "constraints": [
                ["condition", "Y - 1 - 1 < 0"],
                ["conclusion fails", "Y + f + f >= 0"],
                ["F", "1 - f**2 >= 0"],
            ]
        },
        witness={"Y": "0", "f": "1"},
        quantities={"feasible": "lemma1.without_sign"},
        faith=("That Y - 2 is the condition of Lemma 1 and Y + 2 f its conclusion for H = E = 1, mu = -1, F = f.",),
    )
