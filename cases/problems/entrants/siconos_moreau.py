"""Siconos (4.4): Moreau and Jean's time-stepping, an LCP over the contacts of each step.

    python3 siconos_moreau.py PROBLEM_DIRECTORY out.csv STEP       (a step in parts of the run)

Linear springs and dashpots are implicit (theta 1/2); kinked and hysteretic springs are forces
of the beginning of the step, z by the midpoint rule over its elongation. Contacts with friction
are a cone problem in the place of the LCP.
"""

import json
import sys
from pathlib import Path

import numpy as np
import siconos.kernel as sk

folder, out, size = Path(sys.argv[1]), sys.argv[2], float(sys.argv[3])
p = json.loads((folder / "problem.json").read_text())
M, C = np.array(p["M"]), np.array(p["C"])
N = M.size
B, W = np.array(p["B"]).reshape(N, -1), np.array(p["W"]).reshape(N, -1)
spring = {key: np.array(column) for key, column in p["springs"].items() if key != "names"}
linear = (spring["compression"] == spring["extension"]) & (spring["strength"] == 0.0)
k_linear = np.where(linear, spring["compression"], 0.0)
K = (B * k_linear) @ B.T
yielding = np.flatnonzero(spring["strength"])
iota = np.array(p.get("iota", [[1.0]] * N))
samples = np.loadtxt(folder / "motion.csv", delimiter=",", skiprows=1, ndmin=2)
steps = 40 * int(np.ceil(1.0 / size / 40.0 - 1e-9))
h = (p["end"] - p["start"]) / steps

body = sk.LagrangianLinearTIDS(np.array(p["initial"]["u"]), np.array(p["initial"]["v"]), np.diag(M))
body.setKPtr(K)
body.setCPtr(C)
body.setFExtPtr(np.zeros(N))
model = sk.NonSmoothDynamicalSystem(p["start"], p["end"])
model.insertDynamicalSystem(body)
forces = sk.LCP()
if "W_T" in p:
    forces = sk.FrictionContact(2)
    forces.numericsSolverOptions().dparam[0] = 1e-13
for c, (gap, restitution) in enumerate(zip(p["gaps"], p["restitutions"], strict=True)):
    law, rows = sk.NewtonImpactNSL(restitution), W[:, c].reshape(1, N)
    if "W_T" in p:
        law = sk.NewtonImpactFrictionNSL(restitution, 0.0, p["frictions"][c], 2)
        rows = np.vstack((rows, np.array(p["W_T"])[:, c]))
    relation = sk.LagrangianLinearTIR(rows, np.array([gap, 0.0])[: len(rows)])
    model.link(sk.Interaction(law, relation), body)
simulation = sk.TimeStepping(
    model, sk.TimeDiscretisation(p["start"], h), sk.MoreauJeanOSI(0.5), forces
)

z = spring["z0"].astype(float)
power, bound = spring["n"], (spring["beta"] + spring["gamma"]) ** (-1.0 / spring["n"])
rows = [np.concatenate(([p["start"]], body.q(), body.velocity(), z[yielding]))]
stride = max(1, steps // 10000)
for step in range(1, steps + 1):
    u = body.q().copy()
    x = B.T @ u - spring["offset"]
    k = np.where(x < 0.0, spring["compression"], spring["extension"])
    f = np.where(linear, -k_linear * spring["offset"], k * x) + spring["strength"] * z
    middle = p["start"] + (step - 0.5) * h
    a_g = np.zeros(iota.shape[1])
    if samples[0, 0] <= middle < samples[-1, 0]:
        a_g = np.array([np.interp(middle, samples[:, 0], a) for a in samples.T[1:]])
    body.setFExtPtr(-M * (iota @ a_g) - B @ f)
    simulation.computeOneStep()
    dx, half = B.T @ (body.q() - u) / spring["yield_displacement"], z
    for stage in (2.0, 1.0):
        kappa = spring["beta"] + spring["gamma"] * np.sign(dx * half)
        half = np.clip(z + dx * (1.0 - kappa * np.abs(half) ** power) / stage, -bound, bound)
    z = half
    if step % stride == 0 or step == steps:
        t = p["end"] if step == steps else p["start"] + step * h
        rows.append(np.concatenate(([t], body.q(), body.velocity(), z[yielding])))
    simulation.nextStep()
names = [f"u.{b}" for b in p["bodies"]] + [f"v.{b}" for b in p["bodies"]]
names += [f"z.{p['springs']['names'][s]}" for s in yielding]
with open(out, "w") as file:
    file.write(f"# problem {p['problem']}\n" + ",".join(["t", *names]) + "\n")
    for row in rows:
        file.write(",".join(repr(float(x)) for x in row) + "\n")
