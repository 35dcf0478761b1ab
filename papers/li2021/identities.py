"""Certificates of the paper's algebra: factorisations, the reduction (7), Lemmas 1 and 2, and misprints."""

from gainsay.proof import Certificate, build
from papers.li2021.proofs import FACTORS, PLANT, full


def factorisation(case, which: str) -> Certificate:
    """Delta D or Delta G equals its product of factors for every delta."""
    deltas = {"D": "diag(u1, u1, u3, u3, u2, u2)", "G": "diag(u2, u2, u1, u3, u3, u1)"}[which]
    changed = (("I1", "J1 + u1*d1"), ("I2", "J2 + u2*d2"), ("I3", "J3 + u3*d3"))
    left = {
        "D": "n * (I1 + I3 - I2) * turn - D0",
        "G": "n**2 * diag(4*(I2 - I3), 3*(I1 - I3), I2 - I1) - G0",
    }[which]
    return build.certificate(
        "identity",
        id=f"factorisation-{which.lower()}",
        paper=case.name,
        tables=case,
        statement=f"Delta {which} = Xi_{which} Delta_{which} Gamma_{which} for every delta, Gamma_{which} corrected.",
        definitions=(*PLANT, *FACTORS, *changed),
        unknowns={"u1": {}, "u2": {}, "u3": {}},
        fields={"left": left, "right": f"X{which} @ {deltas} @ printed('Gamma{which}')"},
        quantities={"identity": f"factorisation.{which.lower()}"},
    )


def misprint(case, name: str, what: str, left: str, right: str, quantity: str, definitions=()) -> Certificate:
    """Two formulas differ: what is printed is not what the definition gives."""
    return build.certificate(
        "different",
        id=name,
        paper=case.name,
        tables=case,
        statement=what,
        definitions=(*PLANT, *definitions),
        fields={"left": left, "right": right},
        quantities={"identity": quantity},
    )


def reduction(case) -> Certificate:
    """Eliminating eta'' from (6) gives (J0 - F'F) q'' + (D0 - F'F Nbar) q' + G0 q = u + d~, for every motion."""
    damping = ", ".join(f"2 * number('modal_damping_{i}') * number('modal_frequency_{i}')" for i in (1, 2, 3, 4))
    stiffness = ", ".join(f"number('modal_frequency_{i}')**2" for i in (1, 2, 3, 4))
    return build.certificate(
        "identity",
        id="eq7-reduction",
        paper=case.name,
        tables=case,
        statement="With eta'' from its second equation (6) is (7) with d~ = F'Cm eta' + F'Lambda eta + d.",
        definitions=(*PLANT, ("Cm", f"diag({damping})"), ("Lambda", f"diag({stiffness})")),
        unknowns=full(q=(3, 1), v=(3, 1), acc=(3, 1), eta=(4, 1), rate=(4, 1)),
        fields={
            "left": "J0 @ acc + D0 @ v + G0 @ q + F.T @ (-Cm @ rate - Lambda @ eta - F @ (acc + n * turn @ v))",
            "right": "(J0 - F.T @ F) @ acc + (D0 - n * F.T @ F @ turn) @ v + G0 @ q - F.T @ (Cm @ rate + Lambda @ eta)",
        },
        quantities={"identity": "eq7.reduction"},
    )


def completed_square(case) -> Certificate:
    """Lemma 2: (Theta/l + l Gamma)(.)'/2 - (Theta Gamma' + Gamma Theta') is half a square, here times l^2."""
    return build.certificate(
        "identity",
        id="lemma2-square",
        paper=case.name,
        tables=case,
        statement="(T + l^2 G)(T + l^2 G)' - 2 l^2 (T G' + G T') = (T - l^2 G)(T - l^2 G)' at size 2.",
        unknowns={**full(T=(2, 2), G=(2, 2)), "l": {}},
        fields={
            "left": "(T + l**2 * G) @ (T + l**2 * G).T - 2 * l**2 * (T @ G.T + G @ T.T)",
            "right": "(T - l**2 * G) @ (T - l**2 * G).T",
        },
        quantities={"identity": "lemma2.identity"},
        faith=(
            "That the identity at size 2 stands for every size.",
            "The step from the identity to Lemma 2: a square is not negative, and division by 2 l^2 > 0.",
        ),
    )


def negative_multiplier(case) -> Certificate:
    """Lemma 1 without mu > 0: Y = 0, H = E = 1 and mu = -1 meet its condition, but its conclusion fails at F = 1."""
    return build.certificate(
        "feasible",
        id="lemma1-negative-mu",
        paper=case.name,
        tables=case,
        statement="With Y = 0, H = E = 1, mu = -1: Y + H H'/mu + mu E'E < 0, yet Y + H F E + (H F E)' > 0 for F = 1.",
        unknowns={"Y": {}, "f": {}},
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
