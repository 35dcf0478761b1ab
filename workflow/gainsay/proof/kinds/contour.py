"""Every eigenvalue of an uncertain matrix lies in a disk or a half plane, for constant uncertainty, arc by arc.

Theorem: let A(Delta) = A + H Delta (I - Dw Delta)^-1 Cz, Delta = diag of blocks as in `gainsay.proof.lft`, constant.
Suppose the eigenvalues of A lie in the open region, and for every point s of its boundary there are numbers d_k > 0 and
g_k (g_k = 0 for full blocks) such that, with M(s) = Cz (s I - A)^-1 H + Dw, D and G the diagonal matrices of d_k, g_k,

    D - M(s)* D M(s) - i (G M(s) - M(s)* G) > 0,     and once     D - Dw' D Dw > 0.

Then every eigenvalue of every A(Delta) lies in the region. (w = Delta z and z = M w with w != 0 contradict the first
inequality, since z* D z >= w* D w and w* G z is real; so no eigenvalue of A(t Delta), 0 <= t <= 1, meets the boundary.)
With an input B, an output C and a level gamma (region: the left half plane, alpha = 0), the same form on (w, d) with
gamma^2 |d|^2 - |y|^2 added, > 0 on the whole axis, proves that the H-infinity norm is below gamma for each Delta.

The boundary is s = -a + b exp(i pi t), or s = alpha + i w0 tan(pi t / 2), 0 <= t <= 1: its upper half, which is enough
since the data are real. Nothing is sampled: each piece of an arc is settled as a whole, and cut in two where that does
not do. Over a piece M lies within h^2/8 max |M''| of the chord between its values at the ends, h the length in t; on
the chord the form, which is concave in M, is no smaller than at the worse end; so it is enough that the form at both
ends exceeds what that distance can take away. With s = u / v, K = u I - v A, w = v' u - v u' and a dash for d/dt,

    M = v Cz K^-1 H + Dw,     M' = w Cz K^-2 H,     |K'| <= |u'| + |v'| |A|,     K^-1 = K0^-1 (I + (K - K0) K0^-1)^-1,

and all norms are taken in the coordinates of P and of the multipliers.

Fields: ``A``, ``H``, ``Cz``, ``Dw``, ``blocks``, ``arcs`` (their ends in t, increasing from 0 to 1); ``shift`` (a)
and ``radius`` (b), or ``alpha`` and ``scale`` (w0); and for a norm ``B``, ``C``, ``D``, ``Dd``, ``Ew``, ``gamma``.
Witness: ``P`` (Stein or Lyapunov for A), ``d`` (a row for each arc, a column for each block), and ``g`` (likewise).
Reference: M. K. H. Fan, A. L. Tits, J. C. Doyle, "Robustness in the presence of mixed parametric uncertainty and
unmodeled dynamics", IEEE Transactions on Automatic Control 36 (1991) 25-38.
"""

from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import pairwise

from flint import acb, acb_mat, arb, ctx, fmpq

from gainsay.exact.blocks import block, diagonal
from gainsay.exact.budget import multiply_cost, spend
from gainsay.exact.definite import cholesky_factor, hermitian_positive_definite
from gainsay.exact.matrix import Matrix, eye, zeros
from gainsay.exact.rational import to_fmpq, to_text
from gainsay.proof.inequalities import demand, sym
from gainsay.proof.kinds import Proved
from gainsay.proof.scope import Scope

THEOREM = "mixed structured singular value bound on the whole boundary, checked arc by arc in balls"
REQUIRED = ("A", "H", "Cz", "blocks", "arcs")
OPTIONAL = ("Dw", "shift", "radius", "alpha", "scale", "B", "C", "D", "Dd", "Ew", "gamma")
LEVELS = ("alpha", "radius", "gamma")
FOUND = ("arcs", "scale")
_DEPTH, _MOST_ARCS = 16, 2000
_LONGER = 4  # pieces of one length proved in a row after which the double length is tried


@dataclass(frozen=True)
class _Plant:
    """Transfer matrix from (w, d) to (z, y) in balls, in the coordinates of P, and the boundary."""

    a: acb_mat
    inputs: acb_mat
    outputs: acb_mat
    through: acb_mat
    centre: arb
    radius: arb
    disk: bool

    def point(self, t: Fraction) -> tuple[acb, arb]:
        """Return u and v at a place of the boundary."""
        angle = self.turn * arb(to_fmpq(t))
        if self.disk:
            return acb(self.centre + self.radius * angle.cos(), self.radius * angle.sin()), arb(1)
        return acb(self.centre * angle.cos(), self.radius * angle.sin()), angle.cos()

    @property
    def turn(self) -> arb:
        """Change of the angle with t."""
        return arb.pi() * (1 if self.disk else fmpq(1, 2))

    @cached_property
    def rates(self) -> tuple[arb, arb, arb]:
        """Upper bounds on |w|, |w'| and |K'| with t."""
        speed = (self.turn * self.radius).upper()
        if self.disk:
            return speed, (self.turn * speed).upper(), speed
        return speed, arb(0), (self.turn * (abs(self.centre) + self.radius + norm(self.a))).upper()


def adjoint(matrix: acb_mat) -> acb_mat:
    """Conjugate transpose."""
    return matrix.conjugate().transpose()


def largest(*grams: acb_mat) -> arb:
    """Upper bound on the largest eigenvalue of a product of one or two positive semidefinite Hermitian matrices.

    The eigenvalues of such a product are real and not negative, so the largest is at most the fourth root of the sum
    of their fourth powers, the trace of the fourth power.
    """
    product = grams[0] if len(grams) == 1 else grams[0] * grams[1]
    square = product * product
    rows, columns = square.entries(), square.transpose().entries()
    count = len(rows)
    trace = (acb_mat(1, count, rows) * acb_mat(count, 1, columns))[0, 0].real
    return trace.upper().max(arb(0)).root(4).upper()


def norm(matrix: acb_mat) -> arb:
    """Upper bound on the largest singular value."""
    tall = matrix.nrows() >= matrix.ncols()
    return largest(adjoint(matrix) * matrix if tall else matrix * adjoint(matrix)).sqrt().upper()


def _sizes(scope: Scope) -> list[tuple[int, int, bool]]:
    """Rows in w, rows in z, and whether g may differ from zero, of each block."""
    result = []
    for entry in scope.field("blocks"):
        if isinstance(entry, list) and any(isinstance(x, bool) for x in entry):
            raise scope.fail("field 'blocks': sizes are integers")
        match entry:
            case ["repeated", int(q)] if q > 0:
                result.append((q, q, True))
            case ["full", int(p), int(q)] if p > 0 and q > 0:
                result.append((p, q, False))
            case _:
                raise scope.fail(f"block {entry!r}: expected ['repeated', q] or ['full', p, q]")
    return result


def _multipliers(scope: Scope, arcs: int, sizes: list[tuple[int, int, bool]]) -> list[tuple[list[fmpq], list[fmpq]]]:
    d = scope.witness("d", (arcs, len(sizes))).rows()
    given = "g" in scope.certificate.witness
    g = scope.witness("g", (arcs, len(sizes))).rows() if given else [[fmpq(0)] * len(sizes) for _ in range(arcs)]
    if any(x <= 0 for row in d for x in row):
        raise scope.fail("witness 'd' must be positive")
    if any(row[k] != 0 for row in g for k, (_, _, real) in enumerate(sizes) if not real):
        raise scope.fail("witness 'g' must be zero for full blocks")
    return list(zip(d, g, strict=True))


def _spread(values: list[fmpq], counts: list[int]) -> list[arb]:
    return [arb(value) for value, count in zip(values, counts, strict=True) for _ in range(count)]


def _diagonal(values: list[arb]) -> acb_mat:
    return acb_mat([[x if i == j else 0 for j in range(len(values))] for i, x in enumerate(values)])


def _root(gram: acb_mat) -> acb_mat:
    """R near the root of a real positive semidefinite matrix, with R' R no smaller.

    Raises
    ------
    ArithmeticError
        If none is found at the precision in force.
    """
    count = gram.nrows()
    room = sum((gram[i, i].real for i in range(count)), arb(0)).upper() * arb(2) ** (-ctx.prec // 2)
    lifted = gram + _diagonal([room] * count)
    root = acb_mat(cholesky_factor(lifted.real))
    if not norm(adjoint(root) * root - lifted) < room:
        raise ArithmeticError("no root at this precision")
    return root


class _Arc:
    """The multipliers of one arc, and the form that must be positive on it.

    With weights of (w, d) and of (z, y) made one by scaling, the form is I - N* N - i (S N - N* S*), N the scaled
    transfer matrix, S the scaled G (from z to w).
    """

    def __init__(self, plant: _Plant, d: list[fmpq], g: list[fmpq], sizes: list, ports: tuple[int, int, fmpq]) -> None:
        inputs, outputs, level = ports
        of_w = _spread([*d, level], [*(p for p, _, _ in sizes), inputs])
        of_z = _spread([*d, fmpq(1)], [*(q for _, q, _ in sizes), outputs])
        self.plant = plant
        self.inputs = plant.inputs * _diagonal([x.rsqrt() for x in of_w])
        self.outputs = _diagonal([x.sqrt() for x in of_z]) * plant.outputs
        self.through = _diagonal([x.sqrt() for x in of_z]) * plant.through * _diagonal([x.rsqrt() for x in of_w])
        self.unit = _diagonal([arb(1)] * plant.a.nrows())
        self.skew: acb_mat | None = None
        self.steepness = arb(1)
        self.inverses: dict[Fraction, tuple[acb_mat, arb]] = {}
        self.known: dict[Fraction, tuple[acb_mat, acb_mat]] = {}
        self.exceeded: dict[Fraction, arb] = {}
        if any(x != 0 for x in g):
            grid = [[acb(0)] * len(of_z) for _ in of_w]
            row = column = 0
            for k, (p, q, _) in enumerate(sizes):
                for i in range(min(p, q)):
                    grid[row + i][column + i] = acb(arb(g[k] / d[k]))
                row, column = row + p, column + q
            self.skew = acb_mat(grid)
            self.steepness = arb(max(abs(x / y) for x, y in zip(g, d, strict=True)))
        else:
            self._narrow()
        self.form_unit = _diagonal([arb(1)] * self.inputs.ncols())

    def _narrow(self) -> None:
        """Take fewer inputs and outputs with which N is nowhere smaller: the form I - N* N asks for its size alone.

        N = X diag(v K^-1, I) Y, where Y has the inputs and the rows of the feedthrough that are not zero; so N is no
        larger than with R and L' in the places of X and Y, where R' R >= X' X and L' L >= Y Y'.
        """
        through = self.through.tolist()
        rows = [k for k, row in enumerate(through) if any(x != 0 for x in row)]
        n, size = self.plant.a.nrows(), self.plant.a.nrows() + len(rows)
        if size >= min(len(through), len(through[0])):
            return
        left = [[*row, *(acb(int(i == k)) for k in rows)] for i, row in enumerate(self.outputs.tolist())]
        right = acb_mat([*self.inputs.tolist(), *(through[k] for k in rows)])
        try:
            of_left, of_right = _root(adjoint(acb_mat(left)) * acb_mat(left)), _root(right * adjoint(right))
        except ArithmeticError:  # too few bits for it
            return
        outer, inner = of_left.tolist(), adjoint(of_right).tolist()
        self.outputs, self.inputs = acb_mat([row[:n] for row in outer]), acb_mat(inner[:n])
        self.through = acb_mat(size, size)
        if rows:
            self.through = acb_mat([row[n:] for row in outer]) * acb_mat(inner[n:])

    def settled(self, low: Fraction, high: Fraction, depth: int = 0) -> int | None:
        """Prove the form positive from low to high by pieces, each a dyadic part of the whole.

        Parameters
        ----------
        low, high : Fraction
        depth : int, optional
            Pieces tried first are 2^-depth of the whole; where that is too long a half is tried, and after a few that
            were proved the double.

        Returns
        -------
        int or None
            Depth of the last piece; None where a piece of the least length is not proved.
        """
        place = proved = 0  # pieces before this one, were all as long; pieces proved since the length changed
        while place < 1 << depth:
            length = (high - low) / (1 << depth)
            if self._whole(low + place * length, low + (place + 1) * length):
                place, proved = place + 1, proved + 1
                if proved >= _LONGER and depth and place % 2 == 0:
                    place, depth, proved = place // 2, depth - 1, 0
            elif depth == _DEPTH:
                return None
            else:
                place, depth, proved = 2 * place, depth + 1, 0
        return depth

    def _whole(self, low: Fraction, high: Fraction) -> bool:
        rows = self.plant.a.nrows() + self.form_unit.nrows()
        spend(30_000 + (60 + multiply_cost(ctx.prec, ctx.prec)) * rows**3, "a piece of an arc")
        try:
            distance = self._from_chord(low, high)
            if distance is None:
                return False
            # without G the form at the ends must be positive, so |N| < 1 there and on the chord
            size = arb(1) if self.skew is None else self._size(low).max(self._size(high)) + self.steepness
            loss = (2 * size * distance + distance * distance).upper()
            return self._exceeds(low, loss) and self._exceeds(high, loss)
        except ZeroDivisionError:
            return False

    def _from_chord(self, low: Fraction, high: Fraction) -> arb | None:
        """Upper bound on the distance of N from its chord over a piece; None where the piece is too long for one."""
        speed, bend, change = self.plant.rates
        length = arb(to_fmpq(high - low))
        inverse = self._inverse((low + high) / 2)[0]
        left, right = self.outputs * inverse, inverse * self.inputs
        of_inverse = norm(inverse)
        rest = 1 - of_inverse * change * length / 2
        if not rest > 0:
            return None
        ends = (largest(adjoint(left) * left) * largest(right * adjoint(right))).sqrt()
        curvature = ends / rest**2 * (bend + 2 * speed * change * of_inverse / rest)
        return (length * length / 8 * curvature).upper()

    def _inverse(self, t: Fraction) -> tuple[acb_mat, arb]:
        """K^-1 and v at a place, kept: a piece is cut in the middle; ZeroDivisionError where K may be singular."""
        if t not in self.inverses:
            u, v = self.plant.point(t)
            self.inverses[t] = (self.unit * u - self.plant.a * v).inv(), v
        return self.inverses[t]

    def _at(self, t: Fraction) -> tuple[acb_mat, acb_mat]:
        """N and the form at a place, kept: it is the end of two pieces."""
        if t not in self.known:
            inverse, v = self._inverse(t)
            n = self.outputs * inverse * self.inputs * v + self.through
            form = self.form_unit - adjoint(n) * n
            if self.skew is not None:
                turned = self.skew * n
                form = form - (turned - adjoint(turned)) * acb(0, 1)
            self.known[t] = n, form
        return self.known[t]

    def _size(self, t: Fraction) -> arb:
        return norm(self._at(t)[0])

    def _exceeds(self, t: Fraction, loss: arb) -> bool:
        """Prove that the form at a place is greater than a number; what was proved of it before is not proved again."""
        if t in self.exceeded and loss <= self.exceeded[t]:
            return True
        holds = hermitian_positive_definite(self._at(t)[1] - self.form_unit * loss)
        if holds:
            self.exceeded[t] = loss
        return holds


def _plant(p: Matrix, system: tuple[Matrix, ...], centre: arb, radius: arb, disk: bool) -> _Plant:
    """The system in the coordinates in which P is nearly the identity."""
    change = cholesky_factor(p.data)
    a, inputs, outputs, through = (m.to_ball().data for m in system)
    back = change.inv()
    return _Plant(
        acb_mat(change * a * back),
        acb_mat(change * inputs),
        acb_mat(outputs * back),
        acb_mat(through),
        centre,
        radius,
        disk,
    )


def prove(scope: Scope) -> list[Proved]:
    """Prove the region, and the norm where one is asked for."""
    fields = scope.certificate.fields
    scope.fields_fit(("shift", "radius"), ("alpha", "scale"), ("gamma", "B", "C", ("D", "Dd", "Ew")))
    if ("radius" in fields) == ("alpha" in fields):
        raise scope.fail("expected a disk (shift and radius) or a half plane (alpha and scale)")
    scope.define()
    a, h, cz = (scope.evaluate(scope.field(name)) for name in ("A", "H", "Cz"))
    n = a.shape[0]
    sizes = _sizes(scope)
    p, q = sum(s[0] for s in sizes), sum(s[1] for s in sizes)
    if h.shape != (n, p) or cz.shape != (q, n):
        raise scope.fail(f"H and Cz have shapes {h.shape}, {cz.shape}; {(n, p)}, {(q, n)} expected")

    def given(name: str, rows: int, columns: int) -> Matrix:
        return scope.evaluate(scope.field(name)) if name in fields else zeros(rows, columns)

    dw = given("Dw", q, p)
    disk = "radius" in fields
    lyapunov = scope.symmetric_witness("P", n)
    demand(scope, lyapunov, ">", "P")
    if disk:
        shift, radius = scope.number(scope.field("shift")), scope.number(scope.field("radius"))
        moved = a + eye(n).scaled(Matrix.number(shift))
        form = moved.T @ lyapunov @ moved - lyapunov.scaled(Matrix.number(radius**2))
        centre = -shift
    else:
        centre, radius = scope.number(scope.field("alpha")), scope.number(scope.field("scale"))
        form = sym(lyapunov @ a) - lyapunov.scaled(Matrix.number(2 * centre))
    if radius <= 0:
        raise scope.fail("radius and scale must be positive")
    demand(scope, form, "<", "the nominal inequality of P")

    inputs = outputs = 0
    level = fmpq(0)
    gamma = None
    into, out, through = h, cz, dw
    if "gamma" in fields:
        if disk or centre != 0:
            raise scope.fail("a norm needs the left half plane, alpha = 0")
        gamma = scope.number(scope.field("gamma"))
        b, c = scope.evaluate(scope.field("B")), scope.evaluate(scope.field("C"))
        inputs, outputs, level = b.shape[1], c.shape[0], to_fmpq(gamma**2)
        into, out = block([[h, b]]), block([[cz], [c]])
        through = block([[dw, given("Dd", q, inputs)], [given("Ew", outputs, p), given("D", outputs, inputs)]])
        if gamma <= 0:
            raise scope.fail("field 'gamma' must be positive")

    listed = scope.field("arcs")
    if not isinstance(listed, list) or len(listed) > _MOST_ARCS:
        raise scope.fail(f"field 'arcs': expected a list of at most {_MOST_ARCS} numbers")
    ends = [scope.number(t) for t in listed]
    if len(ends) < 2 or ends[0] != 0 or ends[-1] != 1 or any(x >= y for x, y in pairwise(ends)):
        raise scope.fail("field 'arcs': expected numbers increasing from 0 to 1")
    rows = _multipliers(scope, len(ends) - 1, sizes)
    first = rows[0][0]
    of_w = diagonal([eye(s[0]).scaled(Matrix.number(x)) for s, x in zip(sizes, first, strict=True)])
    of_z = diagonal([eye(s[1]).scaled(Matrix.number(x)) for s, x in zip(sizes, first, strict=True)])
    demand(scope, of_w - dw.T @ of_z @ dw, ">", "D - Dw' D Dw")
    plant = _plant(lyapunov, (a, into, out, through), arb(to_fmpq(centre)), arb(to_fmpq(radius)), disk)
    depth = 0  # arcs one after the other are cut alike
    for number, (low, high, (d, g)) in enumerate(zip(ends[:-1], ends[1:], rows, strict=True), 1):
        spend(100_000, "an arc")
        reached = _Arc(plant, d, g, sizes, (inputs, outputs, level)).settled(low, high, depth)
        if reached is None:
            raise scope.fail(f"arc {number}, t from {to_text(low)} to {to_text(high)}, is not proved")
        depth = reached
    if disk:
        result = [Proved("radius", "less_than", to_text(radius))]
        return [*result, Proved("stable", "holds")] if radius <= -centre else result
    result = [Proved("abscissa", "less_than", to_text(centre))]
    if centre <= 0:
        result.append(Proved("stable", "holds"))
    return result if gamma is None else [*result, Proved("norm", "less_than", to_text(gamma))]
