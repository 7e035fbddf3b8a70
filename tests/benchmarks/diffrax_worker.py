"""diffrax on an oscillator at a barrier, as a process of its own: JSON lines in and out.

Run by `worker` in whichever Python has diffrax; it imports nothing of ours. A
run is one compiled function: Dopri8 up to the next event (the body turns, or touches its
barrier), whose time diffrax finds by Newton's method, then a restart. For a record the
steps end at its samples. As in SciPy's baseline nothing is done about resting contacts
and accumulating impacts; their number is bounded.
"""

from __future__ import annotations

import json
import sys
import time

import diffrax
import jax
import jax.numpy as jnp
import optimistix as optx

MOST_IMPACTS, MOST_STARTS = 200, 1000
TRIALS, ENOUGH = 10, 1.0

jax.config.update("jax_enable_x64", True)


def _ground(t, numbers):
    if numbers["samples"].size:
        i = jnp.clip((t / numbers["sample_step"]).astype(int), 0, numbers["samples"].size - 2)
        first, second = numbers["samples"][i], numbers["samples"][i + 1]
        return first + (second - first) * (t / numbers["sample_step"] - i)
    angle = numbers["omega"] * t
    wave = numbers["cosine"] * jnp.cos(angle) + numbers["sine"] * jnp.sin(angle)
    return jnp.where(numbers["quiet"], 0.0, wave)


def _motion(t, y, n):
    u, v, z = y
    yielding = jnp.where(v * z > 0.0, jnp.minimum(jnp.abs(z), 10.0) ** 20, 0.0)
    a = -(n["stiffness"] * u + n["strength"] * z) / n["mass"] - _ground(t, n)
    return jnp.array([v, a, v * (1.0 - yielding) / n["yield_displacement"]])


def _event():
    """Turning to the right, touching the barrier, turning to the left, in this order."""
    functions = [
        lambda t, y, args, **_: y[1],
        lambda t, y, args, **_: args["gap"] - y[0],
        lambda t, y, args, **_: y[1],
    ]
    finder = optx.Newton(1e-13, 1e-14, norm=optx.max_norm)
    return diffrax.Event(functions, finder, direction=[True, False, False])


@jax.jit
def _run(numbers, stops, rtol, atol):
    controller = diffrax.PIDController(rtol=rtol, atol=atol)
    if numbers["samples"].size:
        samples = numbers["sample_step"] * jnp.arange(1, numbers["samples"].size - 1)
        controller = diffrax.ClipStepSizeController(controller, step_ts=samples)

    def going(s):
        return (s["piece"] < stops.size) & (s["starts"] < MOST_STARTS) & s["sound"]

    def advance(s):
        n = numbers | {"quiet": s["piece"] > 0}
        sol = diffrax.diffeqsolve(
            diffrax.ODETerm(_motion), diffrax.Dopri8(), s["t"], stops[s["piece"]], None, s["y"],
            args=n, stepsize_controller=controller, event=_event(), max_steps=200000, throw=False,
        )  # fmt: skip
        t, y = sol.ts[0], sol.ys[0]
        right, touched, left = sol.event_mask
        u, v, z = y
        u = jnp.where(touched, n["gap"], u)
        i = jnp.where(touched, s["count"], MOST_IMPACTS)
        # A velocity of rounding after a turn must not be taken for another.
        v_next = jnp.where(right, jnp.maximum(v, 1e-300), v)
        v_next = jnp.where(left, jnp.minimum(v, -1e-300), v_next)
        v_next = jnp.where(touched, -n["restitution"] * v, v_next)
        return {
            "t": t, "y": jnp.array([u, v_next, z]),
            "piece": s["piece"] + jnp.where(right | touched | left, 0, 1),
            "lowest": jnp.minimum(s["lowest"], u), "highest": jnp.maximum(s["highest"], u),
            "count": s["count"] + touched, "starts": s["starts"] + 1,
            "sound": ((sol.result == diffrax.RESULTS.successful)
                      | (sol.result == diffrax.RESULTS.event_occurred))
                     & (s["count"] + touched < MOST_IMPACTS),
            "time": s["time"].at[i].set(t), "speed": s["speed"].at[i].set(v),
        }  # fmt: skip

    none = jnp.zeros(MOST_IMPACTS + 1)
    begin = {
        "t": jnp.array(0.0), "y": jnp.zeros(3), "piece": 0, "lowest": 0.0, "highest": 0.0,
        "count": 0, "starts": 0, "sound": True, "time": none, "speed": none,
    }  # fmt: skip
    return jax.lax.while_loop(going, advance, begin)


def _answer(request):
    stops, rtol = jnp.array(request.pop("stops")), request["rtol"]
    numbers = {key: jnp.asarray(value, dtype=float) for key, value in request.items()}
    arguments = (numbers, stops, rtol, rtol * request["length"])

    def once():
        return jax.block_until_ready(_run(*arguments))

    found, best, spent = once(), float("inf"), 0.0
    for _ in range(TRIALS):
        began = time.perf_counter()
        once()
        took = time.perf_counter() - began
        best, spent = min(best, took), spent + took
        if spent > ENOUGH:
            break
    count, reached = int(found["count"]), float(found["t"])
    ended = bool(found["sound"]) and int(found["piece"]) == stops.size
    times, speeds = found["time"][:count].tolist(), found["speed"][:count].tolist()
    return {
        "seconds": best,
        "trouble": "" if ended else f"did not get beyond t = {reached:.4g}",
        "reached": reached,
        "u": float(found["y"][0]),
        "extremes": [float(found["lowest"]), float(found["highest"])],
        "impacts": list(zip(times, speeds, strict=True)),
    }


if __name__ == "__main__":
    for line in sys.stdin:
        print(json.dumps(_answer(json.loads(line))), flush=True)
