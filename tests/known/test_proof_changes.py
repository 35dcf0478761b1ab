"""Certificates changed at random: each is refused in one line, or what it concludes is still true.

Truth is what a second judge finds that shares no code with the checker (`second_checker.py`). What a certificate says
of a quantity, in a sentence or on faith, no judge can know; formulas, witness, data and conclusions are what is changed
and judged. The seed is part of the test.
"""

import copy
import hashlib
import json
import os
import random
import re
import runpy
import shutil
from collections import Counter
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from scipy import linalg

from gainsay.errors import CertificateError
from gainsay.proof import Certificate, MappingTables, build, check

SECOND = runpy.run_path(str(Path(__file__).with_name("second_checker.py")))
ROOT = Path(__file__).resolve().parents[2]
#: what docs/robustness.md says of this campaign
TRIED = [
    {
        "what": "certificates",
        "how": "one to three changes each, of digits, formulas, witness, conclusions, unknowns, structure or kind",
        "fast": 150, "slow": 300, "night": 5000,
        "promise": "refused in one line, or what it concludes is still true by a second checker that shares no code "
        "with ours",
    }
]  # fmt: skip
COUNT = TRIED[0]["night" if os.environ.get("GAINSAY_NIGHT") else "slow"]
SEED, BATCHES = 20261125, 10

# ------------------------------------------------------------------------------ certificates of every kind, in small

TOY = MappingTables(
    name="toy",
    numbers={"b": "1.5", "gamma": "2", "n": "1.13e-3"},
    ranges={"rest": ("0.25", "0.5")},
    printed={"A": [["0.000", "1.000"], ["-2.000", "-3.000"]], "v": [["0.50", "0.25"]], "u": [["1", "0"], ["0", "-1"]]},
)
A = np.array([[0.0, 1.0], [-2.0, -3.0]])
EYE = np.eye(2)
CHANNELS = {"A": "A", "H": "col(0, level)", "Cz": "row(1, 0)", "blocks": [["repeated", 1]]}


def toys():
    """One certificate of each kind about (s + 1)(s + 2), with witnesses from SciPy."""
    half = linalg.solve_continuous_lyapunov((A + 0.9 * EYE).T, -EYE)
    disk = linalg.solve_discrete_lyapunov(((A + 1.5 * EYE) / 1.5).T, EYE)
    near = linalg.solve_discrete_lyapunov(((A + 1.5 * EYE) / 0.6).T, EYE)
    norm = linalg.solve_continuous_are(A, [[0.0], [1.0]], np.diag([1.05, 0.05]), [[-1.0]])
    robust = linalg.solve_continuous_are(A, [[0.0], [1.0]], np.diag([2.05, 0.05]), [[-2.0]])
    gramian = linalg.solve_continuous_lyapunov(A.T, -np.diag([1.0, 0.0]))
    # the regulator of x1^2 + u^2 driven at B, and the filter of w = (w1, w2) that drives B and disturbs y = x1 + w2
    cost = linalg.solve_continuous_are(A, [[0.0], [1.0]], np.diag([0.99, -0.01]), [[1.0]])
    spread = linalg.solve_continuous_are(A.T, [[1.0], [0.0]], np.diag([-0.01, 0.99]), [[1.0]])
    unit = linalg.solve_continuous_lyapunov(A.T, -EYE)
    unstable = linalg.solve_continuous_lyapunov((np.diag([1.0, -1.0]) - 0.5 * EYE).T, -EYE)
    definitions = {"A": "printed('A')", "b": "number('b')", "B": "col(0, 1)", "C": "row(1, 0)", "level": "0.5"}
    part = {"name": "disk", "kind": "contour",
            "fields": {**CHANNELS, "arcs": ["0", "0.5", "1"], "shift": "b", "radius": "b"}}  # fmt: skip
    second = {"name": "norm", "kind": "robust_norm",
              "fields": {**CHANNELS, "B": "B", "C": "C", "gamma": "number('gamma')"}}  # fmt: skip
    x = {"x": {}}
    listed = [
        ("lyapunov", {"matrix": "box('A')", "alpha": "-0.9"}, {"P": half}, {}),
        ("lyapunov", {"matrix": "A + [[0, 0], [r - 0.3, r*s]]", "alpha": "-0.2",
                      "ranges": [["r", "0", "number('b')/3"], ["s", "0.1", "0.2"]]}, {"P": half}, {}),
        ("stein", {"matrix": "A", "shift": "b", "radius": "0.6"}, {"P": near}, {}),
        ("descriptor_disk", {"matrix": "m*A + [[0, 0], [r, 0]]", "descriptor": "m*eye(2)", "shift": "b",
                             "radius": "0.7", "ranges": [["r", "0", "0.01"], ["m", "0.99", "1.01"]]},
         {"P": near, "K": EYE}, {}),
        ("unstable", {"matrix": "printed('u')", "alpha": "0.5"}, {"P": unstable, "z": [["1"], ["0"]]}, {}),
        ("bounded_real", {"A": "A", "B": "B", "C": "C", "gamma": "1"}, {"P": norm}, {}),
        ("norm_at_least", {"A": "A", "B": "B", "C": "C", "frequency": "0.001", "gamma": "0.49"},
         {"u": [["1", "0"]]}, {}),
        ("h2", {"A": "A", "B": "B", "C": "C", "bound": "0.29", "lower": "0.287"},
         {"P": gramian + 1e-3 * unit, "S": gramian - 1e-3 * unit}, {}),  # the norm is 12^-1/2
        ("h2_least", {"A": "A", "B1": "row(B, zeros(2, 1))", "B2": "B", "C1": "diag(1, 0)[0:2, 0:2]", "D12": "B",
                      "C2": "C", "D21": "row(0, 1)", "lower": "0.27"},
         {"P": cost, "F": -cost[1:], "R": [["0.99"]], "S": spread}, {}),
        ("eigenvalues", {"matrix": "A", "measure": "radius", "shift": "b"}, {}, {}),
        ("not_an_eigenvalue", {"matrix": "box('A')", "real": "-1.5", "imaginary": "0.1"}, {}, {}),
        ("enclosed", {"formula": "sqrt(b) + pi*(interval(0, 0.5) - plausible('rest')/2)", "low": "0.4", "high": "2.5"},
         {}, {}),
        ("definite", {"constraint": "[[b, 1], [..., 1]] > 0"}, {}, {}),
        ("not_definite", {"constraint": "[[b, 2], [..., 1]] > 0"}, {"z": [["1"], ["-1"]]}, {}),
        ("positive_on_interval", {"constraint": "[[x + 2, x], [..., 1]] > 0", "low": "-0.9", "high": "b"},
         {}, {"unknowns": x}),
        ("quadratic_bound", {"A": "A", "Q": "eye(2)", "x0": "row(unit(2,0), ends('rest').T)", "cost": "3",
                             "H": "col(0, level)",
                             "Cz": "row(1, 0)", "blocks": [["repeated", 1]],
                             "inputs": [{"of": "u", "row": "row(1, 1)", "bound": "4"}]},
         {"P": linalg.solve_continuous_lyapunov(A.T, -1.7 * EYE), "D1": "0.4"}, {}),
        ("delay_peak", {"A": "A", "Bd": "B", "Cd": "row(0.5, 0)", "delay": "0.3", "x0": "row(col(1, 0), col(0, b))",
                        "outputs": [{"of": "y", "row": "C", "from": "1", "bound": "1.5"}],
                        "B": "B", "w": "0.25", "rate": "0.1", "lag": "0.2", "step": "0.02", "cells": "500"}, {}, {}),
        ("robust_disk", {**CHANNELS, "H": "col(0, 0.1)", "shift": "b", "radius": "b"}, {"P": disk, "D1": "1"}, {}),
        ("robust_norm", {**CHANNELS, "B": "B", "C": "C", "gamma": "2"}, {"P": robust, "D1": "1"}, {}),
        ("contour", {**CHANNELS, "arcs": ["0", "0.5", "1"], "shift": "b", "radius": "b"},
         {"P": disk, "d": [["1"], ["1"]]}, {}),
        ("level", {"level": "level", "parts": [part, second]},
         {"disk.P": disk, "disk.d": [["1"], ["1"]], "norm.P": robust, "norm.D1": "1"}, {}),
        ("farkas", {"constraints": [["a", "x > b"], ["c", "x <= 1"]]}, {"a": "1", "c": "1"}, {"unknowns": x}),
        ("wrong_inertia", {"constraints": [["L", "sym(P @ printed('u')) < 0"], ["p", "P > 0"]], "unknown": "P",
                           "inequality": "L", "positive": "p"},
         {"drift": [["1", "0"], ["0", "-1"]], "inertia": [["-1", "0"], ["0", "1"]], "direction": [["1"], ["0"]],
          "inequality": [["1", "0"], ["0", "1"]], "positive": [["1", "0"], ["0", "1"]]},
         {"unknowns": {"P": {"shape": [2, 2], "structure": "symmetric"}}}),
        ("dual_bound", {"constraints": [["a", "x >= b"], ["c", "2*x >= 1"]], "minimise": "3*x + 1", "bound": "4.5"},
         {"a": "2", "c": "0.5"}, {"unknowns": x}),
        ("feasible", {"constraints": [["a", "x > b"]], "minimise": "x"}, {"x": "1.75"}, {"unknowns": x}),
        ("linear_box", {"constraints": [["a", "x == 0.49*eye(2)[0:1, 0:2] - row(0, -0.25)"]], "boxes": {"x": "v"},
                        "answer": "fails"}, None, {"unknowns": {"x": {"shape": [1, 2]}}}),
        ("identity", {"left": "x**3", "right": "x", "modulo": ["x**2 - 1"]}, {"x": "-1"}, {"unknowns": x}),
        ("different", {"left": "x**2", "right": "b*x"}, {"x": "1"}, {"unknowns": x}),
    ]  # fmt: skip
    for kind, fields, witness, more in listed:
        if witness is None:  # x = 0.49 at its first entry leaves [0.495, 0.505]: a multiplier of that entry
            witness = {"a": [["-1", "0"]]}
        yield build.certificate(kind, id=f"toy-{kind.replace('_', '-')}", statement="A toy.", tables=TOY,
                                definitions=definitions, fields=fields, witness=witness, **more)  # fmt: skip


#: tasks that take long and make no certificate, or one that takes the second judge long
LEFT_OUT = {"over_starts", "start_boundary", "figures", "random_gains", "torque_over_inputs"}
QUICK = {"li2021": ("factors", "algebra", "start_ellipsoid", "theorem2", "lemma4")}


def made_by_papers(folder):
    """Certificates of the papers, made by tasks of their own steps in a copy of the project."""
    from importlib import import_module

    from gainsay.results import Results, run_tasks
    from gainsay.tables import read_case

    shutil.copytree(ROOT / "papers", folder / "papers")
    for name in ("Snakefile", "pyproject.toml"):
        shutil.copy(ROOT / name, folder / name)
    for paper in ("li2021", "pinheiro2013", "wan2014", "zhang2013"):
        case = read_case(folder, paper)
        for step in ("synthesis", "audit"):
            tasks = import_module(f"papers.{paper}.{step}").TASKS
            names = QUICK.get(paper, [t.__name__ for t in tasks])
            quick = [t for t in tasks if t.__name__ in names and t.__name__ not in LEFT_OUT and "scan" not in t.where]
            run_tasks(Results(case, step), quick)
        for path in sorted((case.results / "certificates").glob("*.json")):
            yield Certificate.from_json(path.read_text(encoding="utf-8")), case


# ------------------------------------------------------------------------------------------------------- the changes

NUMBER = re.compile(r"\d+(\.\d+)?(e[+-]?\d+)?")
TOKENS = ["+", "-", "@", "*", "/", ".T", "**2", "0", "1", "2", "-1", "eye(2)", "pi", "A", "P", "X", "x", "b", "sqrt(2)"]
ABOUT = ["norm", "least", "stable", "abscissa", "radius", "feasible", "objective", "value", "level", "cost", "identity",
         "definite", "distance", "eigenvalue"]  # fmt: skip
RELATIONS = ["<", "<=", "==", ">=", ">"]


def places(value, path=()):
    """Paths to everything in a JSON value, its containers included."""
    yield path
    if isinstance(value, dict | list):
        for key, inner in value.items() if isinstance(value, dict) else enumerate(value):
            yield from places(inner, (*path, key))


def at(value, path):
    for key in path:
        value = value[key]
    return value


def put(value, path, new):
    at(value, path[:-1])[path[-1]] = new


def texts(plain, *parts):
    return [p for part in parts for p in places(plain[part], (part,)) if isinstance(at(plain, p), str)]


def digit(plain, draw):
    """Another digit somewhere in a number."""
    found = [
        p
        for p in texts(plain, "witness", "fields", "definitions", "conclusions", "data")
        if re.search(r"\d", at(plain, p))
    ]
    path = draw.choice(found)
    text = at(plain, path)
    place = draw.choice([m.start() for m in re.finditer(r"\d", text)])
    put(plain, path, text[:place] + draw.choice("0123456789") + text[place + 1 :])


def last_digit(plain, draw):
    """A witness changed in a late digit: often still one."""
    path = draw.choice([p for p in texts(plain, "witness") if re.search(r"\d{4}", at(plain, p))])
    text = at(plain, path)
    place = [m.start() for m in re.finditer(r"\d", text.partition("e")[0])][-1]
    put(plain, path, text[:place] + draw.choice("0123456789") + text[place + 1 :])


def scaled(plain, draw):
    """The whole witness, or one matrix of it, times a number."""
    names = list(plain["witness"])
    chosen = names if draw.random() < 0.5 else [draw.choice(names)]
    factor = draw.choice([Fraction(-1), Fraction(0), Fraction(2), Fraction(1, 3), Fraction(101, 100), Fraction(10**9)])
    for name in chosen:
        for path in texts(plain["witness"], name):
            put(plain["witness"], path, str(Fraction(at(plain["witness"], path)) * factor))


def token(plain, draw):
    """A token of a formula replaced, dropped or doubled."""
    path = draw.choice(texts(plain, "fields", "definitions"))
    parts = re.findall(r"[A-Za-z_]\w*|\d+\.?\d*|\*\*|[<>=]=|\.\.\.|\.T|\S|\s+", at(plain, path))
    place = draw.randrange(len(parts))
    if parts[place] in RELATIONS:
        parts[place] = draw.choice(RELATIONS)
    else:
        names = [name for name, _ in plain["definitions"]] + list(plain["unknowns"])
        parts[place] = draw.choice([draw.choice(TOKENS + names), "", parts[place] * 2, draw.choice(parts)])
    put(plain, path, "".join(parts))


def structure(plain, draw):
    """An element of a list or an object lost, doubled or exchanged with its neighbour."""
    path = draw.choice([p for p in places(plain) if p and isinstance(at(plain, p), dict | list) and at(plain, p)])
    value = at(plain, path)
    if isinstance(value, dict):
        first, second = draw.choice(list(value)), draw.choice(list(value))
        if draw.random() < 0.5:
            del value[first]
        else:
            value[first], value[second] = value[second], value[first]
        return
    i, j = draw.randrange(len(value)), draw.randrange(len(value))
    match draw.randrange(3):
        case 0:
            del value[i]
        case 1:
            value.insert(j, value[i])
        case 2:
            value[i], value[j] = value[j], value[i]


def conclusion(plain, draw):
    """Another relation, value or subject of a conclusion."""
    entry = draw.choice(plain["conclusions"])
    match draw.randrange(4):
        case 0:
            entry["relation"] = draw.choice(
                ["at_most", "at_least", "less_than", "greater_than", "holds", "fails", "inside"]
            )
        case 1:
            entry["of"] = draw.choice(ABOUT)
        case 2:
            low = Fraction((entry["value"] or "1").split("..")[0])
            moved = low + draw.choice([-1, 1]) * max(abs(low), 1) * Fraction(1, 10 ** draw.randrange(12))
            entry["value"] = str(moved)
        case 3:
            entry["value"] = draw.choice([None, "0", "-1", "1e9", "-1e9..1e9", "1..0", "nan"])


def unknown(plain, draw):
    """Another structure or shape of an unknown."""
    raw = plain["unknowns"][draw.choice(list(plain["unknowns"]))]
    if draw.random() < 0.5:
        raw["structure"] = draw.choice(["full", "symmetric", "skew", "diagonal", "round"])
    else:
        raw["shape"] = [draw.randrange(0, 8), draw.randrange(0, 8)]


def retyped(plain, draw):
    """A value of another type."""
    path = draw.choice([p for p in places(plain) if p])
    put(plain, path, draw.choice([None, True, 0, 1, -1, [], {}, "", "1", ["1"], [["1"]], {"shape": [1, 1]}]))


def kind(plain, draw):
    """Another kind of proof, with its fields where they have the same names."""
    plain["kind"] = draw.choice(sorted(SECOND["FACTS"]))


def bits(plain, draw):
    """Another precision."""
    plain["precision"] = draw.choice([53, 54, 64, 100, 256, 1024, 52, 10**6])


CHANGES = (digit, digit, last_digit, last_digit, scaled, token, token, token, structure, conclusion, conclusion,
           unknown, retyped, kind, bits)  # fmt: skip


def changed(certificate, draw):
    """Plain values of a certificate with one to three changes."""
    plain = copy.deepcopy(certificate.body())
    done = []
    for _ in range(draw.choice([1, 1, 1, 2, 3])):
        change = draw.choice(CHANGES)
        try:
            change(plain, draw)
        except (IndexError, KeyError, TypeError, ValueError, AttributeError):
            continue  # nothing there to change
        done.append(change.__name__)
    return plain, done


def sealed(plain):
    packed = json.dumps(plain, sort_keys=True, ensure_ascii=False, separators=(",", ":"))
    return json.dumps({**plain, "digest": "sha256:" + hashlib.sha256(packed.encode()).hexdigest()}, ensure_ascii=False)


# ---------------------------------------------------------------------------------------------------------- the test


def truth(certificates):
    """Every table entry that the unchanged certificates of a paper hold; designs of a run as the doubles they are."""
    data: dict[str, dict] = {}
    for certificate, case in certificates:
        exact = getattr(case, "designs", {})
        for group, entries in certificate.data.items():
            for name, value in entries.items():
                if group == "design" and name.partition(".")[0] not in exact:
                    value = [[str(Fraction(float(x))) for x in row] for row in value]
                data.setdefault(certificate.paper, {}).setdefault(group, {})[name] = value
    return data


@pytest.fixture(scope="module")
def certificates(tmp_path_factory):
    return [*((c, TOY) for c in toys()), *made_by_papers(tmp_path_factory.mktemp("project"))]


def tried(certificate, tables, data, draw):
    """One change of a certificate: what became of it; fails the test where a falsehood is accepted."""
    plain, done = changed(certificate, draw)
    if not done or plain == certificate.body():
        return "the same"
    try:
        check(Certificate.from_json(sealed(plain), "changed"), tables)
    except CertificateError as error:
        assert "\n" not in str(error), done
        return "refused"
    for group, entries in plain["data"].items():  # accepted: its data must be the tables'
        for name, value in entries.items():
            assert certificate.data.get(group, {}).get(name, value) == value, (done, group, name)
    try:
        SECOND["judge"](plain, data)
    except SECOND["Untrue"] as untrue:
        pytest.fail(f"{certificate.id} after {done}: accepted, and not true: {untrue}\n{json.dumps(plain)[:3000]}")
    return "true"


def test_the_second_judge_finds_the_toys_true_and_falsehoods_false():
    """The judge can fail: every toy is true, and a false conclusion of each is called false."""
    listed = [(c, TOY) for c in toys()]
    data = truth(listed)["toy"]
    for certificate, _ in listed:
        plain = certificate.body()
        SECOND["judge"](plain, data)
        false = copy.deepcopy(plain)
        entry = false["conclusions"][0]
        if entry["relation"] in ("holds", "fails"):
            entry["relation"] = "fails" if entry["relation"] == "holds" else "holds"
        else:
            turned = {"at_most": "at_least", "less_than": "at_least", "at_least": "at_most", "greater_than": "at_most",
                      "inside": "at_most"}  # fmt: skip
            upper = entry["relation"] in ("at_most", "less_than")
            entry["relation"] = turned[entry["relation"]]
            entry["value"] = str(Fraction((entry["value"] or "").split("..")[0]) + (5 if upper else -5))
        with pytest.raises(SECOND["Untrue"]):
            SECOND["judge"](false, data)


def test_changed_toys_are_refused_or_still_true():
    listed = [(c, TOY) for c in toys()]
    data, draw = truth(listed)["toy"], random.Random(SEED)
    found = Counter(tried(*draw.choice(listed), data, draw) for _ in range(TRIED[0]["fast"]))
    assert found["refused"] > 40
    assert found["true"] > 10


@pytest.mark.slow
@pytest.mark.parametrize("batch", range(BATCHES))
def test_changed_certificates_are_refused_or_still_true(certificates, batch):
    data, draw = truth(certificates), random.Random(f"{SEED} {batch}")
    found = Counter()
    for _ in range(COUNT // BATCHES):
        certificate, tables = draw.choice(certificates)
        found[tried(certificate, tables, data[certificate.paper], draw)] += 1
    print(f"changed certificates, batch {batch}: {dict(found)}")
    assert found["refused"] > found.total() // 4
    assert found["true"] + found["the same"] > 0


@pytest.mark.slow
def test_the_second_judge_agrees_with_every_certificate(certificates):
    data = truth(certificates)
    for certificate, _ in certificates:
        SECOND["judge"](certificate.body(), data[certificate.paper])
