"""No controller reaches an H2 norm below a bound, for x' = A x + B1 w + B2 u, z = C1 x + D12 u.

Theorem: let M(P) = [[P A + A' P + C1' C1, P B2 + C1' D12], [., D12' D12]] >= 0, P symmetric. Then the squared H2 norm
from w to z is at least trace B1' P B1 in every loop that a controller from x to u stabilises, static or dynamic. With
C2 and D21 the controller is from y = C2 x + D21 w to u, and the bound is larger: let D12' D12 > 0, D21 D21' > 0,
R >= 0, M(P) - [-F, I]' R [-F, I] >= 0 and [[S A' + A S + B1 B1', S C2' + B1 D21'], [., D21 D21']] >= 0, S symmetric;
then the squared norm is at least trace B1' P B1 + trace R F S F'.

(With T = [[I, 0], [Dk, Ck]] for a controller (Ak, Bk, Ck, Dk), diag(P, 0) satisfies the inequality of the loop's
observability Gramian, whose remainder is T' M T. The norm is infinite unless Dk D21 = 0; then diag(S, 0) likewise is
below the controllability Gramian, and R^(1/2) (u - F x) has a squared norm of at least trace R F S F'. At the
stabilising solutions of the two Riccati equations both are equations, and the bound is the least norm. With B1 = x0 it
is the least cost of the linear-quadratic regulator from x0.)

Fields: ``A``, ``B1``, ``B2``, ``C1``, ``D12``, ``lower`` (on the norm); for a controller from y ``C2`` and ``D21``.
Witness: ``P``; with ``C2`` also ``F``, ``R``, ``S``.
Reference: J. C. Willems, "Least squares stationary optimal control and the algebraic Riccati equation", IEEE
Transactions on Automatic Control 16 (1971) 621-634: the dissipation inequality.
"""

from gainsay.exact.blocks import block
from gainsay.exact.matrix import Matrix, eye
from gainsay.exact.rational import to_text
from gainsay.proof.inequalities import bounds, demand, sym
from gainsay.proof.kinds import Proved
from gainsay.proof.scope import Scope

THEOREM = "a dissipation inequality that every controller obeys"
REQUIRED = ("A", "B1", "B2", "C1", "D12", "lower")
OPTIONAL = ("C2", "D21")
LEVELS = ("lower",)
FOUND = ()

#: a matrix, what is demanded of it, and its name
Condition = tuple[Matrix, str, str]


def dissipation(p: Matrix, a: Matrix, b: Matrix, c: Matrix, d: Matrix) -> Matrix:
    """M(P): of x' = a x + b u and the cost |c x + d u|^2."""
    return block([[sym(p @ a) + c.T @ c, p @ b + c.T @ d], [None, d.T @ d]])


def from_state(plant: dict[str, Matrix], p: Matrix) -> tuple[list[Condition], Matrix]:
    """What is demanded of P, and the bound on the squared norm under a controller from x."""
    form = dissipation(p, plant["A"], plant["B2"], plant["C1"], plant["D12"])
    return [(form, ">=", "M(P)")], (plant["B1"].T @ p @ plant["B1"]).trace()


def from_output(plant: dict[str, Matrix], p: Matrix, f: Matrix, r: Matrix, s: Matrix) -> tuple[list[Condition], Matrix]:
    """What is demanded of P, F, R, S, and the bound on the squared norm under a controller from y."""
    [(form, _, _)], state = from_state(plant, p)
    miss = block([[-f, eye(r.shape[0])]])
    d12, d21 = plant["D12"], plant["D21"]
    conditions = [
        (d12.T @ d12, ">", "D12' D12"),
        (d21 @ d21.T, ">", "D21 D21'"),
        (r, ">=", "R"),
        (form - miss.T @ r @ miss, ">=", "M(P) - [-F, I]' R [-F, I]"),
        (dissipation(s, plant["A"].T, plant["C2"].T, plant["B1"].T, d21.T), ">=", "the inequality of S"),
    ]
    return conditions, state + (r @ f @ s @ f.T).trace()


def prove(scope: Scope) -> list[Proved]:
    """Prove the bound."""
    scope.fields_fit(("C2", "D21"))
    scope.define()
    lower = scope.number(scope.field("lower"))
    names = [name for name in (*REQUIRED, *OPTIONAL) if name != "lower" and name in scope.certificate.fields]
    plant = {name: scope.evaluate(scope.field(name)) for name in names}
    states, inputs = plant["A"].shape[0], plant["B2"].shape[1]
    p = scope.symmetric_witness("P", states)
    if "C2" in plant:
        f, r = scope.witness("F", (inputs, states)), scope.symmetric_witness("R", inputs)
        conditions, value = from_output(plant, p, f, r, scope.symmetric_witness("S", states))
    else:
        conditions, value = from_state(plant, p)
    for matrix, relation, what in conditions:
        demand(scope, matrix, relation, what)
    least, _ = bounds(scope, value, "the bound on the squared norm")
    if lower < 0 or least < lower**2:
        raise scope.fail("the bound on the squared norm is not proved to be at least lower^2")
    return [Proved("least", "at_least", to_text(lower))]
