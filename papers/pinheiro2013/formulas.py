"""Definitions of pinheiro2013's plants for certificates: formulas over the tables, as (8), (18) and (19) state them."""

from collections.abc import Iterable
from itertools import product

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


def vertices(group: str) -> list[str]:
    """Closed loop at the vertices of the inertia uncertainty, of which it is a convex combination everywhere.

    Each axis' row of (8) is affine in 1/I of its own moment (u, v) and, apart from it, in each of the moments it
    multiplies; taken as independent of each other they span a box that contains every pair (I, 1/I).
    """
    ends = ("(1 - share)", "(1 + share)")
    found = []
    if group == "pitch":
        for own, x, z in product(ends, repeat=3):
            found.append(f"[[0, 1], [-3*n**2*(Ix*{x} - Iz*{z})/(Iy*{own}), 0]] - [[0], [1/(Iy*{own})]]@K")
        return found
    for own_x, own_z, x, y, z in product(ends, repeat=5):
        # I/(own I) stays: its factor c = n (Ix - Iy + Iz) has Ix/Ix = 1 in roll and Iz/Iz = 1 in yaw.
        roll = f"[[-4*n**2*(Iy*{y} - Iz*{z})/(Ix*{own_x}), 0, 0, n*(1 + (Iz*{z} - Iy*{y})/(Ix*{own_x}))]]"
        yaw = f"[[0, -n**2*(Iy*{y} - Ix*{x})/(Iz*{own_z}), -n*(1 + (Ix*{x} - Iy*{y})/(Iz*{own_z})), 0]]"
        torque = f"diag(1/(Ix*{own_x}), 1/(Iz*{own_z}))"
        found.append(f"col([[0, 0, 1, 0], [0, 0, 0, 1]], {roll}, {yaw}) - col(zeros(2, 2), {torque})@K")
    return found


def evaluated(definitions: dict[str, str], extra: Iterable[tuple[str, str]], case) -> dict:
    """Evaluate definitions and further formulas in doubles, to hold them against the plant that was computed with."""
    import numpy as np

    from gainsay.exact.matrix import Matrix
    from gainsay.proof.checker import CaseTables
    from gainsay.proof.formulas import evaluate
    from gainsay.proof.scope import Reader

    reader, names, found = Reader(CaseTables(case), "definitions"), {}, {}
    for name, text in (*definitions.items(), *extra):
        value: Matrix = evaluate(text, names, reader)
        names[name] = value
        found[name] = np.array([[float(x) for x in row] for row in value.to_ball().rows()])
    return found
