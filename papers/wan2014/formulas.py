"""The paper's matrices as formulas over its tables, in the language of certificates; tests hold them against `lmis`."""

from gainsay.tables import Case

SYMMETRIC_6 = {"shape": [6, 6], "structure": "symmetric"}
GAIN = {"shape": [3, 6], "structure": "full"}

#: block rows 1 to 7 of (14) as printed, over A, B, Ac, E1, E2, X, Y, eps, R, Q
EQUATION_14 = """[
 [sym(A@X - B@Y) + eps*E1@E1.T, B@Y + eps*E1@E1.T, X@E2.T, zeros(6,6), Y.T, -Y.T, X],
 [..., sym(Ac@X) + eps*E1@E1.T, zeros(6,6), zeros(6,6), -Y.T, Y.T, zeros(6,6)],
 [..., ..., -eps*eye(6), zeros(6,6), zeros(6,3), zeros(6,3), zeros(6,6)],
 [..., ..., ..., -eps*eye(6), zeros(6,3), zeros(6,3), zeros(6,6)],
 [..., ..., ..., ..., -Rinverse, zeros(3,3), zeros(3,6)],
 [..., ..., ..., ..., ..., -Rinverse, zeros(3,6)],
 [..., ..., ..., ..., ..., ..., -Qinverse]]"""
#: (14) with one input column [Y'; -Y'], as (24) gives it
EQUATION_14_CORRECTED = """[
 [sym(A@X - B@Y) + eps*E1@E1.T, B@Y + eps*E1@E1.T, X@E2.T, zeros(6,6), Y.T, X],
 [..., sym(Ac@X) + eps*E1@E1.T, zeros(6,6), zeros(6,6), -Y.T, zeros(6,6)],
 [..., ..., -eps*eye(6), zeros(6,6), zeros(6,3), zeros(6,6)],
 [..., ..., ..., -eps*eye(6), zeros(6,3), zeros(6,6)],
 [..., ..., ..., ..., -Rinverse, zeros(3,6)],
 [..., ..., ..., ..., ..., -Qinverse]]"""
#: block rows 1, 3, 5, 7 of (14) times rho, after X <- rho X, Y <- rho Y, eps <- rho eps
SUBPROBLEM_14 = """[
 [sym(A@X - B@Y) + eps*E1@E1.T, X@E2.T, Y.T, X],
 [..., -eps*eye(6), zeros(6,3), zeros(6,6)],
 [..., ..., -rho*Rinverse, zeros(3,6)],
 [..., ..., ..., -rho*Qinverse]]"""


def model(case: Case) -> dict[str, str]:
    """Return the design model (1)-(3), (42) and the observer (9) as formulas over the tables, in order."""
    powers = case.printed("E2_power").rows
    entries = [[f"c[{i},{j}]*n**{p.value}" for j, p in enumerate(row)] for i, row in enumerate(powers)]
    return {
        "n": "number('mean_motion')",
        "A": "[[zeros(3,3), eye(3)], [diag(3*n**2, 0, -n**2), [[0, 2*n, 0], [-2*n, 0, 0], [0, 0, 0]]]]",
        "B": "[[zeros(3,3)], [eye(3)/number('mass')]]",
        "E1": "number('eccentricity')*printed('E1_over_e')",
        "c": "printed('E2_coefficient')",
        "E2": "[" + ", ".join("[" + ", ".join(row) + "]" for row in entries) + "]",
        "Ac": "A - printed('L')@printed('C')",
        "Rinverse": "inverse(printed('R'))",
        "Qinverse": "inverse(printed('Q'))",
        "x0": "printed('x0')",
    }


def closed_loop(case: Case, gain: str) -> dict[str, str]:
    """Return the closed loop in [x; e] for the formula of a gain, as definitions for `quadratic_bound`."""
    return {
        **model(case),
        "K": gain,
        "Acl": "[[A - B@K, B@K], [zeros(6,6), Ac]]",
        "H": "[[E1[0:6,0:5]], [E1[0:6,0:5]]]",
        "Cz": "[[E2[0:5,0:6], zeros(5,6)]]",
        "k": "[[-K, K]]",
        "weight": "diag(printed('Q'), zeros(6,6)) + k.T@printed('R')@k",
        "xi0": "[[x0], [zeros(3,1)], [x0[3:6,0]]]",
    }


#: fields of `quadratic_bound` for that closed loop
SYSTEM = {"A": "Acl", "x0": "xi0", "H": "H", "Cz": "Cz", "blocks": [["repeated", 1]] * 5}
