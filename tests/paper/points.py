"""Points of the paper's figures, drawn at random and recomputed by `tests.paper.program`.

    python -m tests.paper.points [COUNT] [SEED]

draws COUNT runs (20) from each of figures 2 and 4 to 9, gives the program their Π-terms, and
compares the peaks, allowed 1e-6 of the peak; then a quarter of them from figure 11 in both
readings (displacements at random times) and figure 12 (peaks of both frames), allowed
max(1e-4, 10 × amplification × tolerance) of the largest displacement, with the amplification
that the package measures. Exit code 1 where one is beyond.
"""

import sys
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from eventpound import Record, Scene, load_case, simulate
from eventpound.accuracy.conditioning import conditioning
from eventpound.case.case import Case, member_case
from eventpound.solvers import solver_named
from eventpound.solvers.base import Task
from eventpound.study.plan import Plan
from eventpound.study.reading import load_study
from eventpound.study.variants import rows_of_base, scene_of_row
from tests.benchmarks.problem import CASES
from tests.paper.program import Answer, Kinked, Program, Row, in_series, pulse, sampled

STUDIES = ("figure-02", *(f"figure-0{n}" for n in range(4, 10)))
BRIDGES = ("figure-11", "figure-11-direct-abutments", "figure-12")
ALLOWED, ALLOWED_BRIDGE = 1e-6, 1e-4
UNIT = {"excitation.amplitude": 1.0, "excitation.period": 2.0 * np.pi}


@dataclass(frozen=True)
class Point:
    """A number of a figure: what it is, the package's and the program's, and what is allowed."""

    what: str
    ours: float
    theirs: float
    scale: float
    allowed: float

    @property
    def apart(self) -> float:
        """Their difference as a part of the scale."""
        return abs(self.ours - self.theirs) / self.scale


def row_of_terms(terms: dict[str, float], places: tuple[str, ...], a: float, omega: float) -> Row:
    """A row of equal bodies from its Π-terms (eqs 8, 12 and 16), with masses of 1 kg."""
    length = a / omega**2
    bodies = [place for place in places if place != "barrier"]
    own = terms.get("omega_s", 0.0) * omega
    ratio = terms.get("omega_s.i", 1.0)
    frequencies = np.array([own if body == "0" else own / ratio for body in bodies])
    ones = np.ones(len(bodies))
    gaps = tuple(
        (i, -1 if right == "barrier" else i + 1, terms["delta"] * length)
        for i, right in enumerate(places[1:])
    )
    return Row(
        ones, frequencies**2, terms.get("Q", 0.0) * a * ones, terms.get("uy", 1.0) * length * ones,
        0.0 * ones, gaps, terms["epsilon"],
    )  # fmt: skip


def of_study(name: str, study: Plan, run: int) -> Point:
    """Peak of the body looked at in one run of a study."""
    for base in study.bases:
        if run < base.size:
            break
        run -= base.size
    rows = rows_of_base(base, run, run + 1)
    values = UNIT | {key: float(column[0]) for key, column in rows.values.items()}
    pi = base.case.pi
    terms = {**pi.terms, **{k.removeprefix("pi."): v for k, v in values.items()}}
    a, omega = values["excitation.amplitude"], 2.0 * np.pi / values["excitation.period"]
    kind, reverse = _words(base.case.scene)
    row = row_of_terms(terms, pi.structure.row, a, omega)
    end = float(rows.lengths[0])
    answer = Program(row, a / omega**2, omega).run(pulse(kind, a, omega, reverse, end))
    case = replace(base.case, scene=scene_of_row(rows, 0))
    response = simulate(case, study.solver, study.rtol, duration=end, output_step=end)
    peak = float(response.peaks["abs_max"]["0"])
    which = [place for place in pi.structure.row if place != "barrier"].index("0")
    words = ", ".join(str(v) for v in base.labels.values())
    words += "".join(f", {k} {v:g}" for k, v in values.items() if k not in UNIT)
    return Point(f"{name}: {words}", peak, float(answer.peak[which]), peak, ALLOWED)


def _words(scene: Scene) -> tuple[str, bool]:
    """Kind and direction of a pulse."""
    return str(scene.motion.kind), bool(getattr(scene.motion, "reverse", False))


def bridge_row(direct: bool) -> Row:
    """The bridge of section 6 and Table 1, abutments in series with their bearings or not."""
    mass = np.array([1301e3, 3210e3])
    initial, yielding = np.array([233443e3, 101048e3]), np.array([3621e3, 3794e3])
    # 5 % by the frequency after yield, as the cases print it (to 0.1 kN s/m).
    damping = np.array([389.7e3, 402.7e3])
    passive, active = 455328e3, 1751e3
    if not direct:
        passive, active = in_series(passive, 150000e3), in_series(active, 150000e3)
    springs = (
        Kinked(-1, 0, passive, active), Kinked(1, -1, passive, active), Kinked(0, 1, 1051e3, 1051e3)
    )  # fmt: skip
    return Row(
        mass, 0.05 * initial, 0.95 * yielding, yielding / initial, damping, ((0, 1, 0.0127),), 0.7,
        springs,
    )  # fmt: skip


def of_bridge(name: str, count: int, rng: np.random.Generator) -> Iterator[Point]:
    """Displacements of figure 11 at random times, or peaks of figure 12 under random motions."""
    suite = load_case(CASES / name)
    members = suite.suite.members(suite.directory)
    response_wanted = name != "figure-12"
    for number in [0] if response_wanted else rng.choice(len(members), count, replace=False):
        member = members[int(number)]
        case = member_case(suite, member, member.read())
        end = case.run.duration
        # Figure 11 draws what follows the first impacts; its tail holds little.
        times = np.sort(rng.uniform(2.0, min(20.0, end), count)) if response_wanted else None
        yield from _bridge_points(name, member.name, case, times)


def _bridge_points(name: str, record: str, case: Case, times: np.ndarray | None) -> Iterator[Point]:
    motion, end = case.scene.motion, case.run.duration
    assert isinstance(motion, Record)

    rows = np.array([0.0, end]) if times is None else times

    def measure(scene: Scene) -> tuple[np.ndarray, np.ndarray]:
        task = Task(scene, 0.0, end, case.solver.rtol, output_times=rows)
        recording = solver_named("fast").solve(task)
        u = recording.history.u[np.searchsorted(recording.history.t, rows)]
        extremes = recording.displacement
        peaks = np.maximum(extremes.maximum, -extremes.minimum)
        return (peaks if times is None else u.ravel()), u

    ours, _ = measure(case.scene)
    stated = conditioning(case.scene, measure).largest_slope
    scales = motion.scales()
    samples = np.asarray(motion.values, dtype=np.float64)
    program = Program(bridge_row("direct" in name), scales.length, scales.omega_g)
    answer: Answer = program.run(sampled(samples, motion.time_step, end, times), times)
    theirs = answer.peak if times is None else np.array(answer.rows).ravel()
    for i, (one, other) in enumerate(zip(ours, theirs, strict=True)):
        scale = float(answer.peak[i % 2])
        allowed = max(ALLOWED_BRIDGE, 10.0 * stated[i] / scale * case.solver.rtol)
        at = "peak" if times is None else f"u at {times[i // 2]:.3f} s"
        yield Point(f"{name}: {record}, segment {1 + i % 2}, {at}", one, other, scale, allowed)


def drawn(count: int, seed: int) -> Iterator[Point]:
    """`count` points of each study, a quarter of them of each figure of the bridge."""
    rng = np.random.default_rng(seed)
    for name in STUDIES:
        study = load_study(CASES / name).study
        for run in rng.choice(study.size, count, replace=False).tolist():
            yield of_study(name, study, run)
    for name in BRIDGES:
        yield from of_bridge(name, max(1, count // 4), rng)


def main(count: int = 20, seed: int = 1) -> int:
    """Print every point, and the largest difference of each figure."""
    worst: dict[str, list[Point]] = {}
    for point in drawn(count, seed):
        worst.setdefault(point.what.partition(":")[0], []).append(point)
        print(f"{point.what}: {point.ours:.10g} {point.theirs:.10g} {point.apart:.1e}", flush=True)
    print("\n| figure | numbers | median difference | largest | allowed, at least | beyond |")
    print("|" + " --- |" * 6)
    for name, points in worst.items():
        apart = [p.apart for p in points]
        beyond = sum(p.apart > p.allowed for p in points)
        print(
            f"| `{name}` | {len(points)} | {np.median(apart):.1e} | {max(apart):.1e} "
            f"| {min(p.allowed for p in points):.0e} | {beyond} |"
        )
    return int(any(p.apart > p.allowed for points in worst.values() for p in points))


if __name__ == "__main__":
    sys.exit(main(*map(int, sys.argv[1:])))
