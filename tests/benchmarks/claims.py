"""What the founding paper says of its spectra, as numbers from the studies among the cases.

    python -m tests.benchmarks.claims [NAME ...]

makes the tables that a claim needs (in a temporary directory) and prints, claim by
claim, what they show; the names are those of `CLAIMS`, all without any. "Amplified"
and "reduced" mean by more than 5 %, "unseen" by less than 0.1 L_e; a gain is the
peak with contact over that without. docs/figures.md has the verdicts.
"""

import argparse
import tempfile
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import numpy as np
import pandas as pd

from eventpound.report.study_figure import MATTERS, VISIBLE
from eventpound.study.engine import Batch
from eventpound.study.reading import load_study
from eventpound.study.running import run_study
from eventpound.study.table import read_table
from tests.models import CASES

CASE = """
[excitation]
{excitation}
[pi]
{pi}
epsilon = 0.7
periods = 10
[solver]
name = "fast"
rtol = 1e-8
[study]
quantities = ["pi_um", "free.pi_um", "amplification"]
{axes}
"""
STRETCHES = (("0 to 0.5", 0.0, 0.5), ("near 1", 0.9, 1.1), ("1.5 to 3", 1.5, 9.0))
LOWEST = 0.25
"""Π_ωs from which on the most dangerous one is looked for; below it a spectrum has no peak."""
PULSES = (
    '[[study.axis]]\nkey = "excitation.kind"\nvalues = ["sine", "cosine"]\n'
    '[[study.axis]]\nkey = "excitation.reverse"\nvalues = [false, true]\n'
)
COSINE = 'kind = "cosine"'
AXIS = '[[study.axis]]\nkey = "{}"\nvalues = {}\n'
RANGE = '[[study.axis]]\nkey = "{}"\nfrom = {}\nto = {}\ncount = {}\n'


def table_of(folder: Path, name: str, text: str | None = None) -> pd.DataFrame:
    """Table of a case of ours, or of one by its text."""
    source = CASES / name
    if text is not None:
        source = folder / "cases" / name
        source.mkdir(parents=True)
        (source / "case.toml").write_text(text)
    out = folder / name
    run_study(load_study(source).study, out, Batch())
    return read_table(out)


def shares(table: pd.DataFrame, of: str = "") -> str:
    """Shares of points amplified, reduced, neither and unseen, and the median gain."""
    gain = table["amplification" + of]
    up, down = float((gain > 1.0 + MATTERS).mean()), float((gain < 1.0 - MATTERS).mean())
    unseen = np.abs(table["pi_um" + of] - table["free.pi_um" + of]) < VISIBLE
    return (
        f"amplified {up:4.0%}, reduced {down:4.0%}, neither {1 - up - down:4.0%}, "
        f"unseen {unseen.mean():4.0%}; median gain {gain.median():.2f}"
    )


def complete_similarity(folder: Path) -> Iterator[str]:
    """Largest change of Pi_um below a limit of Pi_delta or Pi_uy, from its smallest value."""
    table = table_of(folder, "complete-similarity")
    gap, yielding = (table[table.part == part] for part in ("gap", "yield displacement"))
    axes = AXIS.format("excitation.kind", '["sine", "cosine"]')
    axes += AXIS.format("pi.Q", [0.05, 0.1, 0.2])
    text = CASE.format(
        excitation='kind = "sine"\nreverse = true',
        pi='structure = "bilinear"\nomega_s = 0.5\ndelta = 0.1',
        axes=axes + RANGE.format("pi.uy", 0.002, 0.5, 120),
    )
    bilinear = table_of(folder, "bilinear-yield", text)
    text = text.replace("delta = 0.1", "uy = 0.1").replace('"pi.uy"', '"pi.delta"')
    bilinear_gap = table_of(folder, "bilinear-gap", text)
    for name, some in (("elastoplastic", gap), ("bilinear, Pi_omega_s 0.5", bilinear_gap)):
        for limit in (0.1, 0.5):
            yield f"Pi_delta < {limit}, Pi_uy 0.1, {name}: " + changes(some, "pi.delta", limit)
    for name, some in (("elastoplastic", yielding), ("bilinear, Pi_omega_s 0.5", bilinear)):
        yield f"Pi_uy < 0.1, {name}: " + changes(some, "pi.uy", 0.1)
        yield f"Pi_uy < 0.1, {name}, no contact: " + changes(some, "pi.uy", 0.1, "free.pi_um")


def small_gaps(folder: Path) -> Iterator[str]:
    """The same of the gap at the Pi_uy that the paper names, for every restitution and strength."""
    axes = PULSES + AXIS.format("pi.epsilon", [0.0, 0.3, 0.6, 0.7, 0.8, 1.0])
    axes += RANGE.format("pi.Q", 0.05, 1.0, 39)
    text = CASE.format(
        excitation=COSINE,
        pi='structure = "elastoplastic"\nuy = 0.2',
        axes=axes + RANGE.format("pi.delta", 0.002, 0.502, 101),
    )
    text = text.replace('kind = "cosine"\n', "").replace("epsilon = 0.7\n", "")
    table = table_of(folder, "small-gaps", text)
    for limit in (0.1, 0.5):
        for (reverse, ratio), part in table.groupby(["excitation.reverse", "pi.epsilon"]):
            found = list(_changes(part, "pi.delta", limit, "pi_um"))
            kind, strength, change, relative = max(found, key=lambda curve: curve[3])
            direction = "reverse" if reverse == "True" else "normal"
            yield (
                f"Pi_delta < {limit}, Pi_uy 0.2, restitution {ratio:g}, {direction}: median "
                f"{np.median([curve[3] for curve in found]):.0%}, largest {relative:.0%} "
                f"({change:.2f} L_e; {kind}, Pi_Q {strength:.3g})"
            )


def changes(table: pd.DataFrame, key: str, limit: float, column: str = "pi_um") -> str:
    """Largest change of a column along an axis up to a limit, relative and in L_e."""
    return ", ".join(
        f"{kind} Q {strength:g}: {relative:.0%} ({change:.2f})"
        for kind, strength, change, relative in _changes(table, key, limit, column)
    )


def _changes(
    table: pd.DataFrame, key: str, limit: float, column: str
) -> Iterator[tuple[str, float, float, float]]:
    """Pulse and strength of each curve, and its largest change, in L_e and relative."""
    for (kind, strength), curve in table.groupby(["excitation.kind", "pi.Q"]):
        below = curve[curve[key] <= limit].sort_values(key)[column].to_numpy()
        change = float(np.abs(below - below[0]).max())
        yield str(kind), float(strength), change, change / float(below[0])


def regions(folder: Path) -> Iterator[str]:
    """Weak, intermediate and strong structures beside a barrier."""
    for name, key, borders in (
        ("figure-04", "pi.Q", (0.0, 0.3, 1.2, 3.0)),
        ("figure-05", "pi.omega_s", (0.0, 0.3, 1.5, 2.0, 4.1)),
    ):
        table = table_of(folder, name)
        near = table[(table["pi.delta"] <= 0.5) & (table["pi.uy"] == 0.2)]
        for (kind, reverse), panel in near.groupby(["excitation.kind", "excitation.reverse"]):
            for low, high in pairwise(borders):
                inside = panel[(panel[key] >= low) & (panel[key] < high)]
                direction = "reverse" if reverse == "True" else "normal"
                yield f"{name} {kind} {direction}, {key} {low:g} to {high:g}: " + shares(inside)


def neighbours(folder: Path) -> Iterator[str]:
    """Flexible and stiff structures under short and long pulses; separation; near 1; shape."""
    for name in ("figure-07", "figure-08", "figure-09"):
        table = table_of(folder, name)
        for ratio, half in table.groupby("pi.omega_s.i"):
            which = "flexible" if ratio < 1.0 else "stiff"
            for label, low, high in STRETCHES:
                inside = half[(half["pi.omega_s"] >= low) & (half["pi.omega_s"] <= high)]
                yield f"{name} {which}, Pi_omega_s {label}: " + shares(inside)
            effect = np.abs(np.log(half["amplification"])).mean()
            yield f"{name} {which}: mean |ln gain| {effect:.3f}"
            yield f"{name} {which}: {widths(half)}"


def widths(half: pd.DataFrame) -> str:
    """Mean width in Pi_omega_s over which a spectrum is above half of its largest value."""
    keys = [k for k in ("excitation.kind", "excitation.reverse", "pi.delta") if k in half]
    found: dict[str, list[float]] = {"pi_um": [], "free.pi_um": []}
    for _, curve in half.groupby(keys):
        step = np.gradient(curve["pi.omega_s"].to_numpy())
        for column, several in found.items():
            values = curve[column].to_numpy()
            several.append(float(step[values > 0.5 * values.max()].sum()))
    return "width at half height {:.2f} with contact, {:.2f} without".format(
        *(np.mean(several) for several in found.values())
    )


def most_dangerous(folder: Path) -> Iterator[str]:
    """Pi_omega_s of the largest Pi_um, with contact and without, and what becomes of that."""
    for name in ("figure-07", "figure-08", "figure-09"):
        table = table_of(folder, name)
        table = table[table["pi.omega_s"] >= LOWEST]
        keys = ["pi.omega_s.i", "excitation.kind"]
        keys += [key for key in ("excitation.reverse",) if key in table]
        for values, panel in table.groupby(keys):
            which = "flexible" if values[0] < 1.0 else "stiff"
            free = panel[panel["pi.delta"] == panel["pi.delta"].min()]
            at = free["free.pi_um"].idxmax()
            found = []
            for delta, curve in panel.groupby("pi.delta"):
                top = curve.loc[curve["pi_um"].idxmax()]
                gain = top["pi_um"] / free["free.pi_um"][at]
                found.append(f"Pi_delta {delta:g}: {top['pi.omega_s']:.2f} (peak x {gain:.2f})")
            words = " ".join(
                "reverse" if v == "True" else str(v) for v in values[1:] if v != "False"
            )
            yield f"{name} {which} {words}: free {free['pi.omega_s'][at]:.2f}; " + ", ".join(found)


def next_door(folder: Path) -> Iterator[str]:
    """A structure excited near its own frequency, and its neighbour."""
    axes = PULSES + AXIS.format("pi.omega_s.i", [0.3, 0.5, 0.7, 1.43, 2.0, 3.33])
    axes += AXIS.format("pi.delta", [0.1, 0.5, 1.0]) + RANGE.format("pi.omega_s", 0.9, 1.1, 9)
    text = CASE.format(
        excitation=COSINE, pi='structure = "bilinear"\nrow = [0, 1]\nuy = 0.1\nQ = 0.1', axes=axes
    )
    text = text.replace('kind = "cosine"\n', "").replace(
        '"amplification"]', '"amplification", "amplification.1", "pi_um.1", "free.pi_um.1"]'
    )
    table = table_of(folder, "next-door", text)
    for ratio, part in table.groupby("pi.omega_s.i"):
        own, neighbour = part["amplification"], part["amplification.1"]
        both = ((own < 1.0) & (neighbour > 1.0)).mean()
        yield (
            f"omega_0/omega_1 = {ratio:g}, {len(part)} runs: hindered while its neighbour is "
            f"accentuated {both:.0%}; median gains {own.median():.2f} and {neighbour.median():.2f}"
        )
        yield "    itself: " + shares(part)
        yield "    neighbour: " + shares(part, ".1")


def masses(folder: Path) -> Iterator[str]:
    """A pair of nearly equal frequencies and of equal and different masses."""
    axes = AXIS.format("pi.m.1", [0.1, 1.0, 10.0]) + AXIS.format("pi.delta", [0.1, 0.5])
    text = CASE.format(
        excitation=COSINE,
        pi='structure = "elastic"\nrow = [0, 1]\n"omega_s.1" = 0.9',
        axes=axes + RANGE.format("pi.omega_s", 0.2, 3.0, 141),
    )
    table = table_of(folder, "masses", text)
    for ratio, part in table.groupby("pi.m.1"):
        effect = np.abs(np.log(part["amplification"])).mean()
        yield f"elastic pair, omega_s,0/omega_s,1 = 0.9, m_0/m_1 = {ratio:g}: {effect:.3f}"


def limit(folder: Path) -> Iterator[str]:
    """Bilinear structures of ever less stiffness after yield against the elastoplastic one."""
    quantity = AXIS.format("pi.Q", [0.2, 0.4, 0.8]) + AXIS.format("pi.delta", [0.1, 0.5])
    plastic = table_of(
        folder,
        "plastic",
        CASE.format(excitation=COSINE, pi='structure = "elastoplastic"\nuy = 0.2', axes=quantity),
    )
    stiffness = AXIS.format("pi.omega_s", [0.1, 0.01, 0.001])
    bilinear = table_of(
        folder,
        "bilinear",
        CASE.format(
            excitation=COSINE, pi='structure = "bilinear"\nuy = 0.2', axes=stiffness + quantity
        ),
    )
    for omega, part in bilinear.groupby("pi.omega_s"):
        apart = np.abs(part["pi_um"].to_numpy() / plastic["pi_um"].to_numpy() - 1.0).max()
        yield f"Pi_omega_s = {omega:g}: largest difference {apart:.1e}"


def more_than_bilinear(folder: Path) -> Iterator[str]:
    """Gains of elastoplastic and bilinear structures of one strength."""
    reversed_too = AXIS.format("excitation.kind", '["sine", "cosine"]') + AXIS.format(
        "excitation.reverse", "[false, true]"
    )
    quantity = RANGE.format("pi.Q", 0.05, 1.0, 96) + AXIS.format("pi.delta", [0.1, 0.5])
    for omega in (0.0, 0.25, 0.5, 1.0):
        kind = "elastoplastic" if omega == 0.0 else "bilinear"
        terms = f'structure = "{kind}"\nuy = 0.2' + (f"\nomega_s = {omega}" if omega else "")
        text = CASE.format(excitation=COSINE, pi=terms, axes=reversed_too + quantity)
        text = text.replace('kind = "cosine"\n', "")
        table = table_of(folder, f"gain-{omega}", text)
        yield f"Pi_omega_s = {omega:g}: " + shares(table)


def directivity(folder: Path) -> Iterator[str]:
    """How far the two directions of a pulse are apart, for pulses of more and more cycles."""
    axes = AXIS.format("excitation.reverse", "[false, true]")
    axes += AXIS.format("pi.delta", [0.1, 0.5, 1.0]) + RANGE.format("pi.Q", 0.1, 1.5, 141)
    for name, excitation in (
        ("sine", 'kind = "sine"'),
        ("cosine", 'kind = "cosine"'),
        *((f"type-C{n}", f'kind = "type-c"\ncycles = {n}') for n in (1, 2, 3, 4)),
    ):
        text = CASE.format(
            excitation=excitation, pi='structure = "elastoplastic"\nuy = 0.2', axes=axes
        )
        table = table_of(folder, f"direction-{name}", text)
        one, other = (part["pi_um"].to_numpy() for _, part in table.groupby("excitation.reverse"))
        yield f"{name}: mean |ln(normal/reverse)| {np.abs(np.log(one / other)).mean():.3f}"


CLAIMS = {
    "similarity": ("The response does not depend on small Pi_delta, Pi_uy", complete_similarity),
    "small-gaps": ("The same at the paper's Pi_uy, for every restitution", small_gaps),
    "regions": ("Weak amplified, intermediate reduced, strong indifferent", regions),
    "neighbours": ("Flexible and stiff, short and long pulses; near 1; shape", neighbours),
    "most-dangerous": ("Contact shifts the most dangerous frequency", most_dangerous),
    "next-door": ("Hindered near its own frequency, accentuated next door", next_door),
    "masses": ("Contact matters more where masses differ", masses),
    "limit": ("Elastoplastic is the limit of bilinear", limit),
    "more-than-bilinear": ("Elastoplastic amplified more than bilinear", more_than_bilinear),
    "directivity": ("Directivity is weaker for pulses of more cycles", directivity),
}


def main(arguments: list[str] | None = None) -> None:
    """Print what is computed of the claims that are named, or of all."""
    parser = argparse.ArgumentParser(prog="python -m tests.benchmarks.claims")
    parser.add_argument("names", nargs="*", metavar="NAME", help=", ".join(CLAIMS))
    names = parser.parse_args(arguments).names or list(CLAIMS)
    if unknown := [name for name in names if name not in CLAIMS]:
        parser.error(f"{unknown[0]}: no claim; accepted: {', '.join(CLAIMS)}")
    with tempfile.TemporaryDirectory() as folder:
        for name in names:
            title, claim = CLAIMS[name]
            print(f"\n{name}: {title}")
            for line in claim(Path(folder) / name):
                print(f"  {line}", flush=True)


if __name__ == "__main__":
    main()
