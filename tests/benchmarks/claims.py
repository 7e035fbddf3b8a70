"""What the founding paper says of its spectra, as numbers from the studies among the cases.

    python -m tests.benchmarks.claims

makes the tables of the figure cases that are not there yet (in a temporary
directory) and prints, claim by claim, what they show. "Amplified" and "reduced"
mean by more than 5 %; a gain is the peak with contact over that without.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import numpy as np
import pandas as pd

from eventpound.study.engines.batch import Batch
from eventpound.study.reading import load_study
from eventpound.study.running import run_study
from eventpound.study.table import read_table

CASES = Path(__file__).parents[2] / "cases"
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


def shares(gain: pd.Series) -> str:
    """Shares of points amplified, reduced and neither, and the median gain."""
    up, down = float((gain > 1.05).mean()), float((gain < 0.95).mean())
    return (
        f"amplified {up:4.0%}, reduced {down:4.0%}, neither {1 - up - down:4.0%}; "
        f"median gain {gain.median():.2f}"
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
            yield f"Pi_delta < {limit}, {name}: " + changes(some, "pi.delta", limit, "pi_um")
    for name, some in (("elastoplastic", yielding), ("bilinear, Pi_omega_s 0.5", bilinear)):
        yield f"Pi_uy < 0.1, {name}: " + changes(some, "pi.uy", 0.1, "pi_um")
        yield f"Pi_uy < 0.1, {name}, no contact: " + changes(some, "pi.uy", 0.1, "free.pi_um")


def changes(table: pd.DataFrame, key: str, limit: float, column: str) -> str:
    """Largest change of a column along an axis up to a limit, curve by curve."""
    found = []
    for (kind, strength), curve in table.groupby(["excitation.kind", "pi.Q"]):
        below = curve[curve[key] <= limit].sort_values(key)[column].to_numpy()
        change = np.abs(below / below[0] - 1.0).max()
        found.append(f"{kind} Q {strength:g}: {change:.0%}")
    return ", ".join(found)


def regions(folder: Path) -> Iterator[str]:
    """Weak, intermediate and strong structures beside a barrier."""
    for name, key, borders in (
        ("figure-04", "pi.Q", (0.0, 0.3, 1.2, 3.0)),
        ("figure-05", "pi.omega_s", (0.0, 0.3, 1.5, 3.0)),
    ):
        table = table_of(folder, name)
        near = table[(table["pi.delta"] <= 0.5) & (table["pi.uy"] == 0.2)]
        for (kind, reverse), panel in near.groupby(["excitation.kind", "excitation.reverse"]):
            for low, high in pairwise(borders):
                inside = panel[(panel[key] >= low) & (panel[key] < high)]
                direction = "reverse" if reverse == "True" else "normal"
                yield (
                    f"{name} {kind} {direction}, {key} {low:g} to {high:g}: "
                    + shares(inside["amplification"])
                )


def neighbours(folder: Path) -> Iterator[str]:
    """Flexible and stiff structures under short and long pulses; separation; near 1; shape."""
    for name in ("figure-07", "figure-08", "figure-09"):
        table = table_of(folder, name)
        for ratio, half in table.groupby("pi.omega_s.i"):
            which = "flexible" if ratio < 1.0 else "stiff"
            for label, low, high in (
                ("0 to 0.5", 0.0, 0.5),
                ("near 1", 0.9, 1.1),
                ("1.5 to 3", 1.5, 9.0),
            ):
                inside = half[(half["pi.omega_s"] >= low) & (half["pi.omega_s"] <= high)]
                yield f"{name} {which}, Pi_omega_s {label}: " + shares(inside["amplification"])
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
        yield f"Pi_omega_s = {omega:g}: " + shares(table["amplification"])


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


CLAIMS = (
    ("The response does not depend on small Pi_delta and Pi_uy", complete_similarity),
    ("Amplification of weak, reduction of intermediate, indifference of strong", regions),
    ("Flexible and stiff structures under short and long pulses; near 1; shape", neighbours),
    ("Contact matters more where masses differ", masses),
    ("Elastoplastic is the limit of bilinear", limit),
    ("Elastoplastic amplified more than bilinear", more_than_bilinear),
    ("Directivity is weaker for pulses of more cycles", directivity),
)

if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as name:
        for i, (title, claim) in enumerate(CLAIMS):
            print(f"\n{title}")
            part = Path(name) / str(i)
            for line in claim(part):
                print(f"  {line}", flush=True)
