"""Multipliers of constraints: the sum of inner products that Farkas proofs and dual bounds rest on."""

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

from flint import fmpq, fmpq_mpoly

from gainsay.exact.budget import multiply_cost, spend
from gainsay.exact.definite import positive_semidefinite
from gainsay.exact.matrix import BALL, Matrix
from gainsay.exact.rational import fraction_of
from gainsay.proof.scope import Scope, positions

__all__ = ["constraints", "greatest_over_boxes", "unknown_boxes", "weighted_sum"]


def constraints(scope: Scope) -> list[tuple[str, str]]:
    """Constraints of a certificate: pairs of a name and a text, the names all different."""
    raw = scope.field("constraints")
    if not isinstance(raw, list) or any(not isinstance(c, list | tuple) or len(c) != 2 for c in raw) or not raw:
        raise scope.fail("field 'constraints': expected pairs of a name and a constraint")
    listed = [(str(name), str(text)) for name, text in raw]
    if len({name for name, _ in listed}) != len(listed):
        raise scope.fail("two constraints of the same name")
    return listed


def weighted_sum(scope: Scope, elementwise: bool = False) -> tuple[Matrix, bool]:
    """Sum of <Z_k, T_k' F_k T_k> over the constraints F_k > 0, and whether it is strictly positive where they hold.

    The multipliers are the witness: Z_k >= 0 (any for an equation). T_k is the congruence of the constraint, the
    identity unless the field ``congruences`` names a formula, which may hold unknowns.
    """
    congruences: Mapping[str, str] = scope.certificate.fields.get("congruences", {})
    listed = constraints(scope)
    for name in (*scope.certificate.witness, *congruences):
        if name not in {known for known, _ in listed}:
            raise scope.fail(f"{name!r} is a multiplier or a congruence of no constraint")
    total, strict = Matrix.number(0), False
    for name, text in listed:
        if name not in scope.certificate.witness:
            continue
        form, relation = scope.constraint(text)
        if form.ring == BALL:
            raise scope.fail(f"constraint {name!r} is not exact: multipliers need rational data")
        if relation in ("<", "<="):
            form = -form
        if name in congruences:
            factor = scope.evaluate(congruences[name])
            form = factor.T @ form @ factor
        multiplier = scope.witness(name, form.shape)
        if relation != "==":
            if elementwise:
                accepted = all(x >= 0 for row in multiplier.rows() for x in row)
            else:
                if not form.equals(form.T):
                    raise scope.fail(f"constraint {name!r} is not symmetric")
                accepted = positive_semidefinite(multiplier.data)
            if not accepted:
                raise scope.fail(f"multiplier {name!r} >= 0 does not hold")
            nonzero = any(x != 0 for row in multiplier.rows() for x in row)
            strict = strict or (nonzero and relation in (">", "<") and name not in congruences)
        total = total + inner(multiplier, form)
    return total, strict


def inner(left: Matrix, right: Matrix) -> Matrix:
    """Sum of the products of entries, of which the left ones are rational."""
    pairs = [
        (weight, entry)
        for weights, line in zip(left.rows(), right.rows(), strict=True)
        for weight, entry in zip(weights, line, strict=True)
        if weight != 0 and entry != 0
    ]
    spend((5 * right.terms + 50 * len(pairs)) * multiply_cost(left.bits, right.bits), "a sum of products")
    return Matrix.number(sum((entry * weight for weight, entry in pairs), fmpq(0)))


def unknown_boxes(scope: Scope) -> dict[str, tuple[Fraction, Fraction]]:
    """Intervals of the indeterminates of unknowns that lie in a box of printed digits (field ``boxes``)."""
    result: dict[str, tuple[Fraction, Fraction]] = {}
    shapes = scope.unknown_shapes()
    boxes: Mapping[str, Any] = scope.certificate.fields.get("boxes", {})
    for name, printed in boxes.items():
        if name not in shapes:
            raise scope.fail(f"box of {name!r}, which is not an unknown")
        low, high = box_ends(scope, printed)
        (shape, structure) = shapes[name]
        if structure not in ("full", "symmetric"):
            raise scope.fail(f"box of {name!r}: its structure must be full or symmetric")
        if low.shape != shape:
            raise scope.fail(f"box of {name!r}: {printed!r} has shape {low.shape}, expected {shape}")
        for i, j in positions(shape, structure):
            ends = [(low.entry(i, j), high.entry(i, j))]
            if structure == "symmetric":
                ends.append((low.entry(j, i), high.entry(j, i)))
            result[f"{name}_{i}_{j}"] = (fraction_of(max(e[0] for e in ends)), fraction_of(min(e[1] for e in ends)))
    return result


def box_ends(scope: Scope, printed: str) -> tuple[Matrix, Matrix]:
    """Smallest and largest matrix that rounds to printed digits."""
    middle, half = scope.reader.printed(printed), scope.reader.half_units(printed)
    return middle - half, middle + half


def greatest_over_boxes(scope: Scope, value: Matrix, boxes: Mapping[str, tuple[Fraction, Fraction]]) -> Fraction:
    """Largest value of a polynomial over the boxes: it must be affine in the boxed entries and free of all others."""
    entry = value.entry(0, 0)
    if isinstance(entry, fmpq):
        return fraction_of(entry)
    assert isinstance(entry, fmpq_mpoly)
    variables = entry.context().names()
    total = Fraction(0)
    for exponents, coefficient in entry.to_dict().items():
        weight = fraction_of(coefficient)
        powers = [(variables[k], int(power)) for k, power in enumerate(exponents) if power]
        if not powers:
            total += weight
            continue
        if len(powers) > 1 or powers[0][1] != 1 or powers[0][0] not in boxes:
            term = "*".join(f"{n}**{p}" if p > 1 else n for n, p in powers)
            raise scope.fail(f"the weighted sum still holds {term}: the multipliers do not cancel it")
        low, high = boxes[powers[0][0]]
        if low > high:
            raise scope.fail(f"the box of {powers[0][0]} is empty")
        total += max(weight * low, weight * high)
    return total
