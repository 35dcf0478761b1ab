"""A second judge of certificates, for tests: is what one concludes true? It shares no code with `gainsay`.

Formulas are evaluated in 40 digits (mpmath), boxes and intervals at drawn points, and conclusions are compared with
what the field computes without certificates: eigenvalues, singular values on a grid, Gramians, responses simulated
under drawn uncertainty. Where only multipliers can show something (infeasibility, a bound from below) they are
multiplied out again at drawn points. What is judged false is false up to the margin; what passes need not be proved.
"""

import ast
import random

import mpmath as mp
import numpy as np

from tests.known.second_formulas import (
    SLACK,
    Formulas,
    Untrue,
    drawn_point,
    given_point,
    in_boxes,
    matrix,
    number,
    ordered,
    spectrum,
)
from tests.known.second_loops import delayed, least_h2, lines, norms, uncertain

MARGIN = 1e-7
TRIES = 3


def weighted(plain, at, draw):
    """Sum of the multipliers' products at a point, the multipliers being of the right sign."""
    total, strict = mp.mpf(0), False
    elementwise = plain["kind"] == "linear_box"
    congruences = plain["fields"].get("congruences", {})
    for name, text in plain["fields"]["constraints"]:
        if name not in plain["witness"]:
            continue
        form, relation = at.constraint(text)
        form = -form if relation in ("<", "<=") else form
        if name in congruences:
            t = at.value(congruences[name])
            form = t.T.dot(form).dot(t)
        z = matrix(plain["witness"][name])
        assert z.shape == form.shape
        if relation != "==":
            scale = max(abs(x) for x in z.ravel()) + SLACK
            low = min(z.ravel()) if elementwise else spectrum(z)[0]
            if low < -SLACK * scale or (not elementwise and any(abs(x) > 0 for x in (z - z.T).ravel())):
                raise Untrue(f"the multiplier of {name} has the wrong sign")
            strict = strict or (relation in (">", "<") and any(x != 0 for x in z.ravel()) and name not in congruences)
        total += (z * form).sum()
    return total, strict


def infeasible(plain, data, draw):
    for _ in range(TRIES):
        at = Formulas(plain, data, in_boxes(plain, data, draw, drawn_point(plain, draw)), draw)
        total, strict = weighted(plain, at, draw)
        if total > SLACK or (total > -SLACK and not strict):
            raise Untrue(f"the weighted sum is {mp.nstr(total, 8)} at a drawn point")
    return {"feasible": [False]}


def lyapunov_tries(plain, draw):
    """Symmetric matrices that may satisfy a Lyapunov or Stein inequality: solutions of equations, and random ones."""
    drift = np.array([[float(number(x)) for x in row] for row in plain["witness"]["drift"]])
    n, rng = len(drift), np.random.default_rng(draw.randrange(2**32))
    jump = plain["witness"].get("jump")
    B = np.zeros((n, n)) if jump is None else np.array([[float(number(x)) for x in row] for row in jump])
    eye = np.eye(n)
    whole = np.kron(drift.T, eye) + np.kron(eye, drift.T) + np.kron(B.T, B.T)
    for _ in range(40):
        load = rng.normal(size=(n, n))
        load = load @ load.T + 1e-3 * eye
        yield np.linalg.lstsq(whole, -load.ravel(), rcond=None)[0].reshape(n, n)
        yield load * 10.0 ** rng.uniform(-3, 3)


def well_inside(form, relation):
    low, high = spectrum(form)
    room = mp.mpf("1e-9") * max(abs(x) for x in form.ravel())
    return low > room if ">" in relation else relation != "==" and high < -room


def wrong_inertia(plain, data, draw):
    """A point that satisfies every constraint shows that a refutation is false."""
    name = plain["fields"]["unknown"]
    for P in lyapunov_tries(plain, draw):
        point = {**drawn_point(plain, draw), name: np.vectorize(mp.mpf, otypes=[object])((P + P.T) / 2)}
        at = Formulas(plain, data, point, draw)
        if all(well_inside(*at.constraint(text)) for _, text in plain["fields"]["constraints"]):
            raise Untrue("a point satisfies the constraints")
    return {"feasible": [False]}


def dual_bound(plain, data, draw):
    least = "minimise" in plain["fields"]
    for _ in range(TRIES):
        at = Formulas(plain, data, in_boxes(plain, data, draw, drawn_point(plain, draw)), draw)
        total, _ = weighted(plain, at, draw)
        value, bound = (
            at.number(plain["fields"]["minimise" if least else "maximise"]),
            at.number(plain["fields"]["bound"]),
        )
        slack = (value - bound if least else bound - value) - total
        if slack < -SLACK * (1 + abs(value) + abs(bound)):
            raise Untrue("the bound does not follow from the multipliers at a drawn point")
    return {"objective": [bound]}


def feasible(plain, data, draw):
    point = given_point(plain)
    at = Formulas(plain, data, point, draw)
    for name, raw in plain["unknowns"].items():
        sign = {"symmetric": 1, "skew": -1}.get(raw.get("structure"))
        if sign and any(x != 0 for x in (point[name] - sign * point[name].T).ravel()):
            raise Untrue(f"{name} has another structure")
        assert list(point[name].shape) == raw.get("shape", [1, 1])
    for name, printed in plain["fields"].get("boxes", {}).items():
        off = np.abs(point[name] - matrix(data["printed"][printed])) - matrix(data["half_units"][printed])
        if any(x > SLACK for x in off.ravel()):
            raise Untrue(f"{name} leaves its box")
    for name, text in plain["fields"]["constraints"]:
        form, relation = at.constraint(text)
        if plain["kind"] == "linear_box":
            good = all({"==": abs(x) <= SLACK, ">": x > 0, ">=": x >= 0, "<": x < 0, "<=": x <= 0}[relation]
                       for x in form.ravel())  # fmt: skip
        else:
            good = ordered(form, relation)
        if not good:
            raise Untrue(f"{name} does not hold at the point")
    facts = {"feasible": [True]}
    for goal in ("minimise", "maximise"):
        if goal in plain["fields"]:
            facts["objective"] = [at.number(plain["fields"][goal])]
    return facts


def linear_box(plain, data, draw):
    return (feasible if plain["fields"]["answer"] == "holds" else infeasible)(plain, data, draw)


def identity(plain, data, draw):
    if "modulo" in plain["fields"]:
        return identity_modulo(plain, data)
    for _ in range(TRIES):
        at = Formulas(plain, data, drawn_point(plain, draw), draw)
        left, right = at.value(plain["fields"]["left"]), at.value(plain["fields"]["right"])
        size = 1 + max(abs(x) for x in (*left.ravel(), *right.ravel()))
        if left.shape != right.shape or any(abs(x) > SLACK * size for x in (left - right).ravel()):
            return {"identity": [False]}
    return {"identity": [True]}


def identity_modulo(plain, data):
    """Remainder on division by a Groebner basis of the relations, by sympy; numbers as unknowns alone."""
    import sympy

    names = {name: sympy.Symbol(name) for name in plain["unknowns"]}

    class Symbols(Formulas):
        def visit(self, node):
            if isinstance(node, ast.Constant):
                return np.array([[sympy.Rational(node.text)]], dtype=object)
            return super().visit(node)

        def block(self, rows):
            rows = [[rows[j][i].T if x is None else x for j, x in enumerate(row)] for i, row in enumerate(rows)]
            return np.vstack([np.hstack(row) for row in rows])

        def call(self, name, args):
            if name in ("number", "printed"):
                rows = self.data[name][args[0].value]
                rows = [[rows]] if isinstance(rows, str) else rows
                return np.array([[sympy.Rational(x) for x in row] for row in rows], dtype=object)
            if name == "eye":
                return np.array(sympy.eye(args[0].value).tolist(), dtype=object)
            return super().call(name, args)

    at = Symbols(plain, data, {name: np.array([[s]], dtype=object) for name, s in names.items()}, random.Random(0))
    relations = [sympy.expand(at.value(text)[0, 0]) for text in plain["fields"]["modulo"]]
    point = {names[name]: sympy.Rational(plain["witness"][name] if isinstance(plain["witness"][name], str)
                                         else plain["witness"][name][0][0]) for name in names}  # fmt: skip
    if any(r.subs(point) != 0 for r in relations):
        raise Untrue("the relations do not meet at the witness")
    left, right = at.value(plain["fields"]["left"]), at.value(plain["fields"]["right"])
    basis = sympy.groebner(relations, *names.values(), order="grevlex")
    same = left.shape == right.shape and all(basis.reduce(sympy.expand(x))[1] == 0 for x in (left - right).ravel())
    return {"identity": [same]}


def different(plain, data, draw):
    facts = identity(plain, data, draw)
    if facts["identity"] == [True] and plain["unknowns"]:  # the drawn points may miss what the witness shows
        at = Formulas(plain, data, given_point(plain), draw)
        gap = at.value(plain["fields"]["left"]) - at.value(plain["fields"]["right"])
        facts["identity"] = [all(abs(x) <= SLACK for x in gap.ravel())]
    return facts


def definite(plain, data, draw):
    held = []
    for _ in range(TRIES):
        at = Formulas(plain, data, {}, draw)
        form, relation = at.constraint(plain["fields"]["constraint"])
        if plain["kind"] == "definite":
            held.append(ordered(form, relation))
        else:
            low, high = spectrum(form)
            edge = low if relation in (">", ">=") else -high
            held.append(edge > SLACK if relation in (">", "<") else edge > -SLACK)
    return {"definite": held}


def enclosed(plain, data, draw):
    values = [Formulas(plain, data, {}, draw).number(plain["fields"]["formula"]) for _ in range(TRIES)]
    return {"value": values}


def level(plain, data, draw):
    at = Formulas(plain, data, {}, draw)
    facts = {"level": [at.number(plain["fields"]["level"])]}
    for part in plain["fields"]["parts"]:
        found = judge_facts({**plain, "kind": part["kind"], "fields": part["fields"]}, data, draw)
        for key in ("gamma", "radius"):
            if key in part["fields"]:
                of = {"gamma": "norm", "radius": "radius"}[key]
                bound = float(at.number(part["fields"][key]))
                if any(v > bound * (1 + MARGIN) for v in found[of]):
                    raise Untrue(f"{part['name']}: {of} above {bound}")
        facts |= {f"{part['name']}.{of}": values for of, values in found.items()}
    return facts


def interval(plain, data, draw):
    fields = plain["fields"]
    (name,) = plain["unknowns"]
    anywhere = Formulas(plain, data, {name: matrix("1")}, draw)
    low, high = (anywhere.number(fields[k]) for k in ("low", "high"))
    held = []
    for k in range(60):
        t = np.array([[low + (high - low) * k / 59]], dtype=object)
        held.append(ordered(*Formulas(plain, data, {name: t}, draw).constraint(fields["constraint"])))
    return {"definite": held}


def implication(plain, data, draw):
    """The sum of congruences evaluated at drawn values of every unknown: an identity of words holds there too."""
    fields = plain["fields"]
    point = drawn_point(plain, draw)
    for name in {*fields.get("invertible", []), *fields.get("positive", [])}:
        point[name] = point[name] + 23 * np.eye(len(point[name]), dtype=int)
    at = Formulas(plain, data, point, draw)

    def positive(text):
        form, relation = at.constraint(text)
        return (form if ">" in relation else -form), "=" not in relation

    given, (goal, strict) = {name: positive(text) for name, text in fields["given"]}, positive(fields["then"])
    total, whole = goal * 0, np.zeros(goal.shape, dtype=object)
    for term in fields["by"]:
        factor = at.value(term["with"])
        form, sharp = given[term["of"]] if term["of"] else (np.eye(len(factor), dtype=int) * mp.mpf(1), True)
        scale = at.number(term.get("scale", "1"))
        if not scale > 0:
            return {"implication": [False]}
        total = total + scale * (factor.T @ form @ factor)
        if sharp and "left_inverse" in term:
            whole = whole + at.value(term["left_inverse"]) @ factor
    size = 1 + max(abs(x) for x in (*total.ravel(), *goal.ravel()))
    good = all(abs(x) <= SLACK * size for x in (total - goal).ravel())
    if strict:
        good = good and all(abs(x) <= SLACK for x in (whole - np.eye(len(goal), dtype=int)).ravel())
    return {"implication": [good]}


FACTS = {
    **dict.fromkeys(("lyapunov", "stein", "descriptor_disk", "unstable", "eigenvalues", "not_an_eigenvalue"), lines),
    **dict.fromkeys(("bounded_real", "h2", "norm_at_least"), norms),
    **dict.fromkeys(("quadratic_bound", "robust_disk", "robust_norm", "contour"), uncertain),
    **dict.fromkeys(("definite", "not_definite"), definite),
    "h2_least": least_h2, "delay_peak": delayed, "farkas": infeasible, "wrong_inertia": wrong_inertia,
    "dual_bound": dual_bound, "feasible": feasible, "linear_box": linear_box,
    "identity": identity, "different": different, "enclosed": enclosed, "level": level,
    "positive_on_interval": interval, "implication": implication,
}  # fmt: skip


def judge_facts(plain, data, draw):
    return FACTS[plain["kind"]](plain, data, draw)


def judge(plain, data, seed=0):
    """Raise `Untrue` unless every conclusion of a certificate (plain JSON values) agrees with the facts."""
    facts = judge_facts(plain, data, random.Random(seed))
    if not plain["conclusions"]:
        raise Untrue("nothing is concluded")
    for conclusion in plain["conclusions"]:
        values, relation, value = facts.get(conclusion["of"]), conclusion["relation"], conclusion["value"]
        if not values:
            raise Untrue(f"nothing is known about {conclusion['of']!r}")
        if relation in ("holds", "fails"):
            good = value is None and all(v == (relation == "holds") for v in values)
        else:
            low, high = value.split("..") if relation == "inside" else (value, value)
            low, high = number(low), number(high)
            room = MARGIN * (1 + abs(low)) if plain["kind"] in INEXACT else SLACK * (1 + abs(low))
            if conclusion["of"] == "matching":  # of eigenvalues in doubles
                room = mp.mpf("1e-12")
            above = all(v >= low - room for v in values)
            below = all(v <= high + room for v in values)
            good = {"at_most": below, "less_than": below, "at_least": above, "greater_than": above,
                    "inside": above and below}[relation]  # fmt: skip
            if plain["kind"] == "norm_at_least" and relation in ("at_least", "greater_than"):
                good = all(v >= low * (1 - 0.05) for v in values)  # the grid may miss the peak
        if not good:
            raise Untrue(
                f"{conclusion}: the facts are {[mp.nstr(v, 12) if isinstance(v, mp.mpf) else v for v in values][:4]}"
            )


INEXACT = {
    "bounded_real",
    "delay_peak",
    "h2",
    "h2_least",
    "norm_at_least",
    "quadratic_bound",
    "robust_disk",
    "robust_norm",
    "contour",
    "level",
}
