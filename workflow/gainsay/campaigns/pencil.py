"""Disk of a loop proved over boxes of uncertain numbers of which a pencil of its matrices is affine.

A loop E x' = A x is given by formulas over the tables. What the kind ``descriptor_disk`` of proofs asks at the corners
of a box is asked here in floating point first, with a bound on rounding, and a point that violates is found by disks
that hold the eigenvalues; certificates are of the same formulas.
"""

from collections.abc import Iterable, Mapping, Sequence
from itertools import product
from typing import Any

import numpy as np
from scipy.linalg import solve_discrete_lyapunov

from gainsay.errors import CertificateError
from gainsay.lmi.rounding import gamma, proved_positive
from gainsay.proof import Certificate, build
from gainsay.systems import loop_proofs
from gainsay.systems.enclosed_spectra import OUTSIDE, resolved
from gainsay.tables import Case

#: relative size of what rounding leaves out of sums of products of doubles nearest to exact numbers, with room
_ROUNDING = gamma(100)
#: search of P: rounds, weight of the steps against the loop, part kept of the matrix before
_ROUNDS, _WEIGHT, _FLOOR = 30, 8.0, 1e-3
#: where between the poles and the border of the disk the disks of the other matrices lie
_PARTS = (0.4, 0.7)
#: digits that witnesses are rounded to, more where fewer are refused
_DIGITS = (6, 9, 12, 15)


class PencilBox:
    """That every pole of E x' = A x lies in a disk: a property for `gainsay.campaigns.box.over_boxes`.

    Parameters
    ----------
    case : Case
    inputs : sequence of str
        Uncertain numbers; E and A are affine in all of them together, with no products among them.
    matrix, descriptor : str
        Formulas of A and E over the definitions and the inputs.
    shift, radius : str
        Formulas: the disk is |s + shift| < radius, 1/s.
    definitions : pairs of str
    sentence : str
        The property, for people.
    """

    def __init__(
        self,
        case: Case,
        inputs: Sequence[str],
        matrix: str,
        descriptor: str,
        shift: str,
        radius: str,
        definitions: Iterable[tuple[str, str]],
        sentence: str,
    ) -> None:
        self.case, self.inputs, self.definitions, self.sentence = case, tuple(inputs), tuple(definitions), sentence
        self.fields = {"matrix": matrix, "descriptor": descriptor, "shift": shift, "radius": radius}
        unit = np.eye(len(self.inputs), dtype=int)
        of = [self._values(dict(zip(self.inputs, map(str, point), strict=True))) for point in (0 * unit[0], *unit)]
        self.A, self.E = of[0][0], of[0][1]
        self.shift, self.radius = of[0][2].item(), of[0][3].item()
        self.slopes_A, self.slopes_E = (np.array([one[k] - of[0][k] for one in of[1:]]) for k in (0, 1))
        # of what the doubles nearest to an entry, and to its slopes, may be off
        self.sizes_A, self.sizes_E = (np.array([np.abs(one[k]) + np.abs(of[0][k]) for one in of[1:]]) for k in (0, 1))
        self.corners = np.array(list(product((False, True), repeat=len(self.inputs))))
        self.size = len(self.A)

    def _values(self, point: Mapping[str, str]) -> tuple[np.ndarray, ...]:
        texts = [self.fields[name] for name in ("matrix", "descriptor", "shift", "radius")]
        return loop_proofs.values(self.case, texts, [*point.items(), *self.definitions])

    def __call__(self, low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Outcome of each box: 1 proved inside the disk, -1 its middle proved outside, 0 neither; where to halve.

        A box is halved across the input that moves the loop most.
        """
        judgements = [self._judged(a, b) for a, b in zip(low, high, strict=True)]
        return np.array([outcome for outcome, _ in judgements]), np.array([axis for _, axis in judgements])

    def _judged(self, low: np.ndarray, high: np.ndarray) -> tuple[int, int]:
        inverse, loop, steps, error = self.at_middle(low, high)
        P, *others = self._candidates(loop, steps)
        T = np.linalg.cholesky(P).T
        axis = int(np.argmax(np.linalg.norm(T @ steps @ np.linalg.inv(T), axis=(-2, -1))))
        here = resolved(loop, lambda s: np.abs(s + self.shift) - self.radius, error)
        if here == OUTSIDE:
            return -1, axis
        return int(any(self.holds(low, high, one, inverse) for one in (P, *others))), axis

    def pencil(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """A and E at points of shape (..., number of inputs)."""
        return self.A + np.tensordot(points, self.slopes_A, 1), self.E + np.tensordot(points, self.slopes_E, 1)

    def sizes(self, reach: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Sizes of the terms of A and E where the inputs are as large as `reach`: times `_ROUNDING` their error."""
        both = (self.A, self.sizes_A), (self.E, self.sizes_E)
        of_A, of_E = (np.abs(at) + np.tensordot(np.abs(reach), sizes, 1) for at, sizes in both)
        return of_A, of_E

    def at_middle(self, low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Near inverse of E in the middle of a box, the loop there, its steps to first order, a bound on its error."""
        middle, half = (low + high) / 2, (high - low) / 2
        A, E = self.pencil(middle)
        inverse = np.linalg.inv(E)
        loop = inverse @ A
        steps = half[:, None, None] * (inverse @ (self.slopes_A - self.slopes_E @ loop))
        of_A, of_E = self.sizes(middle)
        # E^-1 is inverse (I + R + R^2 + ...) with R = I - E inverse
        defect = np.abs(np.eye(self.size) - E @ inverse) + _ROUNDING * (of_E @ np.abs(inverse) + np.eye(self.size))
        part = defect.sum(axis=1).max() * (1 + _ROUNDING)
        rest = defect + part**2 / (1 - part) if part < 0.5 else np.full_like(defect, np.inf)
        error = np.abs(inverse) @ rest @ of_A + _ROUNDING * np.abs(inverse) @ of_A
        return inverse, loop, steps, error * (1 + _ROUNDING) + 1e-290

    def _candidates(self, loop: np.ndarray, steps: np.ndarray) -> list[np.ndarray]:
        """Matrices P > 0 in whose norm the loop of the middle and its steps may be small together.

        The first is near the fixed point of A'PA + w sum S'PS, which a loop whose inputs were noise would have; the
        others are solutions of Stein's equation of the loop alone, for boxes so small that the steps say little. Any P
        would do: what is proved with it is proved.
        """
        moved = (loop + self.shift * np.eye(self.size)) / self.radius
        size = np.abs(np.diagonal(solve_discrete_lyapunov(moved, np.eye(self.size)))) + 1e-12
        P = start = np.diag(1 / size)
        for _ in range(_ROUNDS):
            following = moved.T @ P @ moved + _WEIGHT * np.einsum("kji,jl,klm->im", steps, P, steps, optimize=True)
            P = (following + following.T) / (2 * np.trace(following)) + _FLOOR * P
        reach = min(float(np.abs(np.linalg.eigvals(moved)).max()), 0.999)
        # Stein's equation for a disk between the poles and the border: what is left of it is for the steps
        alone = [solve_discrete_lyapunov(moved.T / (reach + part * (1 - reach)), start) for part in _PARTS]
        found = []
        for one in (P, *alone):
            one = (one + one.T) / 2 + 1e-9 * np.diag(np.abs(np.diagonal(one)))
            positive = np.linalg.eigvalsh(one / np.sqrt(np.outer(*2 * [np.abs(np.diagonal(one)) + 1e-300])))[0] > 1e-13
            found.append(one / np.trace(one) if positive else start / np.trace(start))
        return found

    def holds(self, low: np.ndarray, high: np.ndarray, P: np.ndarray, K: np.ndarray) -> bool:
        """Prove the form of ``descriptor_disk`` positive at every corner of a box, with bounds on rounding."""
        A, E = self.pencil(np.where(self.corners, high, low))
        of_A, of_E = self.sizes(np.maximum(np.abs(low), np.abs(high)))
        slack, of_slack = P @ K, np.abs(P) @ np.abs(K)
        cross, held = -slack @ (A + self.shift * E), slack @ E
        near = np.broadcast_to(self.radius**2 * P, A.shape)
        forms = np.block([[near, cross.transpose(0, 2, 1)], [cross, held + held.transpose(0, 2, 1) - P]])
        try:  # most that are not positive are so by far
            np.linalg.cholesky(forms)
        except np.linalg.LinAlgError:
            return False
        of_cross, of_held = of_slack @ (of_A + abs(self.shift) * of_E), of_slack @ of_E
        of_near = self.radius**2 * np.abs(P)
        error = np.block([[of_near, of_cross.T], [of_cross, of_held + of_held.T + np.abs(P)]])
        return all(proved_positive(form, _ROUNDING * error) for form in forms)

    def over(self, ranges: Sequence[Sequence[str]]) -> dict[str, Any]:
        """What a certificate states of a box, each input as its name and its ends as decimals."""
        box = ", ".join(f"{name} from {low} to {high}" for name, low, high in ranges)
        fields = {**self.fields, "ranges": [list(one) for one in ranges]}
        statement = f"{self.sentence}, for every {box}."
        return {
            "kind": "descriptor_disk", "statement": statement, "definitions": self.definitions, "fields": fields,
        }  # fmt: skip

    def at(self, point: Sequence[Sequence[str]]) -> dict[str, Any]:
        """What a certificate states of a point at which the property fails, each input as its name and a decimal."""
        where = ", ".join(f"{name} = {value}" for name, value in point)
        matrix = f"inverse({self.fields['descriptor']}) @ ({self.fields['matrix']})"
        fields = {"matrix": matrix, "shift": self.fields["shift"], "radius": self.fields["radius"]}
        definitions = (*map(tuple, point), *self.definitions)
        statement = f"It is false that {self.sentence}: not at {where}."
        return {"kind": "unstable", "statement": statement, "definitions": definitions, "fields": fields}

    def proof(self, name: str, ranges: Sequence[Sequence[str]]) -> Certificate:
        """Certify the property over a box.

        Raises
        ------
        CertificateError
            If no P that is tried is accepted.
        """
        low, high = (np.array([float(one[k]) for one in ranges]) for k in (1, 2))
        inverse, loop, steps, _ = self.at_middle(low, high)
        for P in self._candidates(loop, steps):
            if self.holds(low, high, P, inverse):
                witness = {"P": P / np.abs(P).max(), "K": inverse}
                return build.certificate(
                    id=name, tables=self.case, witness=witness, digits=_DIGITS, **self.over(ranges)
                )
        raise CertificateError(f"{name}: no P shows the disk over the box")

    def violation(self, name: str, point: Sequence[Sequence[str]]) -> Certificate:
        """Certify that the property fails at a point.

        Raises
        ------
        CertificateError
            If the checker does not accept it.
        """
        parts = self.at(point)
        fields, definitions = parts["fields"], parts["definitions"]
        return loop_proofs.pole_outside_disk(
            self.case, fields["matrix"], fields["shift"], fields["radius"], definitions=definitions, id=name,
            statement=parts["statement"],
        )  # fmt: skip
