"""A loop with constant delays, one or several, commensurate or not: stable, unstable, its norm below a level.

Theorem: let x' = A x + sum_k Ad_k x(t - d_k) + B w, y = C x + D w, and M(s) = s I - A - sum_k Ad_k exp(-s d_k). The
loop is exponentially stable if and only if M is regular wherever Re s >= 0; there M is regular beyond |s| = r, r the
Perron root of |A| + sum_k |Ad_k|. The number N of its roots with Re s > 0 follows from how far det M turns along the
imaginary axis (the argument principle), and it is the same for all loops of a connected set of which none has a root
on the axis. It is counted for one of them, piece by piece of the axis, and the axis and what varies are covered by
boxes on each of which M is regular: nothing is sampled (`gainsay.proof.delayed`). With inputs and outputs each box has
also no singular value of C M(i w)^-1 B + D that reaches gamma.

A delay is a formula, or a pair of formulas, the ends of its range, s; the ranges are independent. With ``scale`` the
delays are these times any common factor from 0 to it, so that it is a lower bound on the delay margin along these
proportions. Data in balls (``box``, ``interval``) stand for every constant value.

Fields: ``A``, ``delayed`` (list of formulas Ad_k), ``delays`` (as many), ``scale``; for a norm ``B``, ``C``, ``gamma``
and ``D``, which may be left out. No witness.
Reference: G. Stepan, Retarded Dynamical Systems: Stability and Characteristic Functions, Longman 1989, chapter 2.
"""

from flint import acb_mat, fmpq

from gainsay.exact.matrix import Matrix, zeros
from gainsay.exact.rational import to_fmpq, to_text
from gainsay.proof.delayed import DelayedLoop, NotSettled, Range
from gainsay.proof.kinds import Proved
from gainsay.proof.scope import Scope

THEOREM = "the argument principle for a retarded equation, the imaginary axis covered in balls"
REQUIRED = ("A", "delayed", "delays")
OPTIONAL = ("scale", "B", "C", "D", "gamma")
LEVELS = ("scale", "gamma")
FOUND = ()


def prove(scope: Scope) -> list[Proved]:
    """Prove stability with the norm, or instability."""
    scope.fields_fit(("gamma", "B", "C", ("D",)))
    scope.define()
    loop, scale = read_loop(scope)
    try:
        unstable = loop.roots_right() > 0
        if unstable and "gamma" in scope.certificate.fields:
            raise scope.fail("the loop is unstable: it has no norm")
        if "gamma" in scope.certificate.fields:
            return [*_stable(scale), _norm(scope, loop)]
        if loop.varies:
            loop.keeps_off()
    except NotSettled as error:
        raise scope.fail(error) from error
    return [Proved("stable", "fails")] if unstable else _stable(scale)


def _stable(scale: fmpq | None) -> list[Proved]:
    proofs = [Proved("stable", "holds")]
    return proofs if scale is None else [*proofs, Proved("scale", "at_least", to_text(scale))]


def read_loop(scope: Scope) -> tuple[DelayedLoop, fmpq | None]:
    """The loop of the fields, and the largest factor of its delays where one is given."""
    late = [scope.evaluate(text) for text in _texts(scope, "delayed")]
    listed = scope.field("delays")
    if not isinstance(listed, list) or len(listed) != len(late):
        raise scope.fail("field 'delays': expected a delay for each matrix of 'delayed'")
    undelayed = scope.evaluate(scope.field("A"))
    size = undelayed.shape[0]
    if any(part.shape != (size, size) for part in (undelayed, *late)):
        raise scope.fail("A and the matrices of 'delayed' must be square and of one size")
    scale = None
    if "scale" in scope.certificate.fields:
        scale = to_fmpq(scope.number(scope.field("scale")))
        if scale < 0:
            raise scope.fail("field 'scale' must not be negative")
    factor = Range(fmpq(1), fmpq(1)) if scale is None else Range(fmpq(0), scale)
    loop = DelayedLoop(_balls(undelayed), tuple(map(_balls, late)), factor, tuple(_range(scope, d) for d in listed))
    return loop, scale


def _texts(scope: Scope, name: str) -> list[str]:
    listed = scope.field(name)
    if not isinstance(listed, list) or not listed or any(not isinstance(text, str) for text in listed):
        raise scope.fail(f"field {name!r}: expected a list of formulas")
    return listed


def _range(scope: Scope, given: object) -> Range:
    """A delay, or the range of one."""
    ends = given if isinstance(given, list) else [given, given]
    if len(ends) != 2 or any(not isinstance(text, str) for text in ends):
        raise scope.fail("field 'delays': expected formulas, or pairs of them")
    low, high = (to_fmpq(scope.number(text)) for text in ends)
    if not 0 <= low <= high:
        raise scope.fail("field 'delays': expected times that are not negative, the least of a range first")
    return Range(low, high)


def _balls(matrix: Matrix) -> acb_mat:
    return acb_mat(matrix.to_ball().data)


def _norm(scope: Scope, loop: DelayedLoop) -> Proved:
    """Prove the norm of every loop, and that none has a root on the axis."""
    gamma = scope.number(scope.field("gamma"))
    if gamma <= 0:
        raise scope.fail("field 'gamma' must be positive")
    b, c = scope.evaluate(scope.field("B")), scope.evaluate(scope.field("C"))
    shape = c.shape[0], b.shape[1]
    d = scope.evaluate(scope.field("D")) if "D" in scope.certificate.fields else zeros(*shape)
    if b.shape[0] != loop.order or c.shape[1] != loop.order or d.shape != shape:
        raise scope.fail(f"B, C and D have shapes {b.shape}, {c.shape}, {d.shape}: they do not fit {loop.order} states")
    loop.stays_below(to_fmpq(gamma), _balls(b), _balls(c), _balls(d))
    return Proved("norm", "less_than", to_text(gamma))
