"""Structured uncertainty: multipliers of the blocks of a linear fractional transformation.

The uncertain system is x' = A x + H w + B d, z = Cz x + Dw w + Dd d, w = Delta z, with Delta block diagonal. A block
is ``["repeated", q]``: a real number lambda, |lambda| <= 1, times the identity of size q, with multipliers D >= 0
(symmetric) and G (skew, may be left out); or ``["full", p, q]``: any real p x q matrix of norm at most one, with a
multiplier d >= 0. With M the quadratic form of these multipliers, [z; w]' M [z; w] >= 0 whenever w = Delta z.

Reference: M. K. H. Fan, A. L. Tits, J. C. Doyle, "Robustness in the presence of mixed parametric uncertainty and
unmodeled dynamics", IEEE Transactions on Automatic Control 36 (1991) 25-38; Boyd et al. 1994, section 5.1.
"""

from dataclasses import dataclass

from gainsay.exact.blocks import block, diagonal
from gainsay.exact.matrix import Matrix, eye, zeros
from gainsay.proof.inequalities import demand, sym
from gainsay.proof.scope import Scope

__all__ = ["Lft", "read_lft"]

FIELDS = ("H", "Cz", "blocks", "Dw", "Dd")


@dataclass(frozen=True)
class Lft:
    """Uncertainty channels with their multipliers.

    Attributes
    ----------
    h : Matrix, shape (n, p)
    cz : Matrix, shape (q, n)
    dw : Matrix, shape (q, p)
    dz, dd, g : Matrix
        Multipliers: of z (q, q), of w (p, p), and the skew ones (q, p).
    feedthrough : bool
        Whether dw was given: then only a strict inequality shows the interconnection well posed.
    """

    h: Matrix
    cz: Matrix
    dw: Matrix
    dz: Matrix
    dd: Matrix
    g: Matrix
    feedthrough: bool

    def form(self, z: Matrix, w: Matrix) -> Matrix:
        """Quadratic form z' D z - w' D w + 2 z' G w of the multipliers, z and w given as rows over common variables."""
        return z.T @ self.dz @ z - w.T @ self.dd @ w + sym(z.T @ self.g @ w)


def read_lft(scope: Scope, size: int) -> Lft:
    """Channels of the fields ``H``, ``Cz``, ``blocks``, ``Dw`` and multipliers ``D1``, ``G1``, ... of the witness."""
    h, cz = scope.evaluate(scope.field("H")), scope.evaluate(scope.field("Cz"))
    of_z: list[Matrix] = []
    of_w: list[Matrix] = []
    skew: list[Matrix] = []
    blocks = scope.field("blocks")
    if not isinstance(blocks, list) or not blocks:
        raise scope.fail('field \'blocks\': expected ["repeated", q] or ["full", p, q] for each block')
    if any(isinstance(x, bool) for entry in blocks if isinstance(entry, list) for x in entry):
        raise scope.fail("field 'blocks': sizes are integers")
    for number, entry in enumerate(blocks, 1):
        match entry:
            case ["repeated", int(q)] if q > 0:
                d = scope.symmetric_witness(f"D{number}", q)
                demand(scope, d, ">=", f"D{number}")
                g = zeros(q, q)
                if f"G{number}" in scope.certificate.witness:
                    g = scope.witness(f"G{number}", (q, q))
                    if not g.equals(-g.T):
                        raise scope.fail(f"witness 'G{number}' is not skew")
                left, right = d, d
            case ["full", int(p), int(q)] if p > 0 and q > 0:
                d = scope.witness(f"D{number}", (1, 1))
                demand(scope, d, ">=", f"D{number}")
                left, right, g = eye(q).scaled(d), eye(p).scaled(d), zeros(q, p)
            case _:
                raise scope.fail(f"block {number}: expected ['repeated', q] or ['full', p, q], found {entry!r}")
        of_z.append(left)
        of_w.append(right)
        skew.append(g)
    dz, dd = diagonal(of_z), diagonal(of_w)
    g = block(
        [[m if i == j else zeros(m.shape[0], k.shape[1]) for j, k in enumerate(skew)] for i, m in enumerate(skew)]
    )
    if h.shape != (size, dd.shape[0]) or cz.shape != (dz.shape[0], size):
        raise scope.fail(
            f"H and Cz have shapes {h.shape}, {cz.shape}; {(size, dd.shape[0])}, {(dz.shape[0], size)} expected"
        )
    given = "Dw" in scope.certificate.fields
    dw = scope.evaluate(scope.field("Dw")) if given else zeros(cz.shape[0], h.shape[1])
    return Lft(h, cz, dw, dz, dd, g, given)
