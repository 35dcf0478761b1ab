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
since the data are real. Between points nothing is sampled: each piece of an arc is checked as a whole in balls, and
bisected where that does not settle it.

Fields: ``A``, ``H``, ``Cz``, ``Dw``, ``blocks``, ``arcs`` (ends of the arcs in t, increasing from 0 to 1); ``shift`` (a)
and ``radius`` (b), or ``alpha`` and ``scale`` (w0); and for a norm ``B``, ``C``, ``D``, ``Dd``, ``Ew``, ``gamma``.
Witness: ``P`` (Stein or Lyapunov for A), ``d`` (a row for each arc, a column for each block), and ``g`` (likewise).
Reference: M. K. H. Fan, A. L. Tits, J. C. Doyle, "Robustness in the presence of mixed parametric uncertainty and
unmodeled dynamics", IEEE Transactions on Automatic Control 36 (1991) 25-38.
"""

from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise

from flint import acb, acb_mat, arb, arb_mat, fmpq

from gainsay.exact.ball import hull
from gainsay.exact.definite import ball_positive_definite
from gainsay.exact.matrix import Matrix, block, diagonal, eye, zeros
from gainsay.exact.rational import to_fmpq, to_text
from gainsay.proof.inequalities import demand, sym
from gainsay.proof.kinds import Proved
from gainsay.proof.scope import Scope

THEOREM = "mixed structured singular value bound on the whole boundary, checked arc by arc in balls"
REQUIRED = ("A", "H", "Cz", "blocks", "arcs")
OPTIONAL = ("Dw", "shift", "radius", "alpha", "scale", "B", "C", "D", "Dd", "Ew", "gamma")
_DEPTH = 14


@dataclass(frozen=True)
class _Plant:
    """Transfer matrix from (w, d) to (z, y) in balls, and the boundary."""

    a: acb_mat
    inputs: acb_mat
    outputs: acb_mat
    through: acb_mat
    centre: fmpq
    radius: fmpq
    disk: bool

    def transfer(self, low: Fraction, high: Fraction) -> acb_mat | None:
        """Enclosure over the arc from low to high; None where it is not finite."""
        angle = arb.pi() * hull(low, high)
        if self.disk:
            u = acb(arb(self.centre) + arb(self.radius) * angle.cos(), arb(self.radius) * angle.sin())
            v = acb(1)
        else:
            half = angle / 2
            u = acb(arb(self.centre) * half.cos(), arb(self.radius) * half.sin())
            v = acb(half.cos())
        size = self.a.nrows()
        unit = acb_mat([[int(i == j) for j in range(size)] for i in range(size)])
        shifted = unit * u - self.a * v
        try:
            near = shifted.mid().inv().mid()
            return self.outputs * (near * shifted).solve(near * self.inputs * v) + self.through
        except ZeroDivisionError:
            return None


def _sizes(scope: Scope) -> list[tuple[int, int, bool]]:
    """Rows in w, rows in z, and whether g may differ from zero, of each block."""
    result = []
    for entry in scope.field("blocks"):
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


def _spread(values: list[fmpq], counts: list[int]) -> arb_mat:
    flat = [arb(value) for value, count in zip(values, counts, strict=True) for _ in range(count)]
    return arb_mat([[x if i == j else arb(0) for j in range(len(flat))] for i, x in enumerate(flat)])


def _adjoint(matrix: acb_mat) -> acb_mat:
    return matrix.conjugate().transpose()


def _definite(form: acb_mat) -> bool:
    """Whether a Hermitian matrix in balls is proved positive definite: its real form of twice the size is."""
    size = form.nrows()
    entries = form.tolist()
    real, imaginary = ([[getattr(x, part) for x in row] for row in entries] for part in ("real", "imag"))
    rows = [[*real[i], *(-x for x in imaginary[i])] for i in range(size)]
    rows += [[*imaginary[i], *real[i]] for i in range(size)]
    return ball_positive_definite(arb_mat(rows))


def _form(m: acb_mat, d: list[fmpq], g: list[fmpq], sizes: list[tuple[int, int, bool]], ports: tuple) -> acb_mat:
    """w* D w + gamma^2 |d|^2 - z* D z - |y|^2 - i (w* G z - z* G w) in the variables (w, d), with (z, y) = m (w, d)."""
    inputs, outputs, level = ports
    of_w = _spread([*d, level], [*(p for p, _, _ in sizes), inputs])
    of_z = _spread([*d, fmpq(1)], [*(q for _, q, _ in sizes), outputs])
    form = acb_mat(of_w) - _adjoint(m) * acb_mat(of_z) * m
    if any(x != 0 for x in g):
        # G maps z to w: block diagonal, square where g is not zero, and zero elsewhere
        grid = [[arb(0)] * m.nrows() for _ in range(m.ncols())]
        row = column = 0
        for x, (p, q, _) in zip(g, sizes, strict=True):
            for k in range(min(p, q)):
                grid[row + k][column + k] = arb(x)
            row, column = row + p, column + q
        gm = acb_mat(arb_mat(grid)) * m
        form = form - (gm - _adjoint(gm)) * acb(0, 1)
    return form


def _settled(plant: _Plant, low: Fraction, high: Fraction, check: tuple, depth: int = 0) -> bool:
    m = plant.transfer(low, high)
    if m is not None and _definite(_form(m, *check)):
        return True
    if depth == _DEPTH:
        return False
    middle = (low + high) / 2
    return all(_settled(plant, a, b, check, depth + 1) for a, b in ((low, middle), (middle, high)))


def prove(scope: Scope) -> list[Proved]:
    """Prove the region, and the norm where one is asked for."""
    scope.define()
    fields = scope.certificate.fields
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

    ends = [scope.number(t) for t in scope.field("arcs")]
    if len(ends) < 2 or ends[0] != 0 or ends[-1] != 1 or any(x >= y for x, y in pairwise(ends)):
        raise scope.fail("field 'arcs': expected numbers increasing from 0 to 1")
    rows = _multipliers(scope, len(ends) - 1, sizes)
    first = rows[0][0]
    of_w = diagonal([eye(s[0]).scaled(Matrix.number(x)) for s, x in zip(sizes, first, strict=True)])
    of_z = diagonal([eye(s[1]).scaled(Matrix.number(x)) for s, x in zip(sizes, first, strict=True)])
    demand(scope, of_w - dw.T @ of_z @ dw, ">", "D - Dw' D Dw")
    plant = _Plant(
        *(acb_mat(m.to_ball().data) for m in (a, into, out, through)), to_fmpq(centre), to_fmpq(radius), disk
    )
    for number, (low, high, (d, g)) in enumerate(zip(ends[:-1], ends[1:], rows, strict=True), 1):
        if not _settled(plant, low, high, (d, g, sizes, (inputs, outputs, level))):
            raise scope.fail(f"arc {number}, t from {to_text(low)} to {to_text(high)}, is not proved")
    if disk:
        result = [Proved("radius", "less_than", to_text(radius))]
        return [*result, Proved("stable", "holds")] if radius <= -centre else result
    result = [Proved("abscissa", "less_than", to_text(centre))]
    if centre <= 0:
        result.append(Proved("stable", "holds"))
    return result if gamma is None else [*result, Proved("norm", "less_than", to_text(gamma))]
