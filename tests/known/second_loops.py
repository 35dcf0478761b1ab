"""What the second judge finds of loops: where eigenvalues lie, norms, and responses under drawn uncertainty."""

import itertools

import mpmath as mp
import numpy as np
from scipy import linalg

from tests.known.second_formulas import (
    SLACK,
    Formulas,
    bottleneck,
    doubles,
    gain,
    listed,
    uncertainties,
)

TRIES = 3


def hull(matrices, draw):
    """Vertices and some points between them."""
    weights = [[draw.random() for _ in matrices] for _ in range(TRIES)]
    return [*matrices, *(sum(m * mp.mpf(w / sum(ws)) for m, w in zip(matrices, ws, strict=True)) for ws in weights)]


def judged_at(plain, data, draw):
    """Formulas of a certificate: with one drawn matrix of every printed box, at corners and points of the ranges."""
    ranges = plain["fields"].get("ranges", [])
    tables = Formulas({"definitions": []}, data, {}, draw)
    ends = {name: [tables.number(end) for end in pair] for name, *pair in ranges}
    corners = [dict(zip(ends, point, strict=True)) for point in itertools.product(*ends.values())] if ranges else [{}]
    drawn = "box(" in str(plain["definitions"]) + str(plain["fields"]) or ranges
    inside = [
        {n: a + (b - a) * mp.mpf(draw.random()) for n, (a, b) in ends.items()} for _ in range(TRIES * bool(drawn))
    ]
    for point in [*corners, *inside]:
        yield Formulas(plain, data, {name: np.array([[x]], dtype=object) for name, x in point.items()}, draw)


def eigenvalues(m):
    assert m.shape[0] == m.shape[1]
    if len(m) == 1:
        return [m[0, 0]]
    return mp.eig(mp.matrix(m.tolist()), left=False, right=False)


def mp_solve(e, a):
    """E^-1 A in many digits."""
    size = len(a)
    inverse = mp.matrix(np.asarray(e).tolist()) ** -1
    return np.array([[sum(inverse[i, k] * a[k, j] for k in range(size)) for j in range(size)] for i in range(size)])


def lines(plain, data, draw):
    """Kinds lyapunov, stein, descriptor_disk, unstable, eigenvalues, not_an_eigenvalue: where eigenvalues lie."""
    facts, fields = (
        {"abscissa": [], "radius": [], "stable": [], "nearest": [], "eigenvalue": [], "distance": []},
        plain["fields"],
    )
    facts["matching"] = []
    for at in judged_at(plain, data, draw):
        found = listed(at, fields["matrix"])
        if "descriptor" in fields:
            found = [mp_solve(at.value(fields["descriptor"]), found[0])]
        for m in hull(found, draw) if len(found) > 1 else found:
            roots = eigenvalues(m)
            facts["abscissa"].append(max(mp.re(s) for s in roots))
            facts["stable"].append(facts["abscissa"][-1] < 0)
            if "shift" in fields:
                facts["radius"].append(max(abs(s + at.number(fields["shift"])) for s in roots))
            if "real" in fields:
                point = mp.mpc(at.number(fields["real"]), at.number(fields["imaginary"]))
                facts["distance"].append(min(abs(s - point) for s in roots))
                facts["eigenvalue"].append(facts["distance"][-1] < SLACK)
            if "points" in fields:
                points = [mp.mpc(at.number(a), at.number(b)) for a, b in fields["points"]]
                costs = np.array([[float(abs(s - p)) for p in points] for s in roots])
                facts["nearest"].append(mp.mpf(costs.min()))
                facts["matching"].append(bottleneck(costs))
    return facts


def norms(plain, data, draw):
    """Kinds bounded_real, h2, norm_at_least."""
    facts, fields = {"norm": [], "stable": []}, plain["fields"]
    names = ("A", "B", "C", *(["D"] if "D" in fields else []))
    for systems in ([listed(at, fields[name]) for name in names] for at in judged_at(plain, data, draw)):
        for k in range(max(map(len, systems))):
            a, b, c, *d = (doubles(s[k if len(s) > 1 else 0]) for s in systems)
            d = d[0] if d else np.zeros((len(c), b.shape[1]))
            facts["stable"].append(linalg.eigvals(a).real.max() < 0)
            if plain["kind"] == "h2":
                gramian = linalg.solve_continuous_lyapunov(a.T, -c.T @ c)
                facts["norm"].append(mp.mpf(np.sqrt(np.trace(b.T @ gramian @ b))))
            else:
                facts["norm"].append(mp.mpf(gain(a, b, c, d)) if facts["stable"][-1] else mp.inf)
    return facts


def regulator(a, b, c, d, weight):
    """Gain of the least cost |c x + d u|^2, the input weighed a little more than asked where its weight is singular."""
    r = d.T @ d + weight * np.eye(d.shape[1])
    p = linalg.solve_continuous_are(a, b, c.T @ c, r, s=c.T @ d, e=np.eye(len(a)))
    return -linalg.solve(r, b.T @ p + d.T @ c)


def least_h2(plain, data, draw):
    """Norms of loops: a bound on the least norm is below each of them."""
    at, facts = Formulas(plain, data, {}, draw), []
    a, b1, b2, c1, d12 = (doubles(at.value(plain["fields"][name])) for name in ("A", "B1", "B2", "C1", "D12"))
    for weight in (0.0, 1e-9, 1e-6, 1e-3):
        try:
            k = regulator(a, b2, c1, d12, weight)
            loop, drive, seen = a + b2 @ k, b1, c1 + d12 @ k
            if "C2" in plain["fields"]:
                c2, d21 = (doubles(at.value(plain["fields"][name])) for name in ("C2", "D21"))
                gain = -regulator(
                    a.T, c2.T, b1.T, d21.T, weight
                ).T  # of the filter x^' = A x^ + B2 u + gain (y - C2 x^)
                loop = np.block([[a, b2 @ k], [gain @ c2, a + b2 @ k - gain @ c2]])
                drive, seen = np.vstack([b1, gain @ d21]), np.hstack([c1, d12 @ k])
        except (linalg.LinAlgError, ValueError):
            continue
        if linalg.eigvals(loop).real.max() < 0:
            gramian = linalg.solve_continuous_lyapunov(loop.T, -seen.T @ seen)
            facts.append(mp.mpf(np.sqrt(np.trace(drive.T @ gramian @ drive))))
    return {"least": facts or [mp.inf]}


def uncertain(plain, data, draw):
    """Kinds quadratic_bound, robust_disk, robust_norm, contour: sampled over constant uncertainty."""
    fields, at = plain["fields"], Formulas(plain, data, {}, draw)

    def get(name, rows, columns):
        return doubles(at.value(fields[name])) if name in fields else np.zeros((rows, columns))

    a = doubles(at.value(fields["A"]))
    n = len(a)
    channels = "H" in fields
    h = get("H", n, 1)
    cz = get("Cz", 1, n)
    dw = get("Dw", len(cz), h.shape[1])
    facts = {"stable": [], "abscissa": [], "radius": [], "norm": [], "cost": []}
    for delta in uncertainties(fields["blocks"], draw) if channels else [np.zeros((h.shape[1], len(cz)))]:
        through = delta @ linalg.inv(np.eye(len(cz)) - dw @ delta)
        loop = a + h @ through @ cz
        roots = linalg.eigvals(loop)
        facts["stable"].append(roots.real.max() < 0)
        facts["abscissa"].append(mp.mpf(roots.real.max()))
        if "shift" in fields:
            facts["radius"].append(mp.mpf(np.abs(roots + float(at.number(fields["shift"]))).max()))
        if "gamma" in fields:
            b, c = get("B", n, 1), get("C", 1, n)
            dd, ew, d = get("Dd", len(cz), b.shape[1]), get("Ew", len(c), h.shape[1]), get("D", len(c), b.shape[1])
            facts["norm"].append(
                mp.mpf(gain(loop, b + h @ through @ dd, c + ew @ through @ cz, d + ew @ through @ dd, 60))
            )
        if "x0" in fields:
            starts = doubles(at.value(fields["x0"]))
            weights = np.array([[draw.random()] for _ in starts.T])
            x0 = (
                starts @ (weights / weights.sum()) if draw.random() < 0.5 else starts[:, [draw.randrange(len(weights))]]
            )
            if "cost" in fields and roots.real.max() < 0:
                x = linalg.solve_continuous_lyapunov(loop.T, -get("Q", n, n))
                facts["cost"].append(mp.mpf((x0.T @ x @ x0)[0, 0]))
            horizon = 10 / max(abs(roots.real).min(), 1e-12)
            step = linalg.expm(loop * horizon / 400)
            for entry in fields.get("inputs", []):
                x, k, peak = x0, doubles(at.value(entry["row"])), 0.0
                for _ in range(400):
                    peak, x = max(peak, linalg.norm(k @ x)), step @ x
                facts.setdefault(entry["of"], []).append(mp.mpf(peak))
    return facts


def delayed(plain, data, draw):
    """Kind delay_peak: peaks of flights under drawn delays that jump, and drawn disturbances of full size."""
    fields, at = plain["fields"], Formulas(plain, data, {}, draw)
    loops = zip(*(listed(at, fields[name]) for name in ("A", "Bd", "Cd")), strict=True)
    starts, longest = doubles(at.value(fields["x0"])), float(at.number(fields["delay"]))
    push = doubles(at.value(fields["B"])) if "B" in fields else np.zeros((len(starts), 1))
    size = float(at.number(fields["w"])) if "B" in fields else 0.0
    outputs = [(o["of"], doubles(at.value(o["row"])), float(at.number(o["from"]))) for o in fields["outputs"]]
    facts = {of: [] for of, _, _ in outputs}
    for a, bd, cd in ((doubles(m) for m in loop) for loop in loops):
        n = len(a)
        fastest = max(np.abs(linalg.eigvals(a + bd @ cd)).max(), 1e-9)
        slowest = max(-linalg.eigvals(a + bd @ cd).real.max(), 1e-3 * fastest)
        end = max(since for _, _, since in outputs) + 4 / slowest
        step = max(min(0.02 / fastest, longest / 8 if longest > 0 else np.inf), end / 20_000)
        hold = linalg.expm(step * np.block([[a, bd, push], [np.zeros((2, n + 2))]]))
        for _ in range(TRIES):
            weights = np.array([[draw.random()] for _ in starts.T])
            x, seen = starts @ (weights / weights.sum()), []
            jump = draw.choice([0.05, 0.5, 2.0]) / fastest
            d, w, until = draw.choice([0.0, longest]), size, 0.0
            for k in range(int(end / step)):
                if k * step >= until:
                    d, w, until = draw.choice([0.0, longest]), draw.choice([-size, size]), k * step + jump
                seen.append((cd @ x).item())
                # rounded towards now: no delay is longer than the longest
                late = seen[max(k - int(d / step), 0)]
                x = (hold @ np.vstack([x, [[late]], [[w]]]))[:n]
                for of, row, since in outputs:
                    if (k + 1) * step >= since:
                        facts[of].append((row @ x).item())
    return {of: [mp.mpf(min(values)), mp.mpf(max(values))] for of, values in facts.items() if values}
