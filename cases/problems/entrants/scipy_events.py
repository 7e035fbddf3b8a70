"""SciPy's solve_ivp with the gaps as terminal events and Newton's law, as one would write it first.

    python scipy_events.py PROBLEM_DIRECTORY out.csv RTOL

Needs NumPy and SciPy. Contacts are struck one by one, nothing rests: where impacts accumulate
it does not end. Decks in plan it does not know.
"""

import json
import sys
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp

folder, out, rtol = Path(sys.argv[1]), sys.argv[2], float(sys.argv[3])
p = json.loads((folder / "problem.json").read_text())
if "iota" in p:
    sys.exit("error: knows bodies on a line, no decks in plan")
M, C = np.array(p["M"]), np.array(p["C"])
N = M.size
B, W = np.array(p["B"]).reshape(N, -1), np.array(p["W"]).reshape(N, -1)
gaps, restitution = np.array(p["gaps"]), np.array(p["restitutions"])
spring = {key: np.array(column) for key, column in p["springs"].items() if key != "names"}
yielding = np.flatnonzero(spring["strength"])
motion = p["motion"]


def ground(piece, t):
    s = t - piece["origin"]
    if "sinusoids" in piece:
        return sum(a * np.cos(w * s + q) for a, w, q in piece["sinusoids"])
    if "gaussian" in piece:
        q, *c = piece["gaussian"]
        return np.polyval(c[::-1], s) * np.exp(-q * s * s)
    return np.interp(s, piece["dt"] * np.arange(len(piece["samples"])), piece["samples"])


def rate(t, y, piece):
    u, v, z = y[:N], y[N : 2 * N], y[2 * N :]
    x, dx = B.T @ u - spring["offset"], B.T @ v
    k = np.where(x < 0.0, spring["compression"], spring["extension"])
    f = k * x + spring["strength"] * z
    kappa = spring["beta"] + spring["gamma"] * np.sign(dx * z)
    dz = dx * (1.0 - kappa * np.abs(z) ** spring["n"]) / spring["yield_displacement"]
    a_g = ground(piece, t) if piece else 0.0
    return np.concatenate((v, -(C @ v + B @ f) / M - a_g, dz))


def closing(c):
    def gap(t, y, piece):
        return gaps[c] + W[:, c] @ y[:N]

    gap.terminal, gap.direction = True, -1.0
    return gap


events = [closing(c) for c in range(gaps.size)]
borders = {p["start"], p["end"], *(m["start"] for m in motion), *(m["end"] for m in motion)}
moments = np.array(
    sorted({*p["moments"], *borders, *np.linspace(p["start"], p["end"], 1001).tolist()})
)
t, y = p["start"], np.concatenate((p["initial"]["u"], p["initial"]["v"], spring["z0"]))
rows = [(t, y)]
for stop in sorted(borders)[1:]:
    piece = next((m for m in motion if m["start"] <= t < m["end"]), None)
    while t < stop:
        inside = moments[(moments > t) & (moments <= stop)]
        sol = solve_ivp(
            rate, (t, stop), y, "DOP853", t_eval=inside, events=events, args=(piece,),
            rtol=rtol, atol=rtol * 1e-2,
        )  # fmt: skip
        if sol.status < 0:
            sys.exit(sol.message)
        rows += [(a, sol.y[:, i]) for i, a in enumerate(sol.t)]
        t, y = stop, sol.y[:, -1].copy() if len(sol.t) else y
        for c, states in enumerate(sol.y_events):
            if sol.status == 1 and len(states):
                t, y = sol.t_events[c][0], states[0].copy()
                rows.append((t, y.copy()))
                y[N : 2 * N] -= (
                    (1.0 + restitution[c]) * (W[:, c] @ y[N : 2 * N])
                    / (W[:, c] ** 2 / M).sum() * W[:, c] / M
                )  # fmt: skip
                rows.append((t, y))
with open(out, "w") as file:
    names = [f"u.{b}" for b in p["bodies"]] + [f"v.{b}" for b in p["bodies"]]
    names += [f"z.{p['springs']['names'][s]}" for s in yielding]
    kept = [*range(2 * N), *(2 * N + yielding)]
    file.write(f"# problem {p['problem']}\n" + ",".join(["t", *names]) + "\n")
    for t, y in rows:
        file.write(",".join(repr(float(x)) for x in (t, *y[kept])) + "\n")
