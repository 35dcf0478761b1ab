"""Ready proofs about a loop whose matrices are formulas over the tables: poles inside a region or outside, norms.

The witness is computed from the doubles nearest to what the formulas say, so that no matrix is entered twice.
"""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from scipy.linalg import solve_continuous_lyapunov, solve_discrete_lyapunov

from gainsay.errors import InputError
from gainsay.proof import Certificate, build
from gainsay.statements.floats import Floats
from gainsay.systems.norms import bounded_real_certificate_matrix, h2_norm
from gainsay.systems.regions import Disk, HalfPlane

__all__ = [
    "abscissa",
    "h2_norm_below",
    "norm_below",
    "pole_distance",
    "pole_outside_disk",
    "pole_right_of",
    "poles_in_disk",
    "poles_left_of",
    "values",
]

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


def h2_norm_below(
    case: Any, system: Mapping[str, str], bound: str, *, lower: str = "", definitions: Definitions, **parts: Any
) -> Certificate:
    """Certify that the H2 norm of a stable system is at most a bound, by its observability Gramian; or between two.

    Parameters
    ----------
    case : gainsay.tables.Case
    system : mapping of str to str
        Formulas of ``A``, ``B``, ``C``.
    bound : str
        Formula, above the norm.
    lower : str, optional
        Formula below the norm, where that is to be proved as well.
    definitions : mapping of str to str, or pairs
    **parts
        id, statement, quantities (of ``norm``, ``stable``), faith: as for `gainsay.proof.build.certificate`.

    Raises
    ------
    InputError
        If the system is unstable, or its norm is not below the bound and above the lower one.
    CertificateError
        If the proof is not accepted, by a margin too small for rounded digits.
    """
    A, B, C = values(case, [system[name] for name in "ABC"], definitions)
    norm = h2_norm(A, B, C)
    gramian = solve_continuous_lyapunov(A.T, -C.T @ C)
    raised = solve_continuous_lyapunov(A.T, -np.eye(len(A)))
    size = float(np.trace(B.T @ raised @ B)) or 1.0
    fields, witness = dict(system), {}
    for field, unknown, sign, text in (("bound", "P", 1, bound), ("lower", "S", -1, lower)):
        if not text:
            continue
        (level,) = values(case, [text], definitions)
        room = sign * (level.item() ** 2 - norm**2) / 2  # half of it for the square of the norm, half for rounding
        if not (room > 0 and level.item() > 0):
            side = "at or below" if sign > 0 else "at or above"
            expected = f"{'more' if sign > 0 else 'less'} than {norm!r}"
            raise InputError(f"level {side} the H2 norm", field=field, value=text, expected=expected)
        fields[field] = text
        witness[unknown] = gramian + sign * room / size * raised
    return build.certificate("h2", tables=case, definitions=definitions, fields=fields, witness=witness, **parts)


def _indefinite(P: np.ndarray) -> dict[str, np.ndarray]:
    """P of Lyapunov's or Stein's equation, scaled to one, with a z of z'Pz < 0."""
    P = (P + P.T) / (2 * np.abs(P).max())
    return {"P": P, "z": np.linalg.eigh(P)[1][:, 0]}
