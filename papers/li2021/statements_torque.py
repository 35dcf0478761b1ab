"""The condition that bounds the torque: no inequality of the paper, but one of our own, stated like the others.

With xi' = A xi + H w, z = Cz xi + Dw w and w = Delta z, |Delta| <= 1, the form xi' P xi falls where the first
inequality holds for multipliers D >= 0 of the channels, whatever Delta and its speed; the second puts the modulus of
k xi below its root. So the torque from x0 stays below the root of x0' P x0.
"""

from collections.abc import Iterable, Mapping

import numpy as np

from gainsay.proof.scope import MappingTables
from gainsay.statements import Stated, Statement, positive, read_constraint, symmetric

#: matrices of the linear fractional form, the output that is bounded, and the start
DATA = ("A", "H", "Cz", "Dw", "k", "x0")


def falling(states: int, of_channel: Iterable[int]) -> Statement:
    """Xi' P xi falls.

    Parameters
    ----------
    states : int
    of_channel : iterable of int
        Index of the multiplier that each channel uses: d0, d1, ...
    """
    names = [f"d{i}" for i in of_channel]
    return Statement(
        "torque",
        "ours",
        ("state", "channel"),
        {
            ("state", "state"): "sym(P @ A) + Cz.T @ D @ Cz",
            ("state", "channel"): "P @ H + Cz.T @ D @ Dw",
            ("channel", "channel"): "Dw.T @ D @ Dw - D",
        },
        unknowns={"P": symmetric(states), **dict.fromkeys(names, positive())},
        where={**{name: f"printed('{name}')" for name in DATA}, "D": f"diag({', '.join(names)})"},
    )


def torque_within(data: Mapping[str, np.ndarray], of_channel: Iterable[int], square: str) -> Stated:
    """A bound on the square of the torque, for a linear fractional form in doubles.

    Parameters
    ----------
    data : mapping of str to ndarray
        `DATA`: A (n, n), H (n, q), Cz (q, n), Dw (q, q), k (m, n) and x0 (n, 1).
    of_channel : iterable of int, length q
        As for `falling`.
    square : str
        The bound, a formula of numbers.
    """
    texts = {name: [[repr(float(x)) for x in row] for row in data[name]] for name in DATA}
    falls = falling(len(data["A"]), of_channel)
    held = [
        falls < 0,
        read_constraint("P > k.T @ k", "P > k'k"),
        read_constraint(f"x0.T @ P @ x0 < {square}", "start"),
    ]
    return Stated(MappingTables(printed=texts), held, None, falls.unknowns, falls.definitions(None), label="torque")
