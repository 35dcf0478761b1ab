"""Plant of li2021: rigid microsatellite with flexible appendages, its uncertainty factors and its closed loops.

Every function works in the arithmetic of its input: floats for computing, ``Fraction`` objects where an identity is
to hold exactly. Equation numbers are those of the paper.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Generic, TypeVar

import numpy as np
from flint import acb, arb

from gainsay.dynamics.flexible import FlexibleBody
from gainsay.errors import InputError
from gainsay.exact.ball import lower, precision, upper
from gainsay.exact.rational import to_fmpq
from gainsay.systems.norm_bounds import above, below
from gainsay.systems.spectrum import ROOT_BITS, rational, roots
from gainsay.tables import Case

#: a double, or a rational where an identity is to hold exactly; one such number for each axis
Number = float | Fraction
Triple = Sequence[Number]
N = TypeVar("N", float, Fraction)

SHAPES = {"A": (6, 6), "B": (6, 3), "C": (3, 6)}
"""Shapes of the gains of (8): controller state 6, measured angles 3, torque 3."""


@dataclass(frozen=True)
class Constants(Generic[N]):
    """What Table 1 prints, in SI units.

    Parameters
    ----------
    orbital_rate : number
        n, rad/s.
    inertia : tuple of number
        J10, J20, J30, kg m^2.
    envelope : tuple of number
        Perturbation envelopes Delta J_i, kg m^2 (the second one is printed negative).
    coupling : ndarray, shape (4, 3)
        F, sqrt(kg) m.
    frequency, damping : tuple of number
        Modal frequencies (rad/s) and damping ratios (1).
    """

    orbital_rate: N
    inertia: Sequence[N]
    envelope: Sequence[N]
    coupling: np.ndarray
    frequency: Sequence[N]
    damping: Sequence[N]

    def inertia_with(self, delta: Triple) -> tuple[Number, ...]:
        """J_i0 + Delta J_i delta_i, kg m^2."""
        return tuple(j + e * d for j, e, d in zip(self.inertia, self.envelope, delta, strict=True))


AnyConstants = Constants[float] | Constants[Fraction]


@dataclass(frozen=True, eq=False)
class Gains:
    """Gains A_f (6, 6), B_f (6, 3), C_f (3, 6) of the controller (8).

    Raises
    ------
    InputError
        If a matrix has another shape, or an entry that is not finite.
    """

    A: np.ndarray
    B: np.ndarray
    C: np.ndarray

    def __post_init__(self) -> None:
        for letter, (rows, columns) in SHAPES.items():
            value = getattr(self, letter)
            if np.shape(value) != (rows, columns):
                shape = "x".join(map(str, np.shape(value)))
                raise InputError(field=f"{letter}_f", value=shape, expected=f"a {rows}x{columns} matrix")
            if value.dtype != object and not np.all(np.isfinite(value)):
                raise InputError(f"{letter}_f has an entry that is not finite", expected="finite gains")


@dataclass(frozen=True, eq=False)
class Plant:
    """Plant x' = A x + B u, y = C x from the torque to the measured angles, with n states."""

    A: np.ndarray
    B: np.ndarray
    C: np.ndarray


@dataclass(frozen=True, eq=False)
class RigidPlant(Plant):
    """Reduced plant (7), 6 states, with Minv (3, 3), the inverse of J - F^T F."""

    Minv: np.ndarray


@dataclass(frozen=True, eq=False)
class Factors:
    """Factors of Delta J, Delta D and Delta G: for every delta XD Delta_D GD = D(J) - D0, XG Delta_G GG = G(J) - G0.

    Attributes
    ----------
    XJ, XD, GD, XG, GG : ndarray, shapes (3, 3), (3, 6), (6, 3), (3, 6), (6, 3)
    order_D, order_G : tuple of int, length 6
        Index of the delta_i on the diagonals of Delta_D and Delta_G.
    """

    XJ: np.ndarray
    XD: np.ndarray
    GD: np.ndarray
    XG: np.ndarray
    GG: np.ndarray
    order_D: tuple[int, ...]
    order_G: tuple[int, ...]


@dataclass(frozen=True, eq=False)
class Uncertain:
    """Factors of (7) at their printed sizes: Delta A = L Delta H K, L (6, 12), K (12, 6), and E, W0 (6, 6)."""

    L: np.ndarray
    K: np.ndarray
    E: np.ndarray
    W0: np.ndarray


def constants(case: Case) -> Constants[float]:
    """Table 1 of the paper from its tables, as floats."""
    return _table_1(case.number, case.matrix("F"))


def exact_constants(case: Case) -> Constants[Fraction]:
    """Table 1 of the paper from its tables, exactly."""
    return _table_1(case.exact, np.array(case.printed("F").exact, dtype=object))


def _table_1(number: Callable[[str], N], F: np.ndarray) -> Constants[N]:
    inertia = tuple(number(f"J{i}0") for i in (1, 2, 3))
    share = tuple(number(f"inertia_share_{i}") for i in (1, 2, 3))
    return Constants(
        orbital_rate=number("orbital_rate"),
        inertia=inertia,
        envelope=tuple(j * s for j, s in zip(inertia, share, strict=True)),
        coupling=F,
        frequency=tuple(number(f"modal_frequency_{i}") for i in (1, 2, 3, 4)),
        damping=tuple(number(f"modal_damping_{i}") for i in (1, 2, 3, 4)),
    )


def _like(entries: list, sample: Number) -> np.ndarray:
    exact = isinstance(sample, Fraction)
    return np.array(entries, dtype=object) if exact else np.array(entries, dtype=float)


def gyroscopic(n: Number, J: Triple) -> np.ndarray:
    """Matrix D of (6) for inertias J (N m s/rad)."""
    c = n * (J[0] + J[2] - J[1])
    return _like([[0 * c, 0 * c, -c], [0 * c] * 3, [c, 0 * c, 0 * c]], c)


def gravity_gradient(n: Number, J: Triple) -> np.ndarray:
    """Matrix G of (6) for inertias J (N m/rad)."""
    g = (4 * n * n * (J[1] - J[2]), 3 * n * n * (J[0] - J[2]), n * n * (J[1] - J[0]))
    return diagonal(g)


def diagonal(entries: Sequence[Number]) -> np.ndarray:
    """Diagonal matrix in the arithmetic of its entries."""
    zero = entries[0] * 0
    return _like([[e if i == j else zero for j in range(len(entries))] for i, e in enumerate(entries)], zero)


def rate_of_frame(n: Number) -> np.ndarray:
    """Matrix N-bar of (6) (rad/s): w' = q'' + N-bar q' to first order."""
    return _like([[0 * n, 0 * n, -n], [0 * n] * 3, [n, 0 * n, 0 * n]], n)


def inverse(M: np.ndarray) -> np.ndarray:
    """Inverse of a 3x3 matrix by cofactors, exact for ``Fraction`` entries."""
    if M.dtype != object:
        return np.linalg.inv(M)
    C = np.empty((3, 3), dtype=object)
    for i in range(3):
        for j in range(3):
            r, s = [k for k in range(3) if k != i], [k for k in range(3) if k != j]
            minor = M[r[0], s[0]] * M[r[1], s[1]] - M[r[0], s[1]] * M[r[1], s[0]]
            C[j, i] = minor if (i + j) % 2 == 0 else -minor
    return C / sum(M[0, k] * C[k, 0] for k in range(3))


def uncertainty_factors(k: AnyConstants) -> Factors:
    """Factors of Delta J, Delta D, Delta G with the corrected Gamma_D and Gamma_G."""
    n, (d1, d2, d3) = k.orbital_rate, k.envelope
    o = 0 * d1
    one = o + 1
    XD = n * _like([[o, -d1, o, -d3, o, -d2], [o] * 6, [d1, o, d3, o, d2, o]], o)
    GD = _like([[one, o, one, o, -one, o], [o] * 6, [o, one, o, one, o, -one]], o).T
    XG = n * n * _like([[d2, o, o, o, -4 * d3, o], [o, o, 3 * d1, 3 * d3, o, o], [o, d2, o, o, o, -d1]], o)
    GG = _like([[4 * one, o, o, o, one, o], [o, o, one, -one, o, o], [o, one, o, o, o, one]], o).T
    return Factors(
        XJ=diagonal((d1, d2, d3)), XD=XD, GD=GD, XG=XG, GG=GG, order_D=(0, 0, 2, 2, 1, 1), order_G=(1, 1, 0, 2, 2, 0)
    )


def rigid(k: AnyConstants, delta: Triple = (0, 0, 0)) -> RigidPlant:
    """Reduced plant (7): x' = A x + B (u + d~), y = C x, with inertias J_i0 + Delta J_i delta_i in J, D and G alike."""
    n, F, J = k.orbital_rate, k.coupling, k.inertia_with(delta)
    FtF = F.T @ F
    Minv = inverse(diagonal(J) - FtF)
    o = 0 * n
    eye = diagonal((o + 1,) * 3)
    zero = 0 * eye
    A = np.block([[zero, eye], [-Minv @ gravity_gradient(n, J), -Minv @ (gyroscopic(n, J) - FtF @ rate_of_frame(n))]])
    return RigidPlant(A=A, B=np.vstack([zero, Minv]), C=np.hstack([eye, zero]), Minv=Minv)


def uncertain(k: AnyConstants) -> Uncertain:
    """Factors of (7): Delta A = L Delta H K, E and W0, at their printed sizes."""
    f = uncertainty_factors(k)
    Minv = rigid(k).Minv
    z36, z63, z33 = 0 * f.XG, 0 * f.GG, 0 * Minv
    return Uncertain(
        L=np.block([[z36, z36], [-Minv @ f.XG, -Minv @ f.XD]]),
        K=np.block([[f.GG, z63], [z63, f.GD]]),
        E=np.block([[z33, z33], [z33, Minv]]),
        W0=np.block([[z33, z33], [z33, f.XJ]]),
    )


def flexible(k: AnyConstants, delta: Triple = (0, 0, 0)) -> Plant:
    """Full plant (6) in the state (q, q', eta, eta'), 14 states; input u + d.

    Notes
    -----
    The mass matrix [[J, F^T], [F, I]] is inverted by its Schur complement J - F^T F.
    """
    n, J = k.orbital_rate, k.inertia_with(delta)
    body = FlexibleBody(
        inertia=diagonal(J),
        coupling=k.coupling,
        frequency=np.array(k.frequency),
        damping=np.array(k.damping),
        gyroscopic=gyroscopic(n, J),
        stiffness=gravity_gradient(n, J),
        frame_rate=rate_of_frame(n),
    )
    A, B = body.state_space()
    C = np.hstack([np.eye(3), np.zeros((3, 11))])
    return Plant(A=A, B=B, C=C)


def controller(case: Case, name: str, exact: bool = False) -> Gains:
    """Gains of (8) as floats or exactly: ``proposed`` and ``comparison`` (the paper's [39]) as printed, or a design's.

    Raises
    ------
    gainsay.errors.InputError
        On another name, or on a matrix of another shape than 6x6, 6x3, 3x6.
    """
    suffix = {"proposed": "", "comparison": "39"}.get(name)
    if suffix is None and name not in case.designs:
        raise InputError(field="controller", value=name, expected="proposed, comparison or a design")
    own = case.designs[name].matrices if suffix is None else {s: case.printed(f"{s}f{suffix}") for s in "ABC"}
    return Gains(*(np.array(own[s].exact if exact else own[s].floats) for s in "ABC"))


def closed_loop(
    plant: Plant, gains: Gains, fa: np.ndarray | None = None, fb: np.ndarray | None = None, fc: np.ndarray | None = None
) -> np.ndarray:
    """State matrix of (10) with gain factors: A_f diag(fa), B_f diag(fb), diag(fc) C_f as in (9).

    Parameters
    ----------
    plant : Plant
        `rigid` or `flexible`.
    gains : Gains
    fa, fb, fc : ndarray, shapes (..., 6), (..., 3), (..., 3), optional
        Factors (1 + delta); leading axes give a stack of loops.

    Returns
    -------
    ndarray, shape (..., n + 6, n + 6)
    """
    one = np.ones(6, dtype=int) if plant.A.dtype == object else np.ones(6)
    fa = one if fa is None else np.asarray(fa)
    fb = one[:3] if fb is None else np.asarray(fb)
    fc = one[:3] if fc is None else np.asarray(fc)
    lead = np.broadcast_shapes(fa.shape[:-1], fb.shape[:-1], fc.shape[:-1], plant.A.shape[:-2])
    m = plant.A.shape[-1]
    loop = np.empty((*lead, m + 6, m + 6), dtype=plant.A.dtype)
    loop[..., :m, :m] = plant.A
    loop[..., :m, m:] = plant.B @ (fc[..., :, None] * gains.C)
    loop[..., m:, :m] = (gains.B * fb[..., None, :]) @ plant.C
    loop[..., m:, m:] = gains.A * fa[..., None, :]
    return loop


def enclosed_poles(A: np.ndarray, of: Callable[[acb], arb]) -> dict[str, float]:
    """Largest value of a function of the eigenvalues of a rational matrix: nearest double, and ends of its ball."""
    with precision(ROOT_BITS):
        eigenvalues = [of(ball) for ball, _ in roots(rational(A).charpoly())]
        least = max(lower(value) for value in eigenvalues)
        most = max(upper(value) for value in eigenvalues)
    return {"value": float((least + most) / 2), "lower": below(arb(to_fmpq(least))), "upper": above(arb(to_fmpq(most)))}


def enclosed_loop(case: Case, name: str) -> dict[str, dict[str, float]]:
    """Disk reach and abscissa of (10) with the gains of a controller, over the tables' digits in balls."""
    loop = closed_loop(rigid(exact_constants(case)), controller(case, name, exact=True))
    centre = arb(to_fmpq(case.exact("disk_centre")))
    return {
        "disk_radius": enclosed_poles(loop, lambda s: abs(s + centre)),
        "abscissa": enclosed_poles(loop, lambda s: s.real),
    }


def disturbance(case: Case, k: Constants[float]) -> np.ndarray:
    """Table 1's disturbance d(t) = D [cos n t, sin n t, 1], shape (3, 3), N m; nominal inertias."""
    return case.number("disturbance_amplitude") * np.array(k.inertia, dtype=float)[:, None] * case.matrix("disturbance")
