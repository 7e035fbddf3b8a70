"""Tables and pictures of docs/measured/speed-against-error.md, new where measured anew.

The page has a block a group of problems, between marks, of tables whose rows begin with the
name of a problem. Rows of problems that were not measured stay as they are; the picture of
a group, a panel a problem, is drawn anew where all of the group was.
"""

from __future__ import annotations

import io
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from PIL import Image

from eventpound.accuracy.certificate import Certificate, CertifiedQuantity
from eventpound.accuracy.certificate_text import significant
from eventpound.accuracy.compare import Comparison
from eventpound.accuracy.comparison_tables import event_words
from eventpound.accuracy.errors import PEAKS
from eventpound.accuracy.work_precision import Judged
from eventpound.report import work_precision as diagram
from eventpound.report.style import new_figure, png, styled
from eventpound.results import write_together
from eventpound.results.summary import summarise
from eventpound.simulation import simulate
from tests.benchmarks.problem import TIGHTEST, Problem
from tests.hard.catalogue import Hard

DOCS = Path(__file__).parents[2] / "docs" / "measured"
PAGE = "speed-against-error.md"
PICTURES = {"problems": "speed-against-error.png", "hard": "speed-against-error-hard.png"}
"""By group."""
FRONT, FRONT_PANEL = "speed-against-error-front.png", (4.6, 3.6)
KINDS = {
    "P1": "elastoplastic structure, barrier: one impact",
    "P2": "the same, pulse reversed",
    "P3": "bilinear structure, barrier: one impact",
    "P4": "elastic structure, barrier: five impacts",
    "P5": "pair of bilinear structures",
    "P6": "triplet of bilinear structures",
    "P7": "bilinear structure, barrier, under a record",
    "PZ": "structure that comes to rest on its barrier",
    "pair": "flexible and stiff structure under a pulse",
    "symmetric-triplet": "three structures in a row, one rest",
    "bridge-record": "two-segment bridge under a record",
    "row-of-eight": "eight bodies without gaps",
}
"""What the problems are, for those who do not know their names."""
ERRORS = (1e-1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-8)


@dataclass(frozen=True)
class Measured:
    """What was found of one problem.

    Parameters
    ----------
    comparison : Comparison
        Every solver at every tolerance or step.
    problem : Problem or None
        Its stored answer.
    hard : Hard or None
        Of a hard scene what is known of it.
    certificate : Certificate or None
        Of a hard scene.
    """

    comparison: Comparison
    problem: Problem | None = None
    hard: Hard | None = None
    certificate: Certificate | None = None


@dataclass(frozen=True)
class Table:
    """A table with what is said above it; `rows` by the name of the problem."""

    words: str
    headings: tuple[str, ...]
    rows: Mapping[str, Sequence[str]]


def marks(group: str) -> tuple[str, str]:
    """What stands before and after the tables of a group."""
    return (
        f"<!-- tables of {group}: tests.benchmarks.work_precision -->",
        f"<!-- end of {group} -->",
    )


def write_page(
    folder: Path, groups: Mapping[str, Sequence[str]], found: Mapping[str, Measured]
) -> None:
    """Put new rows into the tables of the page, and whole groups into their pictures."""
    page = (DOCS / PAGE).read_text(encoding="utf-8")
    files: dict[str, bytes] = {}
    for group, names in groups.items():
        new = {name: found[name] for name in names if name in found}
        if not new:
            continue
        begin, end = marks(group)
        head, _, rest = page.partition(begin)
        old, _, tail = rest.partition(end)
        text = "\n\n".join(_merged(table, old, names) for table in _tables(group, new))
        page = f"{head}{begin}\n\n{text}\n\n{end}{tail}"
        if len(new) == len(names) or folder != DOCS:
            grid = _grid([titled(name, new[name].comparison) for name in new])
            files[PICTURES[group]] = _few_colours(png(grid))
    write_together(folder, {**files, PAGE: page.encode()})


def titled(name: str, comparison: Comparison) -> Comparison:
    """A comparison whose case is called what it is."""
    case = replace(comparison.case, title=f"{KINDS[name]} ({name})" if name in KINDS else name)
    return replace(comparison, case=case)


def front_picture(comparisons: Mapping[str, Comparison]) -> bytes:
    """The few panels that say most, larger."""
    named = [titled(name, comparison) for name, comparison in comparisons.items()]
    return _few_colours(png(_grid(named, FRONT_PANEL)))


def _tables(group: str, found: Mapping[str, Measured]) -> Iterator[Table]:
    yield Table(
        "Time (ms) in which a solver comes within a graph distance, every impact right; - where "
        "none of its runs does.",
        ("problem", "solver", *(f"{error:.0e}" for error in ERRORS)),
        {name: list(_time_rows(part.comparison)) for name, part in found.items()},
    )
    yield Table(
        "The most accurate run of each solver: impacts matched, missed, extra.",
        ("problem", "solver", "at", "graph", "peaks", "impacts", "ms", "forces"),
        {name: list(_best_rows(part.comparison)) for name, part in found.items()},
    )
    if group == "hard":
        yield Table(
            "Certificates (`eventpound verify`): peaks and final values, and numbers of events, "
            "that have a bound; the fewest digits of any; the largest displacement; and what is "
            "known of the scene without any program, with the distance from it.",
            ("scene", "given", "values", "events", "digits", "limited by", "largest", "known"),
            {name: [_certificate_row(name, part)] for name, part in found.items()},
        )
        return
    yield Table(
        "The reference: graph distance of its check, and how far its smallest and final "
        "displacements are from the stored answer of an independent program.",
        ("problem", "check", "stored"),
        {name: [_reference_row(name, part)] for name, part in found.items()},
    )


def _merged(table: Table, old: str, names: Sequence[str]) -> str:
    """The table with the rows that an old text of it has of other problems."""
    header = _row(*table.headings)
    lines = old.partition(header)[2].partition("\n\n")[0].splitlines()
    kept: dict[str, list[str]] = {}
    for line in lines:
        if line.startswith("| ") and "---" not in line:
            kept.setdefault(line.split("|")[1].strip(), []).append(line)
    rows = [row for name in names for row in table.rows.get(name, kept.get(name, []))]
    rule = "|" + " --- |" * len(table.headings)
    return "\n".join([table.words, "", header, rule, *rows])


def milliseconds_at(error: float, runs: Sequence[Judged]) -> float:
    """Least wall time (ms) of a run with this graph distance or less and no impact wrong."""
    times = [
        1e3 * run.seconds
        for run in runs
        if run.errors is not None
        and run.errors.distance.graph <= error
        and not run.errors.impacts.missed + run.errors.impacts.extra
    ]
    return min(times, default=math.nan)


def _lines(comparison: Comparison) -> dict[str, list[Judged]]:
    lines: dict[str, list[Judged]] = {}
    for run in comparison.runs:
        lines.setdefault(run.label, []).append(run)
    return lines


def _time_rows(comparison: Comparison) -> Iterator[str]:
    """Time each solver takes to come within each error."""
    for label, runs in _lines(comparison).items():
        times = [milliseconds_at(error, runs) for error in ERRORS]
        yield _row(comparison.case.title, label, *(_number(time) for time in times))


def _best_rows(comparison: Comparison) -> Iterator[str]:
    """The most accurate run of each solver."""
    for label, runs in _lines(comparison).items():
        judged = [run for run in runs if run.errors is not None]
        if not judged:
            yield _row(comparison.case.title, label, *["-"] * 6)
            continue
        best = min(judged, key=lambda run: run.errors.distance.graph if run.errors else math.inf)
        assert best.errors is not None
        yield _row(
            comparison.case.title,
            label,
            best.size,
            f"{best.errors.distance.graph:.0e}",
            f"{best.errors.largest(PEAKS):.0e}",
            event_words(best.errors.impacts),
            _number(1e3 * best.seconds),
            str(best.work.rhs),
        )


def _reference_row(name: str, part: Measured) -> str:
    check = part.comparison.reference.check
    return _row(name, f"{check.distance.graph:.0e}" if check else "-", _confirmed(part))


def _confirmed(part: Measured) -> str:
    """How far the reference is from the stored answer, as a part of the largest |u|."""
    if part.problem is None:
        return "-"
    reference, answer = part.comparison.reference.truth.recording, part.problem.answer
    apart = np.concatenate(
        (reference.displacement.minimum - answer.u_min, reference.u - answer.final)
    )
    return f"{np.abs(apart).max() / answer.length:.0e}"


def _certificate_row(name: str, part: Measured) -> str:
    certificate = part.certificate
    assert certificate is not None
    bounded = [q for q in certificate.quantities if q.certified]
    worst = min(bounded, key=lambda q: q.digits)
    return _row(
        name,
        "yes" if certificate.certified else "no",
        _share([q for q in certificate.quantities if q.is_value]),
        _share([q for q in certificate.quantities if q.quantity.startswith("events.")]),
        f"{worst.digits:.1f}",
        worst.limited_by,
        _largest_peak(certificate),
        _known(part),
    )


def _share(quantities: Sequence[CertifiedQuantity]) -> str:
    if not quantities:
        return "none"
    return f"{sum(q.certified for q in quantities)} of {len(quantities)}"


def _largest_peak(certificate: Certificate) -> str:
    peaks = [q for q in certificate.quantities if q.is_value and q.quantity.startswith(PEAKS)]
    peak = max(peaks, key=lambda q: abs(q.value))
    bound = "refused" if peak.bound is None else f"± {peak.bound:.0e} m"
    body, which = peak.quantity.split(".")[1:3]
    return f"{which} of {body} {significant(peak.value, peak.bound)} {bound}"


def _known(part: Measured) -> str:
    """Largest distance of a run from the known values."""
    if part.hard is None or not part.hard.values:
        return "-"
    summary = summarise(simulate(part.hard.case, solver="fast", rtol=TIGHTEST))
    apart = max(abs(_entry(summary, key) - value) for key, value in part.hard.values.items())
    return f"{len(part.hard.values)} numbers, off by {apart:.0e}"


def _entry(summary: Any, key: str) -> float:
    for word in key.split("."):
        summary = summary[word]
    return float(summary)


def _number(value: float) -> str:
    return "-" if math.isnan(value) else f"{value:.3g}"


def _row(*cells: object) -> str:
    return "| " + " | ".join(str(cell) for cell in cells) + " |"


@styled()
def _grid(comparisons: Sequence[Comparison], size: tuple[float, float] = (2.6, 2.2)) -> Figure:
    """Graph distance against wall time, a panel of this size (inches) a case."""
    looks = diagram._looks(comparisons)
    columns = min(4, len(comparisons))
    rows = math.ceil(len(comparisons) / columns)
    figure = new_figure(size[0] * columns, size[1] * rows + 0.6)
    panels = figure.subplots(rows, columns, squeeze=False).ravel()
    for axes, comparison in zip(panels, comparisons, strict=False):
        diagram._draw(axes, comparison, diagram.graph_measure(comparison), looks)
        axes.set(title=comparison.case.title, xlabel="", ylabel="")
    for axes in panels[len(comparisons) :]:
        axes.set_axis_off()
    figure.supxlabel("wall time (ms)", fontsize=9.0)
    figure.supylabel("graph distance of the motion", fontsize=9.0)
    handles = diagram._legend(comparisons, looks)
    figure.legend(handles=handles, loc="outside upper center", ncols=max(2, columns))
    return figure


def _few_colours(picture: bytes) -> bytes:
    """The same picture with a palette, a third of its size."""
    buffer = io.BytesIO()
    Image.open(io.BytesIO(picture)).convert("RGB").quantize(64).save(buffer, "png", optimize=True)
    return buffer.getvalue()
