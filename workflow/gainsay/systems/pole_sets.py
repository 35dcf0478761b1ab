"""Poles as a multiset: what rounding of the entries does to them, and which of two sets belongs to which.

Single eigenvalues of a defective matrix answer a rounding of 1e-16 with 1e-8 and more; the mean of their cluster does
not. So poles whose discs meet are one cluster, with its number of poles and its mean.

References
----------
G. H. Golub, C. F. Van Loan, Matrix Computations, 4th ed., 2013, section 7.2 (Gershgorin's discs after a similarity).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import linear_sum_assignment

from gainsay.errors import InputError
from gainsay.systems.statespace import square


@dataclass(frozen=True)
class PoleCluster:
    """Poles that the given entries do not tell apart.

    Attributes
    ----------
    centre : complex
        Mean of the poles, 1/s.
    radius : float
        Every pole of the cluster lies this near to the centre, whatever the entries within their spread, 1/s.
    count : int
        How many poles, with multiplicity.
    """

    centre: complex
    radius: float
    count: int


def pole_clusters(A: np.ndarray, spread: np.ndarray | float = 0.0) -> list[PoleCluster]:
    """Return the eigenvalues of every matrix within a spread of A, as clusters.

    Parameters
    ----------
    A : ndarray, shape (n, n)
        Real.
    spread : ndarray, shape (n, n), or float
        Largest change of each entry, such as half a unit of its last printed digit.

    Returns
    -------
    list of PoleCluster
        Sorted by real, then imaginary part of the centre; the counts add up to n.

    Raises
    ------
    InputError
        If A is not square or finite, or a spread is negative.

    Examples
    --------
    >>> pole_clusters(np.diag([-1.0, -3.0]), 0.25)[0].centre
    (-3+0j)
    """
    A = square(A)
    n = len(A)
    spread = np.broadcast_to(np.asarray(spread, dtype=float), (n, n))
    if not np.isfinite(A).all() or not (spread >= 0).all():
        raise InputError("poles", value="entries or their spread", expected="finite entries, a spread of at least 0")
    poles, T = np.linalg.eig(A)
    inverse = _inverse(T)
    if inverse is None:  # defective to the last bit: all that is known is the disc of the whole matrix
        reach = np.linalg.norm(A, 2) + np.linalg.norm(spread)
        return [PoleCluster(complex(np.trace(A) / n), float(2 * reach), n)]
    rounding = n * np.finfo(float).eps * np.abs(A).max()
    residual = np.abs(inverse @ (A @ T - T * poles)) + np.abs(inverse) @ (spread + rounding) @ np.abs(T)
    return _clusters(poles, residual.sum(axis=1))


def _inverse(T: np.ndarray) -> np.ndarray | None:
    try:
        inverse = np.linalg.inv(T)
    except np.linalg.LinAlgError:
        return None
    return inverse if np.isfinite(inverse).all() else None


def _clusters(poles: np.ndarray, radii: np.ndarray) -> list[PoleCluster]:
    """Join the discs that meet: a union of k discs apart from the others holds k eigenvalues."""
    meet = np.abs(poles[:, None] - poles[None, :]) <= radii[:, None] + radii[None, :]
    for _ in range(len(poles)):  # transitive closure
        meet = meet @ meet
    groups = {tuple(np.flatnonzero(row)) for row in meet}
    clusters = []
    for group in groups:
        members = poles[list(group)]
        centre = complex(members.mean())
        radius = float((np.abs(members - centre) + radii[list(group)]).max())
        clusters.append(PoleCluster(centre, radius, len(group)))
    return sorted(clusters, key=lambda cluster: (cluster.centre.real, cluster.centre.imag))


def match_poles(published: Sequence[complex], clusters: Sequence[PoleCluster]) -> list[PoleCluster]:
    """Return the cluster that belongs to each published pole: the matching with the least sum of distances.

    Parameters
    ----------
    published : sequence of complex
        At most as many as there are poles, 1/s; a multiple pole stands as often as it is meant.
    clusters : sequence of PoleCluster
        From `pole_clusters`.

    Returns
    -------
    list of PoleCluster
        In the order of `published`.

    Raises
    ------
    InputError
        If more poles are published than there are.
    """
    slots = [cluster for cluster in clusters for _ in range(cluster.count)]
    if len(published) > len(slots):
        raise InputError("published poles", value=len(published), expected=f"at most {len(slots)}")
    wanted = np.asarray(published, dtype=complex)
    centres = np.array([slot.centre for slot in slots])
    _, chosen = linear_sum_assignment(np.abs(wanted[:, None] - centres[None, :]))
    return [slots[k] for k in chosen]
