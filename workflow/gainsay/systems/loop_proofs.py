"""Ready proofs about a loop whose matrices are formulas over the tables: poles inside a region or outside, norms.

The witness is computed from the doubles nearest to what the formulas say, so that no matrix is entered twice.
"""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from scipy.linalg import solve_continuous_lyapunov, solve_discrete_lyapunov

from gainsay.lmi import Solved
from gainsay.proof import Certificate, build
from gainsay.statements import Stated, read_constraint, symmetric
from gainsay.statements.floats import Floats
from gainsay.systems.norms import bounded_real_certificate_matrix
from gainsay.systems.regions import Disk, HalfPlane

__all__ = [
    "abscissa",
    "box_left_of",
    "h2_norm_between",
    "norm_below",
    "pole_distance",
    "pole_outside_disk",
    "pole_right_of",
    "poles_in_disk",
    "poles_left_of",
    "values",
]

#: least margin of one Lyapunov matrix over a box, so that it survives rounding
_ROOM = 1e-5
#: part of the room between two bounds of an H2 norm by which its Gramian is moved
_OF_ROOM = 0.1

Definitions = Mapping[str, str] | Iterable[tuple[str, str]]


def values(case: Any, formulas: Iterable[str], definitions: Definitions) -> tuple[np.ndarray, ...]:
    """Doubles nearest to formulas without unknowns.

    Parameters
    ----------
    case : gainsay.tables.Case
    formulas : iterable of str
    definitions : mapping of str to str, or pairs
        Names that the formulas use, in order.

    Raises
    ------
    CertificateError
        If one is no formula, or names something that is not defined.
    """
    floats = Floats(case, dict(definitions), {})
    return tuple(floats.constant(formula) for formula in formulas)


def poles_left_of(case: Any, matrix: str, alpha: str, *, definitions: Definitions, **parts: Any) -> Certificate:
    """Certify that every eigenvalue of a matrix has a real part below alpha.

    Parameters
    ----------
    case : gainsay.tables.Case
    matrix, alpha : str
        Formulas; alpha in 1/s.
    definitions : mapping of str to str, or pairs
        As for `values`.
    **parts
        id, statement, quantities (of ``abscissa``, ``stable``), faith: as for `gainsay.proof.build.certificate`.

    Raises
    ------
    InputError
        If an eigenvalue has not.
    CertificateError
        If the proof is not accepted, by a margin too small for rounded digits.
    """
    A, limit = values(case, (matrix, alpha), definitions)
    return build.certificate(
        "lyapunov",
        tables=case,
        definitions=definitions,
        fields={"matrix": matrix, "alpha": alpha},
        witness={"P": HalfPlane(limit.item()).lyapunov_matrix(A)},
        **parts,
    )


def poles_in_disk(
    case: Any, matrix: str, centre: str, radius: str, *, definitions: Definitions, **parts: Any
) -> Certificate:
    """Certify that every eigenvalue s of a matrix has |s + centre| < radius.

    Parameters and errors as for `poles_left_of`, centre and radius in 1/s; a quantity of ``radius``.
    """
    A, a, b = values(case, (matrix, centre, radius), definitions)
    return build.certificate(
        "stein",
        tables=case,
        definitions=definitions,
        fields={"matrix": matrix, "shift": centre, "radius": radius},
        witness={"P": Disk(a.item(), b.item()).lyapunov_matrix(A)},
        **parts,
    )


def box_left_of(
    case: Any, vertices: Sequence[str], alphas: Sequence[str], *, definitions: Definitions, **parts: Any
) -> Certificate:
    """Certify by one Lyapunov matrix that every convex combination of matrices has its eigenvalues left of alpha.

    So a loop is proved whose matrix is affine in uncertain numbers of a box, or a convex combination of what it is at
    the box's vertices; that it is one is for the certificate's faith to say.

    Parameters
    ----------
    case : gainsay.tables.Case
    vertices : sequence of str
        Formulas of square matrices of one size.
    alphas : sequence of str
        Formulas, 1/s, the strictest first: the first one for which there is such a matrix is certified.
    definitions : mapping of str to str, or pairs
    **parts
        As for `poles_left_of`.

    Raises
    ------
    ComputationError
        If no matrix is found for the last alpha.
    CertificateError
        If the proof is not accepted.
    """
    size = len(values(case, vertices[:1], definitions)[0])
    for alpha in alphas:
        decay = [
            read_constraint(f"sym(P@({vertex})) - 2*({alpha})*P < 0", f"vertex {number}")
            for number, vertex in enumerate(vertices, start=1)
        ]
        stated = Stated(
            case, [decay, "P > 0"], None, {"P": symmetric(size)}, dict(definitions), label="vertices", margin=_ROOM
        )
        outcome = stated.solve()
        if isinstance(outcome, Solved):
            break
    return build.certificate(
        "lyapunov",
        tables=case,
        definitions=definitions,
        fields={"matrix": list(vertices), "alpha": alpha},
        witness={"P": outcome.need(f"one Lyapunov matrix for {len(vertices)} vertices")["P"]},
        **parts,
    )


def pole_right_of(case: Any, matrix: str, alpha: str, *, definitions: Definitions, **parts: Any) -> Certificate:
    """Certify that a matrix has an eigenvalue with a real part above alpha, where none lies on that line.

    Parameters and errors as for `poles_left_of`.
    """
    A, limit = values(case, (matrix, alpha), definitions)
    moved = A - limit.item() * np.eye(len(A))
    return build.certificate(
        "unstable",
        tables=case,
        definitions=definitions,
        fields={"matrix": matrix, "alpha": alpha},
        witness=_indefinite(solve_continuous_lyapunov(moved.T, -np.eye(len(A)))),
        **parts,
    )


def pole_outside_disk(
    case: Any, matrix: str, centre: str, radius: str, *, definitions: Definitions, **parts: Any
) -> Certificate:
    """Certify that a matrix has an eigenvalue s with |s + centre| > radius, where none lies on that circle.

    Parameters and errors as for `poles_left_of`, centre and radius in 1/s; a quantity of ``radius``.
    """
    A, a, b = values(case, (matrix, centre, radius), definitions)
    moved = (A + a.item() * np.eye(len(A))) / b.item()
    return build.certificate(
        "unstable",
        tables=case,
        definitions=definitions,
        fields={"matrix": matrix, "shift": centre, "radius": radius},
        witness=_indefinite(solve_discrete_lyapunov(moved.T, np.eye(len(A)))),
        **parts,
    )


def abscissa(case: Any, matrix: str, *, definitions: Definitions, quantity: str, **parts: Any) -> Certificate:
    """Enclose the largest real part of the eigenvalues of a matrix, 1/s.

    Parameters
    ----------
    case : gainsay.tables.Case
    matrix : str
        Formula.
    definitions : mapping of str to str, or pairs
    quantity : str
        What is enclosed.
    **parts
        id, statement, faith: as for `gainsay.proof.build.certificate`.

    Raises
    ------
    CertificateError
        If the eigenvalues cannot be enclosed.
    """
    return build.certificate(
        "eigenvalues",
        tables=case,
        definitions=definitions,
        fields={"matrix": matrix, "measure": "abscissa"},
        quantities={"abscissa": quantity},
        **parts,
    )


def pole_distance(
    case: Any, matrix: str, points: Sequence[Sequence[str]], *, definitions: Definitions, quantity: str, **parts: Any
) -> Certificate:
    """Enclose the distance of the eigenvalues of a matrix from as many points, in the best matching, 1/s.

    Parameters and errors as for `abscissa`; points are pairs of decimals, real and imaginary part.
    """
    return build.certificate(
        "eigenvalues",
        tables=case,
        definitions=definitions,
        fields={"matrix": matrix, "measure": "matching", "points": points},
        quantities={"matching": quantity},
        **parts,
    )


def norm_below(
    case: Any, system: Mapping[str, str], gamma: str, *, definitions: Definitions, **parts: Any
) -> Certificate:
    """Certify that the H-infinity norm of a stable system is below gamma.

    Parameters
    ----------
    case : gainsay.tables.Case
    system : mapping of str to str
        Formulas of ``A``, ``B``, ``C`` and, where it is not zero, ``D``.
    gamma : str
        Formula.
    definitions : mapping of str to str, or pairs
    **parts
        id, statement, quantities (of ``norm``, ``stable``), faith: as for `gainsay.proof.build.certificate`.

    Raises
    ------
    InputError
        If the norm is not below gamma.
    CertificateError
        If the proof is not accepted, by a margin too small for rounded digits.
    """
    *matrices, level = values(case, (*system.values(), gamma), definitions)
    of = dict(zip(system, matrices, strict=True))
    return build.certificate(
        "bounded_real",
        tables=case,
        definitions=definitions,
        fields={**system, "gamma": gamma},
        witness={"P": bounded_real_certificate_matrix(of["A"], of["B"], of["C"], of.get("D"), level.item())},
        **parts,
    )


def h2_norm_between(
    case: Any, system: Mapping[str, str], low: str, high: str, *, definitions: Definitions, **parts: Any
) -> Certificate:
    """Certify that the H2 norm of a stable system lies between two bounds, by its observability Gramian.

    Parameters
    ----------
    case : gainsay.tables.Case
    system : mapping of str to str
        Formulas of ``A``, ``B``, ``C``.
    low, high : str
        Formulas, with room on both sides of the norm.
    definitions : mapping of str to str, or pairs
    **parts
        id, statement, quantities (of ``norm``, ``stable``), faith: as for `gainsay.proof.build.certificate`.

    Raises
    ------
    CertificateError
        If the system is unstable, or its norm not between them by a margin that survives rounding.
    """
    A, _, C, lower, upper = values(case, (system["A"], system["B"], system["C"], low, high), definitions)
    gramian = solve_continuous_lyapunov(A.T, -C.T @ C)
    share = _OF_ROOM * (upper.item() - lower.item()) / (upper.item() + lower.item())
    return build.certificate(
        "h2",
        tables=case,
        definitions=definitions,
        fields={**system, "bound": high, "lower": low},
        witness={"P": (1 + share) * gramian, "S": (1 - share) * gramian},
        **parts,
    )


def _indefinite(P: np.ndarray) -> dict[str, np.ndarray]:
    """P of Lyapunov's or Stein's equation, scaled to one, with a z of z'Pz < 0."""
    P = (P + P.T) / (2 * np.abs(P).max())
    return {"P": P, "z": np.linalg.eigh(P)[1][:, 0]}
