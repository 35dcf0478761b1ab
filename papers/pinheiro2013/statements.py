"""The inequalities (21) of pinheiro2013, and its plants as (8), (18) and (19) state them: formulas over the tables."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from gainsay.lmi import Scale
from gainsay.proof.scope import MappingTables
from gainsay.statements import Stated, Statement, matrix, symmetric
from gainsay.systems.uncertain_plant import UncertainPlant
from gainsay.tables import Case
from papers.pinheiro2013.plant import GeneralizedPlant

GAMMAS = {"gamma_0.2": "hinf", "gamma_2": "mixed", "gamma_100": "h2"}


def inputs(reconstruction: str) -> dict[str, str]:
    """Moments of inertia, orbital rate, share of uncertainty and weights of a reconstruction."""
    moments = {f"I{axis}": f"number('inertia_{reconstruction}_{axis}')" for axis in "xyz"}
    return {
        **moments,
        "n": "number('orbital_rate')",
        "share": "number('inertia_change')",
        "Q1": "number('angle_weight')",
        "Q2": "number('rate_weight')",
        "R": "number('control_weight')",
    }


def pitch(reconstruction: str) -> dict[str, str]:
    """Plant (18) with torques entering by +1/Iy as in (12)."""
    return {
        **inputs(reconstruction),
        "A": "[[0, 1], [-3*n**2*(Ix - Iz)/Iy, 0]]",
        "channels": "[[-share, -3*n**2*share*Ix/Iy, -3*n**2*share*Iz/Iy, 1/Iy]]",
        "B1": "col(zeros(1, 4), channels)",
        "B2": "[[0], [1/Iy]]",
        "C1": "[[-3*n**2*(Ix - Iz)/Iy, 0], [1, 0], [-1, 0]]",
        "D11": "col(channels, zeros(2, 4))",
        "D12": "[[1/Iy], [0], [0]]",
        "C2": "[[Q1, 0], [0, Q2], [0, 0]]",
        "D22": "[[0], [0], [R]]",
    }


def roll_yaw(reconstruction: str) -> dict[str, str]:
    """Counterpart of (18) for roll and yaw: (8) with (11), every product of an uncertain moment pulled out."""
    return {
        **inputs(reconstruction),
        "c": "n*(Ix - Iy + Iz)",
        "roll": "[[-4*n**2*(Iy - Iz)/Ix, 0, 0, c/Ix]]",
        "yaw": "[[0, -n**2*(Iy - Ix)/Iz, -c/Iz, 0]]",
        "A": "col([[0, 0, 1, 0], [0, 0, 0, 1]], roll, yaw)",
        "roll_channels": "[[-share, -4*n**2*share*Iy/Ix, -4*n**2*share*Iz/Ix,"
        " -n*share, -n*share*Iy/Ix, -n*share*Iz/Ix]]",
        "yaw_channels": "[[-share, -n**2*share*Iy/Iz, -n**2*share*Ix/Iz, -n*share*Ix/Iz, -n*share*Iy/Iz, -n*share]]",
        "rows": "[[roll_channels, zeros(1, 6), 1/Ix, 0], [zeros(1, 6), yaw_channels, 0, 1/Iz]]",
        "B1": "col(zeros(2, 14), rows)",
        "torques": "diag(1/Ix, 1/Iz)",
        "B2": "col(zeros(2, 2), torques)",
        "C1": "col(roll, [[1, 0, 0, 0], [-1, 0, 0, 0], [0, 0, 0, -1], [0, 0, 0, 1], [0, 0, 0, -1]],"
        " yaw, [[0, 1, 0, 0], [0, -1, 0, 0], [0, 0, 1, 0], [0, 0, -1, 0], [0, 0, 1, 0]])",
        "D11": "col(rows[0, 0:14], zeros(5, 14), rows[1, 0:14], zeros(5, 14))",
        "D12": "col(torques[0, 0:2], zeros(5, 2), torques[1, 0:2], zeros(5, 2))",
        "C2": "col(diag(Q1, Q1, Q2, Q2), zeros(2, 4))",
        "D22": "col(zeros(4, 2), R*eye(2))",
    }


PLANTS = {"pitch": pitch, "roll_yaw": roll_yaw}


def closed(reconstruction: str, group: str, gain: str) -> dict[str, str]:
    """Plant of a group of axes closed by u = -K x, K a formula."""
    return {
        **PLANTS[group](reconstruction),
        "K": gain,
        "closed_A": "A - B2@K",
        "closed_C1": "C1 - D12@K",
        "closed_C2": "C2 - D22@K",
    }


#: the closed loop from w to z_inf, over the definitions of `closed`
TO_Z_INF = {"A": "closed_A", "B": "B1", "C": "closed_C1", "D": "D11"}


#: state matrix of (8) closed by u = -K x, by moments of inertia x, y, z and inverses of those u, v, w over the nominal
#: ones; I/(own I) stays: n (Ix - Iy + Iz) has Ix/Ix = 1 in roll and Iz/Iz = 1 in yaw
VARIED = {
    "pitch": {"varied": "[[0, 1], [-3*n**2*(Ix*x - Iz*z)*v/Iy, 0]] - [[0], [v/Iy]]@K"},
    "roll_yaw": {
        "roll": "[[-4*n**2*(Iy*y - Iz*z)*u/Ix, 0, 0, n*(1 + (Iz*z - Iy*y)*u/Ix)]]",
        "yaw": "[[0, -n**2*(Iy*y - Ix*x)*w/Iz, -n*(1 + (Ix*x - Iy*y)*w/Iz), 0]]",
        "varied": "col([[0, 0, 1, 0], [0, 0, 0, 1]], roll, yaw) - col(zeros(2, 2), diag(u/Ix, w/Iz))@K",
    },
}


def uncertain(case: Case, design: str, group: str, share: str) -> UncertainPlant:
    """(8) closed by a design, with every moment and, apart from it, its inverse within a share of the nominal one.

    Taken as independent of each other they span a box that contains every pair (I, 1/I).
    """
    moment, inverse = (f"1 - {share}", f"1 + {share}"), (f"1/(1 + {share})", f"1/(1 - {share})")
    names = {"pitch": "xzv", "roll_yaw": "xyzuw"}[group]
    ranges = {name: inverse if name in "uvw" else moment for name in names}
    gain = {"K": f"design('{design}', 'K_{group}')"}
    return UncertainPlant(case, {**inputs(design[0]), **gain, **VARIED[group]}, ranges)


#: matrices of a generalized plant that is given in doubles
GIVEN = {name: f"printed('{name}')" for name in ("A", "B1", "B2", "C1", "D11", "D12", "C2", "D22")}


def sizes(plant: GeneralizedPlant) -> dict[str, int]:
    """Numbers of states, inputs, disturbances, errors and costs."""
    outputs = {"errors": plant.C1.shape[0], "costs": plant.C2.shape[0]}
    return {"states": plant.A.shape[0], "inputs": plant.B2.shape[1], "disturbances": plant.B1.shape[1], **outputs}


def equation_21(size: Mapping[str, int], where: Mapping[str, str], gamma_squared: str) -> Statement:
    """First LMI of (21) as printed."""
    return Statement(
        "(21)",
        "Section 3",
        ("state", "disturbance", "error"),
        {
            ("state", "state"): "sym(A@X - B2@Y)",
            ("state", "disturbance"): "B1",
            ("state", "error"): "(C1@X - D12@Y).T",
            ("disturbance", "disturbance"): f"-eye({size['disturbances']})",
            ("disturbance", "error"): "D11.T",
            ("error", "error"): f"gamma2*eye({size['errors']})",
        },
        unknowns={"X": symmetric(size["states"]), "Y": matrix(size["inputs"], size["states"])},
        where={**where, "gamma2": gamma_squared},
        notation={"gamma2": r"\gamma^{2}"},
    )


def corrected_21(size: Mapping[str, int], where: Mapping[str, str], gamma_squared: str) -> Statement:
    """First LMI of (21) with the sign that the bounded real lemma gives block (3,3); erratum `eq21-gamma-sign`."""
    error = f"-gamma2*eye({size['errors']})"
    return equation_21(size, where, gamma_squared).corrected({("error", "error"): error})


#: what the errata follow from; the sizes are those of pitch
EDITIONS = (corrected_21({"states": 2, "inputs": 1, "disturbances": 4, "errors": 3}, {}, "number('gamma_mixed')**2"),)


def second_21(size: Mapping[str, int], where: Mapping[str, str]) -> Statement:
    """Second LMI of (21)."""
    return Statement(
        "(21), second",
        "Section 3",
        ("cost", "state"),
        {("cost", "cost"): "Q", ("cost", "state"): "C2@X - D22@Y", ("state", "state"): "X"},
        unknowns={
            "X": symmetric(size["states"]),
            "Y": matrix(size["inputs"], size["states"]),
            "Q": symmetric(size["costs"]),
        },
        where=where,
    )


def mixed_problem(case: Any, size: Mapping[str, int], where: Mapping[str, str], gamma_squared: str) -> Stated:
    """The mixed problem: least trace of Q under (21) with the corrected sign."""
    held = [corrected_21(size, where, gamma_squared) < 0, second_21(size, where) > 0]
    return Stated(case, held, minimise="trace(Q)", label="(21)")


def given_problem(plant: GeneralizedPlant, gamma: float, typical: np.ndarray, margin: float) -> Stated:
    """The mixed problem of a plant in doubles; `typical` is a typical X, for scaling."""
    texts = {name: [[repr(float(x)) for x in row] for row in getattr(plant, name)] for name in GIVEN}
    stated = mixed_problem(MappingTables(printed=texts), sizes(plant), GIVEN, repr(float(gamma) ** 2))
    return stated.changed(scale=Scale(X=np.sqrt(np.diag(typical))), label=f"(21) at gamma = {gamma:.6g}", margin=margin)


def paper_problem(case: Case, plant: GeneralizedPlant, name: str, group: str, gamma_squared: str) -> Stated:
    """The mixed problem of a reconstruction over the tables; the plant gives the sizes."""
    return mixed_problem(case, sizes(plant), PLANTS[group](name), gamma_squared)
