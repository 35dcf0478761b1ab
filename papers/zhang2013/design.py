"""Programs of Theorem 2 of zhang2013, and the search for a design that suits the flexible plant."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
from scipy.optimize import brentq

from gainsay.errors import ComputationError
from gainsay.lmi import (
    Affine,
    BlockMatrix,
    Infeasible,
    Program,
    scalar,
    solve,
    within,
)
from gainsay.systems.delay_spectrum import spectral_abscissa
from papers.zhang2013.plant import Spacecraft
from papers.zhang2013.theorem1 import PARTS
from papers.zhang2013.theorem2 import EDITIONS, FREE, SYMMETRIC, Setting, Unknowns, corrected

Edition = Callable[..., BlockMatrix]
NAMES = (*SYMMETRIC, *FREE)
ENTRY_BOUND = 1e4
"""Bound on the modulus of every entry of every unknown where a margin is maximised."""


def gains_of(values: dict) -> tuple[np.ndarray, np.ndarray]:
    """K = M X^-1 and L = P22^-T N of (24)."""
    return np.linalg.solve(values["X"].T, values["M"].T).T, np.linalg.solve(values["P22"].T, values["N"])


def without_block_26(s: Setting, v: Unknowns, part: str) -> BlockMatrix:
    """Corrected (23) with block (2,6) alone left out, as the paper leaves it out."""
    F = corrected(s, v, part)
    F["e", "e_d"] = np.zeros((1, 1))
    return F


def inequalities(s: Setting, v: Unknowns, edition: Edition, level: Affine | float) -> list:
    """Both LMIs <= -level I and every P, Q, R >= level I, in the block coordinates of (23)."""
    held = [edition(s, v, part) < -(level * np.eye(15)) for part in PARTS]
    return held + [(x > level * np.eye(x.shape[0])).named(f"{x.name} > 0") for x in v.signed]


def entries(v: Unknowns | SimpleNamespace, bound: float = ENTRY_BOUND, names: Iterable[str] = NAMES) -> list:
    """Every entry of the unknowns of these names at most `bound` in modulus."""
    named = {name: getattr(v, name) for name in names}
    return [within(x, -bound * np.ones(x.shape), bound * np.ones(x.shape), name) for name, x in named.items()]


Gains = tuple[np.ndarray, np.ndarray]


def unknowns(gains: Gains | None = None) -> Unknowns | SimpleNamespace:
    """The unknowns of (23); for given gains K, L with M = K X and N = P22' L, as (24) has it."""
    v = Unknowns()
    if gains is None:
        return v
    K, L = (np.asarray(gain, dtype=float) for gain in gains)
    free = {name: getattr(v, name) for name in NAMES}
    return SimpleNamespace(**(free | {"M": K @ v.X, "N": v.P22.T @ L}), signed=v.signed)


def margin_program(s: Setting, edition: str) -> Program:
    """Largest t <= 1 with `inequalities` at level t and bounded entries; the objective is -t."""
    v, t = Unknowns(), scalar("t")
    held = inequalities(s, v, EDITIONS[edition], t)
    cap = within(t, [[-ENTRY_BOUND]], [[1.0]], "t")
    return Program(minimise=-t, subject_to=[*held, *entries(v), cap], label=f"margin of (23), {edition}")


def column(x: Affine) -> Affine:
    """Entries of an expression as one column, row by row; off-diagonal entries of symmetric unknowns stand twice."""
    rows, columns = x.shape
    terms = {v: c.reshape(rows * columns, 1, -1) for v, c in x.terms.items()}
    return Affine(x.constant.reshape(-1, 1), terms)


def least_squares_program(s: Setting, gains: Gains | None = None, level: float = 1e-3) -> Program:
    """Least sum of squared entries of all unknowns of the corrected (23), `inequalities` at a level."""
    v, total = unknowns(gains), scalar("total")
    norm = BlockMatrix("sum of squares", "total", *NAMES)
    norm["total", "total"] = total
    for name in NAMES:
        x = getattr(v, name)
        norm["total", name] = column(x).T
        norm[name, name] = np.eye(x.shape[0] * x.shape[1])
    held = inequalities(s, v, corrected, level)
    return Program(minimise=total, subject_to=[*held, norm > 0], label="(23) least squares")


def fast_program(s: Setting, gains: Gains | None = None, level: float = 1e-4, bound: float = 100.0) -> Program:
    """Least gamma^2 of the corrected (23), `inequalities` at a level and entries within a bound."""
    v, gamma_squared = unknowns(gains), scalar("gamma2")

    def edition(s: Setting, v: Unknowns, part: str) -> BlockMatrix:
        F = corrected(s, v, part)
        for row in ("w1", "w2'"):
            F[row, row] = -(gamma_squared * np.eye(1))
        return F

    return Program(
        minimise=gamma_squared,
        subject_to=[*inequalities(s, v, edition, level), *entries(v, bound)],
        label="(23) least gamma",
    )


def unsound_program(s: Setting, edition: Edition, push: float = 1.0) -> Program:
    """The LMIs with N B <= -push: block (4,4) makes P22 > 0, so that L B < 0 and the observer is unstable."""
    v = Unknowns()
    wrong = within(v.N @ s.B, [[-ENTRY_BOUND]], [[-push]], "N B")
    return Program(subject_to=[*inequalities(s, v, edition, 0.0), *entries(v), *wrong], label="(23), unstable observer")


def acceptance_program(s: Setting, K: np.ndarray, L: np.ndarray, edition: Edition) -> Program:
    """Largest margin of the LMIs for given gains: M = K X and N = P22' L."""
    v, t = unknowns((K, L)), scalar("t")
    size = entries(v, names=[name for name in NAMES if name not in ("M", "N")])
    cap = within(t, [[-ENTRY_BOUND]], [[1.0]], "t")
    return Program(minimise=-t, subject_to=[*inequalities(s, v, edition, t), *size, cap], label="(23) for given gains")


@dataclass(frozen=True)
class Standing:
    """How a pair of gains stands on the flexible plant.

    Attributes
    ----------
    margin_paper, margin_all : float
        Exact delay margins in modes "paper" and "all", s.
    abscissa : float
        Largest spectral abscissa over both modes and constant delays 0 and d_M, 1/s.
    """

    margin_paper: float
    margin_all: float
    abscissa: float


def standing(craft: Spacecraft, K: np.ndarray, L: np.ndarray, d_M: float) -> Standing:
    """Delay margins and slowest decay of a pair of gains on the flexible plant."""
    loops = {mode: craft.flexible_loop(K, L, mode) for mode in ("paper", "all")}
    margins = {mode: loop.quasi_polynomial.margin().delay for mode, loop in loops.items()}
    worst = max(spectral_abscissa(loop, delay) for loop in loops.values() for delay in (0.0, d_M))
    return Standing(margins["paper"], margins["all"], worst)


def repaired_gains(craft: Spacecraft, K: np.ndarray, L: np.ndarray, d_M: float) -> tuple[np.ndarray, np.ndarray]:
    """More damping at the same stiffness, without giving up delay margin or decay on the flexible plant.

    K1 stays, so that the first torque does not grow. For every K2 the observer is made just fast enough for the delay
    margin of mode "all" to stay; the strongest damping K2 is taken for which the slowest root does not slow down.

    Parameters
    ----------
    K, L : array_like, shape (1, 2)
        Gains to be improved.
    d_M : float
        s.

    Returns
    -------
    K, L : ndarray, shape (1, 2)
        Rounded to four decimals, the printed number of digits.
    """
    K, L = np.asarray(K, dtype=float), np.asarray(L, dtype=float)
    before = standing(craft, K, L, d_M)

    def candidate(damping: float) -> tuple[np.ndarray, np.ndarray]:
        def excess(l2: float) -> float:
            loop = craft.flexible_loop([[K[0, 0], damping]], [[0.0, l2]], "all")
            return loop.quasi_polynomial.margin().delay - 1.001 * before.margin_all

        l2 = brentq(excess, 0.9 * L[0, 1], 3 * L[0, 1], xtol=1e-6)
        return np.array([[K[0, 0], round(damping, 4)]]), np.array([[0.0, round(float(l2), 4)]])

    def keeps(damping: float) -> bool:
        return standing(craft, *candidate(damping), d_M).abscissa <= 1.001 * before.abscissa

    low, high = 1.2 * K[0, 1], 4 * K[0, 1]  # K2 is negative: more damping is further down
    if not keeps(low) or keeps(high):
        raise ComputationError("repaired design", "the search interval of K2 does not bracket the wanted damping")
    for _ in range(20):
        middle = (low + high) / 2
        low, high = (middle, high) if keeps(middle) else (low, middle)
    return candidate(low)


def farkas_multipliers(program: Program) -> dict[str, np.ndarray]:
    """Multipliers under which the constraints of an infeasible program sum to a constant that is not positive.

    Raises
    ------
    ComputationError
        If no such multipliers are found; says nothing about the program then.
    """
    found = solve(program)
    if not isinstance(found, Infeasible) or found.farkas is None:
        raise ComputationError(program.label, "no multipliers of infeasibility found", found.attempts)
    return dict(found.farkas.multipliers)
