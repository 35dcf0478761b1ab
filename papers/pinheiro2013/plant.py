"""Plant of pinheiro2013: a rigid microsatellite near the LVLH orientation, with uncertain moments of inertia.

The generalized plant is built block by block as Section 3 does: every product of an uncertain moment with a signal is
a small linear fractional transformation, (13) to (15), and the uncertainty is pulled out of them.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from gainsay.errors import InputError
from gainsay.systems.lft import Lft
from gainsay.tables import Case

AXES = ("x", "y", "z")
#: groups of axes that (8) leaves coupled, with their angles
GROUPS = {"pitch": ("y",), "roll_yaw": ("x", "z"), "all": ("x", "y", "z")}
ANGLES = {"x": "phi", "y": "theta", "z": "psi"}
RECONSTRUCTIONS = ("a", "b")


@dataclass(frozen=True)
class Satellite:
    """What the paper leaves out, beside what it prints.

    Attributes
    ----------
    inertia : tuple of float
        Nominal principal moments Ix, Iy, Iz, kg m^2.
    n : float
        Orbital rate, rad/s.
    change : float
        p_i over the nominal I_i of (11).
    weights : tuple of float
        Q1 on angles, Q2 on rates, R on the torques in (18).
    """

    inertia: tuple[float, float, float]
    n: float
    change: float = 0.1
    weights: tuple[float, float, float] = (0.1, 0.1, 1.0)

    def __post_init__(self) -> None:
        x, y, z = self.inertia
        if min(self.inertia) <= 0 or max(self.inertia) > sum(self.inertia) - max(self.inertia):
            raise InputError(
                "moments of inertia", value=(x, y, z), expected="positive, none above the sum of the others"
            )
        if not 0 <= self.change < 1:
            raise InputError("relative change of the moments of inertia", value=self.change, expected="0 to below 1")

    def moment(self, axis: str) -> float:
        """Nominal moment of inertia about an axis, kg m^2."""
        return self.inertia[AXES.index(axis)]

    def changed(self, shares: Iterable[float]) -> "Satellite":
        """Return the satellite with its moments multiplied by one plus the shares given for x, y, z."""
        x, y, z = (m * (1 + s) for m, s in zip(self.inertia, shares, strict=True))
        return replace(self, inertia=(x, y, z))


def reconstruction(case: Case, name: str) -> Satellite:
    """Reconstruction A or B of the inputs that the paper leaves out.

    Parameters
    ----------
    case : gainsay.tables.Case
    name : {"a", "b"}
    """
    if name not in RECONSTRUCTIONS:
        raise InputError("reconstruction", value=name, expected=" or ".join(RECONSTRUCTIONS))
    x, y, z = (case.number(f"inertia_{name}_{axis}") for axis in AXES)
    angle, rate, control = (case.number(f"{what}_weight") for what in ("angle", "rate", "control"))
    return Satellite((x, y, z), case.number("orbital_rate"), case.number("inertia_change"), (angle, rate, control))


def short(K: np.ndarray) -> str:
    """A gain for one line of a log."""
    return "[" + ", ".join(f"{x:.4g}" for x in K.ravel()) + "]"


def perturbed(case: Case, satellite: Satellite, group: str) -> tuple[Satellite, Satellite]:
    """Plants with uncertainty 1 and 2 of list (i) for pitch, of list (ii) for roll and yaw."""
    shares = 0.01 * case.matrix("pitch_changes" if group == "pitch" else "roll_yaw_changes")
    first, second = (satellite.changed(row) for row in shares)
    return first, second


@dataclass(frozen=True)
class Product:
    """A term +-coefficient * I_moment * signal of the torque balance of an axis, (8) solved for I q''.

    Attributes
    ----------
    sign : int
    coefficient : float
        Without its sign.
    moment : str
        Axis of the moment of inertia.
    state : int
        Index of the signal in the state of the group.
    """

    sign: int
    coefficient: float
    moment: str
    state: int


def products(axis: str, axes: Sequence[str], n: float) -> tuple[Product, ...]:
    """Terms of (8) for an axis; the state holds the angles of `axes`, then their rates."""
    angle = {a: i for i, a in enumerate(axes)}
    rate = {a: i + len(axes) for i, a in enumerate(axes)}
    if axis == "y":
        return Product(-1, 3 * n**2, "x", angle["y"]), Product(1, 3 * n**2, "z", angle["y"])
    if axis == "x":
        coupling = tuple(Product(s, n, a, rate["z"]) for s, a in ((1, "x"), (-1, "y"), (1, "z")))
        return Product(-1, 4 * n**2, "y", angle["x"]), Product(1, 4 * n**2, "z", angle["x"]), *coupling
    coupling = tuple(Product(s, n, a, rate["x"]) for s, a in ((-1, "x"), (1, "y"), (-1, "z")))
    return Product(-1, n**2, "y", angle["z"]), Product(1, n**2, "x", angle["z"]), *coupling


def inverse_moment(moment: float, change: float) -> Lft:
    """Block M1 of (14), 1/I pulled out of its uncertainty, with the sign that (13) asks for in M21.

    Erratum `eq14-sign`.
    """
    return Lft.split([[-change / moment, 1 / moment], [-change / moment, 1 / moment]], 1, 1)


def product_block(term: Product, moment: float, change: float) -> Lft:
    """Block M2 or M3 of (15): coefficient times moment; the sign goes with the signal, as M3 has it.

    Its output is subtracted from the torque, as in Figure 2.
    """
    return Lft.split([[0.0, -term.sign], [term.coefficient * change, -term.sign * term.coefficient * moment]], 1, 1)


@dataclass(frozen=True, eq=False)
class GeneralizedPlant:
    """The plant (18) of a group of axes, in the notation of (19) and (21).

    Attributes
    ----------
    A, B1, B2 : ndarray
        dx/dt = A x + B1 w + B2 u; x are the angles, then their rates; w the uncertainty channels, then the
        disturbing torques d of the axes.
    C1, D11, D12 : ndarray
        z_inf = C1 x + D11 w + D12 u.
    C2, D22 : ndarray
        z_2 = C2 x + D22 u.
    channels : tuple of str
        Axis of the moment of inertia whose uncertainty closes each channel.
    axes : tuple of str
    """

    A: np.ndarray
    B1: np.ndarray
    B2: np.ndarray
    C1: np.ndarray
    D11: np.ndarray
    D12: np.ndarray
    C2: np.ndarray
    D22: np.ndarray
    channels: tuple[str, ...]
    axes: tuple[str, ...]

    def uncertain(self, delta: Sequence[float]) -> tuple[np.ndarray, np.ndarray]:
        """State matrix and torque matrix with the uncertainty loop closed by delta_x, delta_y, delta_z.

        Returns
        -------
        A : ndarray, shape (2 a, 2 a)
        B : ndarray, shape (2 a, a)
            For control and disturbing torques alike.
        """
        q, states = len(self.channels), self.A.shape[0]
        inputs = np.hstack([self.A, self.B2])
        outputs = np.hstack([self.C1, self.D12])
        loop = Lft(self.D11[:, :q], outputs, self.B1[:, :q], inputs)
        closed = loop.close(np.diag([delta[AXES.index(axis)] for axis in self.channels]))
        return closed[:, :states], closed[:, states:]

    def closed(self, K: np.ndarray) -> tuple[np.ndarray, ...]:
        """Return the closed loop with u = -K x: A - B2 K, B1, C1 - D12 K, D11, C2 - D22 K.

        Raises
        ------
        InputError
            If the gain has the wrong shape.
        """
        K = np.asarray(K, dtype=float)
        if K.shape != self.B2.T.shape:
            raise InputError("gain of the wrong shape", field="K", value=K.shape, expected=str(self.B2.T.shape))
        return self.A - self.B2 @ K, self.B1, self.C1 - self.D12 @ K, self.D11, self.C2 - self.D22 @ K


def generalized_plant(satellite: Satellite, group: str) -> GeneralizedPlant:
    """Generalized plant (18) of the pitch axis, or its counterpart for roll and yaw, or for all three axes.

    Torques act with +1/I as (12) says; (17) and (18) print -1/Iy, which only turns the sign of K (erratum
    `eq18-torque-sign`).

    Parameters
    ----------
    satellite : Satellite
    group : {"pitch", "roll_yaw", "all"}
    """
    if group not in GROUPS:
        raise InputError("group of axes", value=group, expected=" or ".join(GROUPS))
    axes = GROUPS[group]
    a = len(axes)
    terms = {axis: products(axis, axes, satellite.n) for axis in axes}
    q = sum(1 + len(t) for t in terms.values())
    A, B1, B2 = np.zeros((2 * a, 2 * a)), np.zeros((2 * a, q + a)), np.zeros((2 * a, a))
    C1, D11, D12 = np.zeros((q, 2 * a)), np.zeros((q, q + a)), np.zeros((q, a))
    A[:a, a:] = np.eye(a)
    channels: list[str] = []
    for i, axis in enumerate(axes):
        first = len(channels)
        moment = satellite.moment(axis)
        block = inverse_moment(moment, satellite.change * moment)
        torque_x, torque_w = np.zeros(2 * a), np.zeros(q + a)
        for k, term in enumerate(terms[axis], start=first + 1):
            inner = satellite.moment(term.moment)
            part = product_block(term, inner, satellite.change * inner)
            C1[k, term.state] = part.M12.item()
            torque_x[term.state] -= part.M22.item()
            torque_w[k] -= part.M21.item()
        torque_w[q + i] = 1.0
        for row_x, row_w, row_u, gain_w, gain_t in (
            (A[a + i], B1[a + i], B2[a + i], block.M21.item(), block.M22.item()),
            (C1[first], D11[first], D12[first], block.M11.item(), block.M12.item()),
        ):
            row_x += gain_t * torque_x
            row_w += gain_t * torque_w
            row_w[first] += gain_w
            row_u[i] = gain_t
        channels += [axis, *(term.moment for term in terms[axis])]
    angle, rate, control = satellite.weights
    C2 = np.vstack([np.diag([angle] * a + [rate] * a), np.zeros((a, 2 * a))])
    D22 = np.vstack([np.zeros((2 * a, a)), control * np.eye(a)])
    return GeneralizedPlant(A, B1, B2, C1, D11, D12, C2, D22, tuple(channels), axes)


def linear_model(satellite: Satellite, group: str) -> tuple[np.ndarray, np.ndarray]:
    """State and torque matrix of (8), written out by hand for the moments as they are."""
    Ix, Iy, Iz = satellite.inertia
    n = satellite.n
    c = n * (Ix - Iy + Iz)
    axes = GROUPS[group]
    a = len(axes)
    A, B = np.zeros((2 * a, 2 * a)), np.zeros((2 * a, a))
    A[:a, a:] = np.eye(a)
    for i, axis in enumerate(axes):
        B[a + i, i] = 1 / satellite.moment(axis)
    if "y" in axes:
        j = axes.index("y")
        A[a + j, j] = -3 * n**2 * (Ix - Iz) / Iy
    if "x" in axes:
        i, k = axes.index("x"), axes.index("z")
        A[a + i, i], A[a + i, a + k] = -4 * n**2 * (Iy - Iz) / Ix, c / Ix
        A[a + k, k], A[a + k, a + i] = -(n**2) * (Iy - Ix) / Iz, -c / Iz
    return A, B
