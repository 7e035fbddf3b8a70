"""OpenSeesPy on an oscillator at a barrier, as a process of its own: JSON lines in and out.

Run by `worker` in whichever Python has openseespy; it imports nothing of ours. As is usual
there: Newmark's average acceleration with a fixed step, OpenSees's Bouc-Wen material, and
for the barrier a viscoelastic spring with a gap, whose damping gives the restitution and
whose stiffness makes a contact last 20 steps. There is no tolerance, so steps stand for
it: 0.1/rtol in a period of the motion, at most 100 000.
"""

from __future__ import annotations

import json
import math
import os
import sys
import tempfile
import time

import openseespy.opensees as ops

MOST_STEPS = 100_000
STEPS_IN_CONTACT = 20
TRIALS, ENOUGH = 3, 1.0


def _model(n, dt):
    ops.wipe()
    ops.model("basic", "-ndm", 1, "-ndf", 1)
    for node in (1, 2, 3):
        ops.node(node, 0.0)
    ops.fix(1, 1)
    ops.fix(3, 1)
    ops.mass(2, n["mass"])
    k, q, u_y = n["stiffness"], n["strength"], n["yield_displacement"]
    if q > 0.0:
        initial, width = k + q / u_y, 0.5 / u_y**20
        ops.uniaxialMaterial(
            "BoucWen", 1, k / initial, initial, 20.0, width, width, 1.0, 0.0, 0.0, 0.0
        )
    else:
        ops.uniaxialMaterial("Elastic", 1, k)
    contact = n["mass"] * (math.pi / (STEPS_IN_CONTACT * dt)) ** 2
    log = -math.log(n["restitution"])
    damping = 2.0 * log / math.hypot(math.pi, log) * math.sqrt(contact * n["mass"])
    ops.uniaxialMaterial("ViscoelasticGap", 2, contact, damping, -n["gap"])
    ops.element("zeroLength", 1, 1, 2, "-mat", 1, "-dir", 1)
    ops.element("zeroLength", 2, 2, 3, "-mat", 2, "-dir", 1)


def _load(n, dt):
    if n["samples"]:
        ops.timeSeries("Path", 1, "-dt", n["sample_step"], "-values", *n["samples"])
    else:
        last = round(n["stops"][0] / dt)
        waves = [
            n["cosine"] * math.cos(n["omega"] * i * dt) + n["sine"] * math.sin(n["omega"] * i * dt)
            for i in range(last + 1)
        ]
        ops.timeSeries("Path", 1, "-dt", dt, "-values", *waves)
    ops.pattern("UniformExcitation", 1, 1, "-accel", 1)


def _run(n, dt, steps, file):
    _model(n, dt)
    _load(n, dt)
    ops.recorder("Node", "-binary", file, "-time", "-node", 2, "-dof", 1, "disp")
    ops.constraints("Plain")
    ops.numberer("Plain")
    ops.system("ProfileSPD")
    ops.test("NormDispIncr", 1e-12 * n["length"], 50, 0)
    ops.algorithm("Newton")
    ops.integrator("Newmark", 0.5, 0.25)
    ops.analysis("Transient")
    began = time.perf_counter()
    failed = ops.analyze(steps, dt)
    took = time.perf_counter() - began
    ops.wipe()
    return failed, took


def _judge(n, dt, file):
    import numpy as np

    # A line feed follows the numbers of each step, in binary files too.
    rows = np.fromfile(file, dtype=[("t", "f8"), ("u", "f8"), ("feed", "S1")])
    t, u = rows["t"], rows["u"]
    entries = np.flatnonzero((u[:-1] < n["gap"]) & (u[1:] >= n["gap"]))
    part = (n["gap"] - u[entries]) / (u[entries + 1] - u[entries])
    times, speeds = t[entries] + part * dt, (u[entries + 1] - u[entries]) / dt
    return {
        "reached": float(t[-1]),
        "u": float(u[-1]),
        "extremes": [min(0.0, float(u.min())), max(0.0, float(u.max()))],
        "impacts": list(zip(times.tolist(), speeds.tolist(), strict=True)),
    }


def _answer(n):
    count, end = round(0.1 / n["rtol"]), n["stops"][-1]
    if count > MOST_STEPS:
        nothing = {"reached": 0.0, "u": 0.0, "extremes": [0.0, 0.0], "impacts": []}
        return nothing | {"seconds": 0.0, "trouble": f"more than {MOST_STEPS} steps a period"}
    period = 2.0 * math.pi / n["rate"]
    unit = n["sample_step"] if n["samples"] else n["stops"][0]
    dt = unit / math.ceil(unit / (period / count))
    with tempfile.TemporaryDirectory() as folder:
        file = os.path.join(folder, "disp.bin")
        best, spent = math.inf, 0.0
        for _ in range(TRIALS):
            failed, took = _run(n, dt, round(end / dt), file)
            best, spent = min(best, took), spent + took
            if spent > ENOUGH:
                break
        found = _judge(n, dt, file)
    trouble = f"did not converge at t = {found['reached']:.4g}" if failed else ""
    return found | {"seconds": best, "trouble": trouble}


if __name__ == "__main__":
    # OpenSees writes to standard output, which is ours to answer on.
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    for line in sys.stdin:
        print(json.dumps(_answer(json.loads(line))), file=answers, flush=True)
