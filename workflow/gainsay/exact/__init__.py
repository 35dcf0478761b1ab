"""Exact rationals, balls and intervals of printed digits: the ground floor.

The modules are imported by name where they are needed: `gainsay.exact.rational` (text, `Fraction`, short rationals),
`gainsay.exact.matrix` (matrices over rationals, balls and polynomials), `gainsay.exact.definite` (definiteness, exact
and in balls), `gainsay.exact.ball` (enclosures), `gainsay.exact.linear` (exact projections onto affine subspaces),
`gainsay.exact.floats` (doubles from outside).
"""

from gainsay.exact.digits import PrintedNumber

__all__ = ["PrintedNumber"]
