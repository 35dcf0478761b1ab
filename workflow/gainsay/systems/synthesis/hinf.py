"""H-infinity synthesis by linear matrix inequalities: state feedback and full-order output feedback, in both times.

With P the Lyapunov matrix of the closed loop, A P, B, C P and D are affine in the unknowns after a change of variables,
and the bounded real lemma is a linear matrix inequality. A controller is found by rounded numbers; what is reported of
the loop that it closes is enclosed from the gains as they stand. That none does better rests on checked multipliers.

References
----------
C. Scherer, P. Gahinet, M. Chilali, Multiobjective output-feedback control via LMI optimization, IEEE Trans. Automatic
Control 42 (1997) 896-911.
P. Gahinet, P. Apkarian, A linear matrix inequality approach to H-infinity control, Int. J. Robust and Nonlinear Control
4 (1994) 421-448: the lemma in discrete time.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from gainsay.errors import ComputationError, InputError
from gainsay.lmi import (
    Affine,
    BlockMatrix,
    Definite,
    Infimum,
    Program,
    Solved,
    affine,
    infimum,
    matrix,
    scalar,
    solve,
    sym,
    symmetric,
)
from gainsay.systems.norms import hinf_enclosure, require_sample
from gainsay.systems.statespace import StateSpace
from gainsay.systems.synthesis.plant import StandardPlant, Synthesis

_ROOMS = (1e-3, 1e-2, 1e-1)  # above the least gamma: at it the solution is on the boundary and the gains run away


@dataclass(frozen=True)
class _Loop:
    """Closed loop from w to z with its Lyapunov matrix P, affine in the unknowns."""

    P: Affine
    AP: Affine
    B: Affine
    CP: Affine
    D: Affine


def hinf_state_feedback(plant: StandardPlant, *, sample: float | None = None) -> Synthesis:
    """State feedback u = K x with about the least H-infinity norm from w to z.

    Parameters
    ----------
    plant : StandardPlant
        Its outputs y play no part.
    sample : float, optional
        Sampling time, s, of a plant in discrete time; continuous time where None.

    Returns
    -------
    Synthesis
        The norm is that of the best point found, raised by at most 1e-3, 1e-2 or 1e-1, the first that gives gains which
        keep it. How far it is from the best is what lies between `least` and the norm: little on well-scaled plants,
        much where the solver's enclosure is wide, as on plants with rates of 1e3 beside costs of one.

    Raises
    ------
    InputError
        If the sampling time is not positive.
    ComputationError
        If the least gamma is not enclosed, or no gain found keeps its promise.

    Examples
    --------
    >>> plant = StandardPlant([[-1.0]], [[1.0]], [[1.0]], [[1.0], [0.0]], [[1.0]], D12=[[0.0], [1.0]])
    >>> found = hinf_state_feedback(plant)  # the least norm is 1/sqrt(2)
    >>> found.least <= 2**-0.5 <= found.norm.upper
    True
    """
    A, B1, B2, C1, D11, D12 = plant.A, plant.B1, plant.B2, plant.C1, plant.D11, plant.D12
    n, u = B2.shape
    X, Y = symmetric("X", n), matrix("Y", u, n)
    loop = _Loop(P=X, AP=A @ X + B2 @ Y, B=affine(B1), CP=C1 @ X + D12 @ Y, D=affine(D11))

    def close(values: dict) -> tuple[np.ndarray, StateSpace]:
        K = np.linalg.solve(values["X"], values["Y"].T).T
        return K, plant.with_gain(K)

    return _near_the_least(loop, close, sample)


def hinf_output_feedback(plant: StandardPlant, *, sample: float | None = None) -> Synthesis:
    """Controller from y to u of the plant's order with about the least H-infinity norm from w to z.

    Parameters
    ----------
    plant : StandardPlant
    sample : float, optional
        Sampling time, s, of a plant and a controller in discrete time; continuous time where None.

    Returns
    -------
    Synthesis
        As `hinf_state_feedback`; `least` bounds controllers of every order.

    Raises
    ------
    InputError
        If the sampling time is not positive.
    ComputationError
        If the least gamma is not enclosed, or no controller found keeps its promise.
    """
    A, B1, B2, C1, C2 = plant.A, plant.B1, plant.B2, plant.C1, plant.C2
    D11, D12, D21 = plant.D11, plant.D12, plant.D21
    (n, u), y = B2.shape, len(C2)
    X, Y = symmetric("X", n), symmetric("Y", n)
    Ah, Bh, Ch, Dh = matrix("Ah", n, n), matrix("Bh", n, y), matrix("Ch", u, n), matrix("Dh", u, y)
    loop = _Loop(
        P=_block([[X, np.eye(n)], [np.eye(n), Y]]),
        AP=_block([[A @ X + B2 @ Ch, A + B2 @ Dh @ C2], [Ah, Y @ A + Bh @ C2]]),
        B=_block([[B1 + B2 @ Dh @ D21], [Y @ B1 + Bh @ D21]]),
        CP=_block([[C1 @ X + D12 @ Ch, C1 + D12 @ Dh @ C2]]),
        D=D11 + D12 @ Dh @ D21,
    )

    def close(values: dict) -> tuple[StateSpace, StateSpace]:
        X, Y, Dk = values["X"], values["Y"], values["Dh"]
        # M N' = I - X Y; any factors do, these are of one size
        left, sizes, right = np.linalg.svd(np.eye(n) - X @ Y)
        M, N = left * np.sqrt(sizes), right.T * np.sqrt(sizes)
        Ck = np.linalg.solve(M, (values["Ch"] - Dk @ C2 @ X).T).T
        Bk = np.linalg.solve(N, values["Bh"] - Y @ B2 @ Dk)
        inner = values["Ah"] - N @ Bk @ C2 @ X - Y @ B2 @ Ck @ M.T - Y @ (A + B2 @ Dk @ C2) @ X
        Ak = np.linalg.solve(M, np.linalg.solve(N, inner).T).T
        K = StateSpace(Ak, Bk, Ck, Dk)
        return K, plant.with_controller(K)

    return _near_the_least(loop, close, sample)


def _bounded_real_lemma(loop: _Loop, gamma: Any, discrete: bool) -> list[Definite]:
    """The loop is stable and its norm below gamma exactly if these hold for some unknowns."""
    F = BlockMatrix("bounded real lemma", *(("next", "x", "w", "z") if discrete else ("x", "w", "z")))
    w, z = np.eye(loop.D.shape[1]), np.eye(loop.D.shape[0])
    F["x", "z"], F["w", "z"] = loop.CP.T, loop.D.T
    if discrete:
        F["next", "next"], F["next", "x"], F["next", "w"], F["x", "x"] = loop.P, loop.AP, loop.B, loop.P
        F["w", "w"], F["z", "z"] = gamma * w, gamma * z
        return [F > 0]
    F["x", "x"], F["x", "w"] = sym(loop.AP), loop.B
    F["w", "w"], F["z", "z"] = -gamma * w, -gamma * z
    return [F < 0, loop.P > 0]


def _block(rows: Sequence[Sequence[Any]]) -> Affine:
    """Block matrix of affine expressions, none of them left out."""
    cells = [[affine(cell) for cell in row] for row in rows]
    heights, widths = [row[0].shape[0] for row in cells], [cell.shape[1] for cell in cells[0]]
    below, right = np.cumsum(heights)[:-1], np.cumsum(widths)[:-1]
    down, across = np.split(np.eye(sum(heights)), below, axis=1), np.split(np.eye(sum(widths)), right, axis=1)
    places = [(i, j) for i in range(len(down)) for j in range(len(across))]
    return sum((down[i] @ cells[i][j] @ across[j].T for i, j in places), affine(np.zeros((sum(heights), sum(widths)))))


def _near_the_least(
    loop: _Loop, close: Callable[[dict], tuple[np.ndarray | StateSpace, StateSpace]], sample: float | None
) -> Synthesis:
    if sample is not None:
        require_sample(sample)
    gamma, discrete, label = scalar("gamma"), sample is not None, "H-infinity synthesis"
    optimum = infimum(Program(minimise=gamma, subject_to=_bounded_real_lemma(loop, gamma, discrete), label=label))
    if not isinstance(optimum, Infimum):
        raise ComputationError(label, f"least gamma: {type(optimum).__name__.lower()}", optimum.attempts)
    attempts = []
    for room in _ROOMS:
        level = optimum.upper + room * max(abs(optimum.upper), 1e-12)
        point = solve(Program(subject_to=_bounded_real_lemma(loop, level, discrete), label=label))
        if not isinstance(point, Solved):
            attempts.append({"gamma": level, "outcome": type(point).__name__})
            continue
        try:
            controller, closed = close(point.values)
            norm = hinf_enclosure(closed.A, closed.B, closed.C, closed.D, sample=sample)
        except (InputError, ComputationError, np.linalg.LinAlgError) as error:
            attempts.append({"gamma": level, "error": str(error)})
            continue
        if norm.upper <= level:
            return Synthesis(controller, norm, max(optimum.lower, 0.0))
        attempts.append({"gamma": level, "norm": norm.upper})
    raise ComputationError(label, "no controller keeps the norm of the inequality", attempts)
