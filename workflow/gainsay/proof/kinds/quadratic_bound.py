"""Bounds on the cost and on the inputs of an uncertain system, for every admissible uncertainty, also time-varying.

Theorem (S-procedure): let x' = A x + H w, z = Cz x + Dw w, w = Delta(t) z with Delta structured as in
`gainsay.proof.lft`. If P > 0 and, with V = x' P x, the form dV/dt + x' Q x + [z; w]' M [z; w] in (x, w) is <= 0, then
along every solution dV/dt + x' Q x <= 0. Hence

- ``cost``: the integral of x' Q x over t >= 0, Q >= 0, is at most x(0)' P x(0);
- ``inputs`` (list of {"of", "row", "bound"}): |k x(t)| <= bound for all t >= 0, if Q >= 0 and
  bound^2 P - (x(0)' P x(0)) k' k >= 0 (k a matrix of any number of rows, |.| Euclidean);
- stable: with < 0 in place of <= 0 and Q >= 0 the origin is exponentially stable.

Where ``x0`` has several columns, the bounds are those of every start in their convex hull, since V is convex.

With Dw the form must be < 0: then I - Dw Delta is regular. Without channels (no ``H``) the system is x' = A x.

Fields: ``A``, ``Q`` (zero if left out), ``x0``, ``cost`` (the bound), ``inputs``, ``H``, ``Cz``, ``Dw``, ``blocks``.
Witness: ``P``, ``D1``, ..., ``G1``, ...
Reference: Boyd et al., Linear Matrix Inequalities in System and Control Theory, SIAM 1994, sections 5.1, 5.2 and 6.2.
"""

from gainsay.exact.blocks import block
from gainsay.exact.matrix import Matrix, eye, zeros
from gainsay.exact.rational import to_text
from gainsay.proof.inequalities import bounds, demand, order_holds, sym
from gainsay.proof.kinds import Proved
from gainsay.proof.lft import read_lft
from gainsay.proof.scope import Scope

THEOREM = "a quadratic Lyapunov function with the S-procedure"
REQUIRED = ("A",)
OPTIONAL = ("Q", "x0", "cost", "inputs", "H", "Cz", "Dw", "blocks")
LEVELS = ("cost", "inputs.bound")
FOUND = ()


def derivative(scope: Scope, a: Matrix, p: Matrix, q: Matrix) -> tuple[Matrix, bool]:
    """Form dV/dt + x' Q x + multipliers in (x, w), and whether it must be strictly negative."""
    form = sym(p @ a) + q
    if "H" not in scope.certificate.fields:
        return form, False
    n = a.shape[0]
    lft = read_lft(scope, n)
    count = lft.h.shape[1]
    z = block([[lft.cz, lft.dw]])
    w = block([[zeros(count, n), eye(count)]])
    whole = block([[form, p @ lft.h], [None, zeros(count, count)]])
    return whole + lft.form(z, w), lft.feedthrough


def inputs(scope: Scope) -> list[dict[str, str]]:
    """The bounded inputs, each under a name that nothing else here is proved of."""
    listed = scope.certificate.fields.get("inputs", [])
    if not isinstance(listed, list) or not all(
        isinstance(x, dict) and set(x) == {"of", "row", "bound"} and all(isinstance(t, str) for t in x.values())
        for x in listed
    ):
        raise scope.fail("field 'inputs': expected of, row and bound for each")
    taken = {"cost", "stable"}
    for entry in listed:
        if entry["of"] in taken:
            raise scope.fail(f"field 'inputs': the name {entry['of']!r} is taken")
        taken.add(entry["of"])
    return listed


def prove(scope: Scope) -> list[Proved]:
    """Prove stability, the cost and the input bounds."""
    scope.fields_fit(("H", "Cz", "blocks", ("Dw",)), ("x0", ("cost", "inputs")))
    scope.define()
    fields = scope.certificate.fields
    a = scope.evaluate(scope.field("A"))
    n = a.shape[0]
    q = scope.evaluate(scope.field("Q")) if "Q" in fields else zeros(n, n)
    p = scope.symmetric_witness("P", n)
    demand(scope, p, ">", "P")
    form, must = derivative(scope, a, p, q)
    what = "dV/dt + x' Q x with the multipliers"
    strict = order_holds(scope, form, "<", what)
    if not strict:
        demand(scope, form, "<" if must else "<=", what)
    dissipates = "Q" not in fields or order_holds(scope, q, ">=", "Q")
    result = [Proved("stable", "holds")] if strict and dissipates else []
    if "x0" not in fields:
        return result
    x0 = scope.evaluate(scope.field("x0"))
    levels = x0.T @ p @ x0
    start = max(bounds(scope, levels.take([i], [i]), "x(0)' P x(0)")[1] for i in range(x0.shape[1]))
    if "cost" in fields:
        if not dissipates:
            raise scope.fail("a cost bound needs Q >= 0")
        cost = scope.number(scope.field("cost"))
        if start > cost:
            raise scope.fail(f"x(0)' P x(0) <= {to_text(cost)} is not proved")
        result.append(Proved("cost", "at_most", to_text(cost)))
    for entry in inputs(scope):
        if not dissipates:
            raise scope.fail("input bounds need Q >= 0")
        k, bound = scope.evaluate(entry["row"]), scope.number(entry["bound"])
        reach = p.scaled(Matrix.number(bound**2)) - (k.T @ k).scaled(Matrix.number(start))
        if bound < 0:
            raise scope.fail(f"bound of {entry['of']!r} is negative")
        demand(scope, reach, ">=", f"bound^2 P - (x(0)' P x(0)) k' k of {entry['of']!r}")
        result.append(Proved(entry["of"], "at_most", to_text(bound)))
    return result
