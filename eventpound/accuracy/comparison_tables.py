"""A comparison as tables: one row a run, one a quantity, one an impact; and as text."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from eventpound.accuracy.compare import Comparison
from eventpound.accuracy.quantities import FINAL, PEAKS
from eventpound.accuracy.work_precision import Judged
from eventpound.results.tables import Cells, lines_of, table_csv

if TYPE_CHECKING:
    import pandas as pd

    from eventpound.accuracy.reference import Reference
    from eventpound.score.difference import Difference
    from eventpound.score.pairing import Pair, Paired

KINDS = ("rest", "detachment")
ERRORS: dict[str, Callable[[Difference], object]] = {
    "peak_error": lambda d: d.largest(PEAKS),
    "final_error": lambda d: d.largest(FINAL),
    "graph_distance": lambda d: d.distance.graph,
    "graph_distance_at": lambda d: d.distance.graph_time,
    "sup_distance": lambda d: d.distance.sup,
    "impacts_matched": lambda d: d.impacts.matched,
    "impacts_missed": lambda d: d.impacts.missed,
    "impacts_extra": lambda d: d.impacts.extra,
    "impact_shift": lambda d: d.impacts.largest_shift,
}
"""Columns of what is wrong with a run, against either law; empty where that is not known."""
READ: dict[str, Callable[[Difference], str]] = {
    "peaks": lambda d: brief(d.largest(PEAKS)),
    "final": lambda d: brief(d.largest(FINAL)),
    "graph": lambda d: brief(d.distance.graph),
    "sup": lambda d: brief(d.distance.sup),
    "impacts": lambda d: event_counts(d.impacts),
    "shift (s)": lambda d: brief(d.impacts.largest_shift),
    "rests": lambda d: event_counts(d.rests and d.rests.of("rest")),
    "detachments": lambda d: event_counts(d.rests and d.rests.of("detachment")),
    "rest shift (s)": lambda d: brief(d.rests.largest_shift if d.rests else math.nan),
}
"""The same in the text table; the last three are left out where nothing rests."""
RIGID = ("peaks", "graph", "impacts")
"""What of it is said against the rigid law, where a contact has a law of its own."""
COST = ("time (ms)", "first (ms)", "forces", "steps")
LAWS = "(contact laws)"
"""What the row of the laws themselves is called, which are judged by the rigid law alone."""


def run_table(comparison: Comparison) -> pd.DataFrame:
    """One row a run, columns described on the page "compare" of the docs."""
    import pandas as pd

    rows = [_run_row(run) for run in comparison.runs]
    if comparison.laws is not None:
        rigid = [*(run.rigid for run in comparison.runs), comparison.laws]
        rows.append({"solver": LAWS})
        for row, errors in zip(rows, rigid, strict=True):
            beside = {f"rigid_{k}": v for k, v in _columns(errors).items()}
            del beside["rigid_graph_distance_at"]
            row |= beside
    table = pd.DataFrame(rows)
    # Counts stay whole numbers where a run has none.
    counts = [name for name in table.columns if name.endswith(("_matched", "_missed", "_extra"))]
    return table.astype(dict.fromkeys((*counts, "rhs", "steps"), "Int64"))


def _columns(errors: Difference | None) -> dict[str, object]:
    return {name: errors and of(errors) for name, of in ERRORS.items()}


def _run_row(run: Judged) -> dict[str, object]:
    entry, errors, work = run.entry, run.errors, run.work
    rests: dict[str, object] = {}
    for kind in KINDS:
        # Empty where they are not known.
        found = errors.rests.of(kind) if errors and errors.rests else None
        for word in ("matched", "missed", "extra"):
            rests[f"{kind}s_{word}"] = found and getattr(found, word)
        rests[f"{kind}_shift"] = found and found.largest_shift
    return {
        "solver": run.label,
        "rtol": entry and entry.rtol,
        "time_step": entry and entry.time_step,
        **_columns(errors),
        **rests,
        "seconds": run.seconds,
        "first_seconds": run.first_seconds,
        "repeats": run.repeats,
        "rhs": work.rhs if entry else None,
        "steps": work.steps if entry else None,
        "remark": run.remark,
    }


def _table(
    comparison: Comparison, names: str, cells: Callable[[Difference], list[tuple[object, ...]]]
) -> pd.DataFrame:
    """Rows of all runs that were judged."""
    import pandas as pd

    rows = [
        (run.label, run.size, *row)
        for run in comparison.runs
        if run.errors is not None
        for row in cells(run.errors)
    ]
    return pd.DataFrame(rows, columns=["solver", "size", *names.split()])


def quantity_table(comparison: Comparison) -> pd.DataFrame:
    """One row a run and quantity: value, reference, error as a part of scale, bound."""
    return _table(
        comparison,
        "quantity value reference error scale bound",
        lambda d: [
            (q.name, off.value, q.value, off.error, q.scale, q.bound)
            for off in d.quantities
            for q in [off.quantity]
        ],
    )


def impact_table(comparison: Comparison) -> pd.DataFrame:
    """One row a run and impact: the reference's time and speed, and the run's."""
    names = [contact.name for contact in comparison.case.scene.contacts]
    return _table(
        comparison,
        "contact t_reference t shift speed_reference speed",
        lambda d: [
            (
                names[p.contact],
                *_times(p),
                *(e and -e.gap_velocity_before for e in (p.reference, p.found)),
            )
            for p in d.impacts.listed
        ],
    )


def rest_table(comparison: Comparison) -> pd.DataFrame:
    """One row a run and beginning or end of a rest: the reference's time, and the run's."""
    names = [contact.name for contact in comparison.case.scene.contacts]
    return _table(
        comparison,
        "contact kind t_reference t shift",
        lambda d: [
            (names[p.contact], p.kind, *_times(p)) for p in (d.rests.listed if d.rests else ())
        ],
    )


def _times(pair: Pair) -> tuple[float | None, float | None, float]:
    return pair.reference and pair.reference.t, pair.found and pair.found.t, pair.shift


def text_table(comparison: Comparison) -> str:
    """The table of runs, to be read, with the floor of each error below it."""
    notes, rigid = remarks_of(comparison), comparison.reference.rigid_words
    lines = [
        f"reference: {comparison.reference.words}",
        *([f"rigid law: {rigid}"] if rigid else []),
        "errors: parts of the largest value; impacts: found, -missed, +invented, slow ones not "
        'counted (the page "compare" of the documentation)',
        "",
        *lines_of(cells_of(comparison)),
        *([""] if notes else []),
        *notes,
    ]
    return "\n".join(lines) + "\n"


def cells_of(comparison: Comparison) -> Cells:
    """The table of runs, to be read: a row a run, and last the floor of each error."""
    reference, laws = comparison.reference, comparison.laws
    rows = [
        [run.label, run.size, *_read(run.errors), *_read(run.rigid, RIGID), *_cost(run)]
        for run in comparison.runs
    ]
    if laws is not None:
        rows.append([LAWS, "alone", *_read(None), *_read(laws, RIGID), *[""] * len(COST)])
    floors = [*_floors(reference), *_floors(reference.rigid, RIGID)]
    rows.append(["(reference)", "error about", *floors, *[""] * len(COST)])
    headings = ["solver", "tolerance", *READ, *(f"rigid {name}" for name in RIGID), *COST]
    first = headings.index("rests")
    restless = not {cell for row in rows for cell in row[first : first + 3]} - {"0", "-"}
    blank = {*headings[first : first + 3]} if restless else set()
    blank |= set() if laws else {f"rigid {name}" for name in RIGID}
    kept = [i for i, heading in enumerate(headings) if heading not in blank]
    head, *others = (tuple(row[i] for i in kept) for row in (headings, *rows))
    return Cells(head, tuple(others), tuple(i < 2 for i in kept))


def _read(errors: Difference | None, names: Sequence[str] = tuple(READ)) -> list[str]:
    return [READ[name](errors) if errors else "-" for name in names]


def _cost(run: Judged) -> list[str]:
    if run.entry is None or not run.repeats:
        return ["-"] * len(COST)
    times = (f"{1e3 * seconds:.3g}" for seconds in (run.seconds, run.first_seconds))
    return [*times, str(run.work.rhs), str(run.work.steps)]


def _floors(reference: Reference | None, names: Sequence[str] = tuple(READ)) -> list[str]:
    """The reference's own uncertainty, under the columns it limits."""
    check = reference.check if reference else None
    cells = dict(zip(names, _read(check, names), strict=True))
    if check:
        cells["impacts"] = str(check.impacts.matched)
    for name in {PEAKS, FINAL} & {*names}:
        cells[name] = brief(floor_of(reference, name) if reference else math.nan)
    return list(cells.values())


def remarks_of(comparison: Comparison) -> list[str]:
    """What is to be said of single runs, a sentence each."""
    return [
        ": ".join(part for part in (f"{run.label} {run.size}".strip(), run.remark))
        for run in comparison.runs
        if run.remark
    ]


def event_counts(events: Paired | None) -> str:
    """Matched events, and those missed and extra where there are some: ``4 -1 +2``."""
    if events is None:
        return "-"
    missed, extra = events.missed, events.extra
    return f"{events.matched}" + (f" -{missed}" if missed else "") + (f" +{extra}" if extra else "")


def floor_of(reference: Reference, part: str) -> float:
    """Largest bound of ``"peaks"`` or ``"final"`` as a part of scale; NaN where not known."""
    floors = [q.bound / q.scale for q in reference.truth.quantities if q.name.startswith(part)]
    known = [floor for floor in floors if not math.isnan(floor)]
    return max(known, default=math.nan)


def brief(value: float) -> str:
    """A number with two digits."""
    return "-" if math.isnan(value) else f"{value:.1e}"


def table_files(comparison: Comparison) -> dict[str, bytes]:
    """The files of a comparison by their names."""
    tables = {
        "quantities.csv": quantity_table(comparison),
        "impacts.csv": impact_table(comparison),
        "rests.csv": rest_table(comparison),
        "comparison.csv": run_table(comparison),
    }
    files = {name: table_csv(table) for name, table in tables.items()}
    return files | {"comparison.txt": text_table(comparison).encode()}
