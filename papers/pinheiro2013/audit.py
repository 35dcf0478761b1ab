"""Audit of pinheiro2013: its equations as identities, robustness over the inertia, scans over missing inputs."""

from itertools import product

import numpy as np

from gainsay.results import Results, task
from gainsay.statements import differing, identical
from gainsay.systems.spectrum import spectral_abscissa
from gainsay.systems.uncertain_plant import UncertainPlant
from gainsay.tables import Case
from papers.pinheiro2013 import proofs, statements
from papers.pinheiro2013.plant import RECONSTRUCTIONS, generalized_plant, linear_model, reconstruction
from papers.pinheiro2013.scans import SCANS
from papers.pinheiro2013.synthesis import LEVELS, SEPARATE

ROTATION = (
    "[[ct*cp, ct*sp, -st], [sf*st*cp - cf*sp, sf*st*sp + cf*cp, sf*ct], [cf*st*cp + sf*sp, cf*st*sp - sf*cp, cf*ct]]"
)
RATE = "[[1, 0, -st], [0, cf, sf*ct], [0, -sf, cf*ct]]"
#: sines and cosines to first order in angles e phi, e theta, e psi
FIRST_ORDER = {"sf": "e*phi", "cf": "1", "st": "e*theta", "ct": "1", "sp": "e*psi", "cp": "1"}
CIRCLES = ["cf**2 + sf**2 - 1", "ct**2 + st**2 - 1", "cp**2 + sp**2 - 1"]
#: a point at which the relations of an identity meet: sines 3/5 and cosines 4/5, no step e, moments 2; 1 elsewhere
MEETING = {
    **dict.fromkeys(("sf", "st", "sp"), "3/5"),
    **dict.fromkeys(("cf", "ct", "cp"), "4/5"),
    "e": "0",
    "I": "2",
    "Iy": "2",
    "v": "1/2",
}
LINEAR_RATE = "[[e*dphi - n*e*psi], [e*dtheta - n], [e*dpsi + n*e*phi]]"


@task("(1) to (8)")
def kinematics(case: Case, results: Results) -> None:
    """Prove the rotation, the rates and the linearisations."""
    trigonometry = "cf sf ct st cp sp"
    results.prove(
        identical(
            case,
            "eq2.rotation",
            "The matrix of (2) is orthogonal for all angles.",
            f"({ROTATION})@({ROTATION}).T",
            "eye(3)",
            trigonometry,
            modulo=CIRCLES,
            at=MEETING,
        ),
        source="(2)",
    )
    rates = "[[dphi], [dtheta], [dpsi]]"
    turned = {
        "c": f"({ROTATION})",
        "w": f"({RATE})@{rates}",
        "cross": "[[0, -w[2, 0], w[1, 0]], [w[2, 0], 0, -w[0, 0]], [-w[1, 0], w[0, 0], 0]]",
    }
    moved = ROTATION
    for letter, angle in (("f", "phi"), ("t", "theta"), ("p", "psi")):
        moved = moved.replace(f"s{letter}", f"(S{letter} + e*C{letter}*d{angle})")
        moved = moved.replace(f"c{letter}", f"(C{letter} - e*S{letter}*d{angle})")
    moved = moved.replace("S", "s").replace("C", "c")
    results.prove(
        identical(
            case,
            "eq3.kinematics",
            "With (3) the matrix C of (2) obeys dC/dt = -[omega x] C.",
            moved,
            "c - e*cross@c",
            f"{trigonometry} dphi dtheta dpsi e",
            definitions=turned,
            modulo=["e**2", *CIRCLES],
            at=MEETING,
        ),
        source="(3)",
    )
    five = f"({RATE})@{rates} - n*[[ct*sp], [sf*st*sp + cf*cp], [cf*st*sp - sf*cp]]"
    results.prove(
        identical(
            case,
            "eq5.kinematics",
            "(5) is (4): the rate of (3) less n times the second column of (2).",
            five,
            f"({RATE})@{rates} - n*({ROTATION})[0:3, 1:2]",
            f"{trigonometry} dphi dtheta dpsi n",
        ),
        source="(5)",
    )
    small = "e phi theta psi"
    results.prove(
        identical(
            case,
            "eq6.linear",
            "(6) is (5) to first order in angles and rates.",
            five.replace(rates, f"(e*{rates})"),
            LINEAR_RATE,
            f"{small} dphi dtheta dpsi n",
            definitions=FIRST_ORDER,
            modulo=["e**2"],
            at=MEETING,
        ),
        source="(6)",
    )
    nadir = {**FIRST_ORDER, "a": "[[-st], [sf*ct], [cf*ct]]", "ax": "a[0, 0]", "ay": "a[1, 0]", "az": "a[2, 0]"}
    torque = "3*n**2*[[(Iz - Iy)*ay*az], [(Ix - Iz)*az*ax], [(Iy - Ix)*ax*ay]]"
    results.prove(
        identical(
            case,
            "eq7.linear",
            "(7) is the gravity-gradient torque 3 n^2 a3 x (I a3) to first order.",
            torque,
            "3*n**2*e*[[(Iz - Iy)*phi], [(Iz - Ix)*theta], [0]]",
            f"{small} n Ix Iy Iz",
            definitions=nadir,
            modulo=["e**2"],
            at=MEETING,
        ),
        source="(7)",
    )
    motion = {
        "wx": "e*dphi - n*e*psi",
        "wy": "e*dtheta - n",
        "wz": "e*dpsi + n*e*phi",
        "dwx": "e*ddphi - n*e*dpsi",
        "dwy": "e*ddtheta",
        "dwz": "e*ddpsi + n*e*dphi",
        "gx": "3*n**2*(Iz - Iy)*e*phi",
        "gy": "3*n**2*(Iz - Ix)*e*theta",
        "gz": "0",
    }
    euler = "[[Ix*dwx - (Iy - Iz)*wy*wz - gx], [Iy*dwy - (Iz - Ix)*wz*wx - gy], [Iz*dwz - (Ix - Iy)*wx*wy - gz]]"
    eight = (
        "e*[[Ix*ddphi - n*(Ix - Iy + Iz)*dpsi + 4*n**2*(Iy - Iz)*phi], [Iy*ddtheta + 3*n**2*(Ix - Iz)*theta],"
        " [Iz*ddpsi + n*(Ix - Iy + Iz)*dphi + n**2*(Iy - Ix)*psi]]"
    )
    results.prove(
        identical(
            case,
            "eq8.linear",
            "(8) is (1) with (6) and (7), to first order.",
            euler,
            eight,
            f"{small} dphi dtheta dpsi ddphi ddtheta ddpsi n Ix Iy Iz",
            definitions=motion,
            modulo=["e**2"],
            at=MEETING,
        ),
        source="(8)",
    )
    results.say("(1) to (8)", "rotation, rates and linearisations proved as printed")


@task("(13) to (18)")
def transformations(case: Case, results: Results) -> None:
    """Prove or refute the linear fractional transformations of one block each, and (18); v stands for 1/I."""
    names, exact = "I v p d", "(I + p*d)"
    relation, point = ["I*v - 1"], {"I": "2", "v": "1/2", "p": "1/2", "d": "1"}
    results.prove(
        differing(
            case,
            "eq13.printed",
            "With (1 + delta/I)^-1 the second line of (13) is not 1/(I + p delta).",
            f"(v*(1 + v*d) - p*v*d*v)*{exact}",
            "1 + v*d",
            at=point,
        ),
        source="(13)",
    )
    results.prove(
        identical(
            case,
            "eq13.corrected",
            "With (1 + p delta/I)^-1 the second line of (13) is 1/(I + p delta).",
            f"(v*(1 + p*v*d) - p*v*d*v)*{exact}",
            "1 + p*v*d",
            names,
            modulo=relation,
            at=MEETING,
        ),
        source="(13)",
    )
    closed = "M22*(1 - M11*d) + M21*d*M12"
    blocks = {"M11": "-p*v", "M12": "v", "M22": "v"}

    def put(text: str, sign: str) -> str:
        values = {**blocks, "M21": f"{sign}p*v"}
        for name, value in values.items():
            text = text.replace(name, f"({value})")
        return text

    results.prove(
        differing(
            case,
            "eq14.printed",
            "The block M1 printed in (14) does not give 1/(I + p delta) in (9).",
            f"({put(closed, '')})*{exact}",
            put("1 - M11*d", ""),
            at=point,
        ),
        source="(14)",
    )
    results.prove(
        identical(
            case,
            "eq14.corrected",
            "M1 with -p/I in M21 gives 1/(I + p delta) in (9).",
            f"({put(closed, '-')})*{exact}",
            put("1 - M11*d", "-"),
            names,
            modulo=relation,
            at=MEETING,
        ),
        source="(14)",
    )
    results.prove(
        identical(
            case,
            "eq15.products",
            "M2 and M3 give 3 n^2 I x and -3 n^2 I x in (9).",
            "[[3*n**2*I + 3*n**2*p*d*1], [-3*n**2*I + 3*n**2*p*d*(-1)]]",
            "[[3*n**2*(I + p*d)], [-3*n**2*(I + p*d)]]",
            "n I p d",
        ),
        source="(15)",
    )
    results.prove(
        differing(
            case,
            "eq17.torque_sign",
            "The coefficient -1/Iy of d and u in (17), (18) is not that of (12).",
            "-v",
            "v",
            at={"v": "1/2"},
        ),
        source="(12), (17), (18)",
    )
    # w1 = delta_y z1 with z1 the acceleration itself, w2 = delta_x theta, w3 = -delta_z theta.
    eighteen = (
        "-3*n**2*(Ix - Iz)*v*theta - py*v*(dy*ddtheta) - 3*n**2*px*v*(dx*theta) - 3*n**2*pz*v*(-dz*theta) + v*d + v*u"
    )
    twelve = "u + d - 3*n**2*((Ix + px*dx) - (Iz + pz*dz))*theta"
    results.prove(
        identical(
            case,
            "eq18.closed",
            "(18) with +1/Iy, its uncertainty loop closed, is (12) with (11).",
            f"Iy*(ddtheta - ({eighteen}))",
            f"(Iy + py*dy)*ddtheta - ({twelve})",
            "Ix Iy Iz v px py pz dx dy dz n theta ddtheta u d",
            modulo=["Iy*v - 1"],
            at=MEETING,
        ),
        source="(11), (12), (18)",
    )
    results.say("(13) to (18)", "two blocks and a sign refuted as printed, proved as corrected; (18) proved")


@task("robustness over the inertia")
def robustness(case: Case, results: Results) -> None:
    """Prove stability over all 10 % changes of the three moments at once by one Lyapunov matrix a design."""
    share = case.number("inertia_change")
    corners = [share * np.array([a, b, c]) for a in (-1, 1) for b in (-1, 1) for c in (-1, 1)]
    for name in RECONSTRUCTIONS:
        with results.apart():
            satellite = reconstruction(case, name)
            for level, parameter in LEVELS.items():
                design = f"{name}_{statements.GAMMAS[level]}"
                for group in SEPARATE:
                    K = case.designs[design][f"K_{group}"]
                    worst = max(
                        spectral_abscissa(A - B @ K)
                        for A, B in (linear_model(satellite.changed(corner), group) for corner in corners)
                    )
                    _over_box(
                        results,
                        f"{name}.{level}.worst_abscissa.{group}",
                        worst,
                        statements.uncertain(case, design, group, "number('inertia_change')"),
                        id=f"robust-{design}-{group}".replace("_", "-"),
                        of=f"{design}, {group}",
                        within="10 %",
                        source="(11), Section 5",
                    )
                guaranteed = case.exact("inertia_change") / case.exact(parameter)
                results.enclosed(
                    f"{name}.{level}.guaranteed_share",
                    guaranteed,
                    guaranteed,
                    source="||Delta|| < 1/gamma",
                    method="p over gamma: delta is normalised, so that ||Delta|| < 1/gamma allows p/gamma",
                )
    results.say("inertia uncertainty", "stability over the whole box certified for twelve loops")


@task("small gain")
def small_gain(case: Case, results: Results) -> None:
    """Prove the designs of gamma = 0.2 stable for every change that a norm below 1/gamma of the uncertainty allows.

    At gamma = 2 and 100 these are changes within 5 % and 0.1 %, which the proof over 10 % holds.
    """
    most = case.number("inertia_change") / case.number("gamma_min")
    delta = [[sign / case.number("gamma_min") for sign in signs] for signs in product((-1, 1), repeat=3)]
    for name in RECONSTRUCTIONS:
        for group in SEPARATE:
            with results.apart():
                design = f"{name}_hinf"
                plant, K = generalized_plant(reconstruction(case, name), group), case.designs[design][f"K_{group}"]
                worst = max(spectral_abscissa(A - B @ K) for A, B in (plant.uncertain(d) for d in delta))
                _over_box(
                    results,
                    f"{name}.gamma_0.2.small_gain_abscissa.{group}",
                    worst,
                    statements.uncertain(case, design, group, "number('inertia_change')/number('gamma_min')"),
                    id=f"small-gain-{name}-{group}".replace("_", "-"),
                    of=f"{design}, {group}",
                    within=f"{100 * most:g} %",
                    source="||Delta|| < 1/gamma",
                )
    results.say("small gain", f"stability for changes up to {100 * most:g} % certified for four loops")


def _over_box(
    results: Results, quantity: str, worst: float, loops: UncertainPlant, *, id: str, of: str, within: str, source: str
) -> None:
    """Prove a spectral abscissa over the whole box by one Lyapunov matrix; the quantity is its worst at the corners."""
    results.certificate(
        loops.left_of(
            "varied",
            (f"{0.5 * worst:.6g}", "0"),
            id=id,
            statement=f"The loop {of}, is stable for every change of the moments within {within}, with one P.",
            quantities={"abscissa": quantity},
            faith=("That (8) with other moments of inertia is this matrix at those moments and their inverses.",),
        )
    )
    results.quantity(
        quantity,
        worst,
        source=source,
        method="eigenvalues at the eight corners; the certificate bounds it over the whole box",
    )


TASKS = (kinematics, transformations, robustness, small_gain, *proofs.TASKS, *SCANS)
