"""A comparison as tables: one row a run, one a quantity, one an impact; and as text."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from eventpound.accuracy.compare import Comparison
from eventpound.accuracy.quantities import FINAL, PEAKS
from eventpound.accuracy.work_precision import Judged
from eventpound.results.cells import Cells, lines_of

if TYPE_CHECKING:
    import pandas as pd

    from eventpound.accuracy.reference import Reference
    from eventpound.score import Difference, Pair, Paired

KINDS = ("rest", "detachment")

REST_HEADINGS = ("rests", "detachments", "rest shift (s)")
"""Left out of the text table where nothing rests."""
RIGID_HEADINGS = ("rigid peaks", "rigid graph", "rigid impacts")
"""Left out of the text table where no contact has a law of its own."""
LAWS = "(contact laws)"
"""What the row of the laws themselves is called, which are judged by the rigid law alone."""
HEADINGS = (
    "solver",
    "tolerance",
    "peaks",
    "final",
    "graph",
    "sup",
    "impacts",
    "shift (s)",
    *REST_HEADINGS,
    *RIGID_HEADINGS,
    "time (ms)",
    "first (ms)",
    "forces",
    "steps",
)
"""Columns of the text table."""


def run_table(comparison: Comparison) -> pd.DataFrame:
    """One row a run, columns described on the page "compare" of the docs."""
    import pandas as pd

    rows = [_run_row(run) for run in comparison.runs]
    if comparison.laws is not None:
        rigid = [run.rigid for run in comparison.runs]
        rows.append({"solver": LAWS})
        rows = [
            row | _rigid_columns(errors)
            for row, errors in zip(rows, (*rigid, comparison.laws), strict=True)
        ]
    table = pd.DataFrame(rows)
    # Counts stay whole numbers where a run has none.
    counts = [name for name in table.columns if name.endswith(("_matched", "_missed", "_extra"))]
    return table.astype(dict.fromkeys((*counts, "rhs", "steps"), "Int64"))


def _run_row(run: Judged) -> dict[str, object]:
    entry, errors, work = run.entry, run.errors, run.work
    return {
        "solver": run.label,
        "rtol": entry.rtol if entry else None,
        "time_step": entry.time_step if entry else None,
        **_error_columns(errors),
        **_rest_columns(errors.rests if errors else None),
        "seconds": run.seconds,
        "first_seconds": run.first_seconds,
        "repeats": run.repeats,
        "rhs": work.rhs if entry else None,
        "steps": work.steps if entry else None,
        "remark": run.remark,
    }


def _error_columns(errors: Difference | None) -> dict[str, object]:
    """The errors against one reference; empty where they are not known."""
    return {
        "peak_error": errors.largest(PEAKS) if errors else None,
        "final_error": errors.largest(FINAL) if errors else None,
        "graph_distance": errors.distance.graph if errors else None,
        "graph_distance_at": errors.distance.graph_time if errors else None,
        "sup_distance": errors.distance.sup if errors else None,
        "impacts_matched": errors.impacts.matched if errors else None,
        "impacts_missed": errors.impacts.missed if errors else None,
        "impacts_extra": errors.impacts.extra if errors else None,
        "impact_shift": errors.impacts.largest_shift if errors else None,
    }


def _rigid_columns(errors: Difference | None) -> dict[str, object]:
    """The errors against the rigid law, without the time of the graph's distance."""
    return {
        f"rigid_{name}": error
        for name, error in _error_columns(errors).items()
        if name != "graph_distance_at"
    }


def _rest_columns(rests: Paired | None) -> dict[str, object]:
    """Beginnings and ends of rests, counted as impacts are; empty where they are not known."""
    row: dict[str, object] = {}
    for kind in KINDS:
        row[f"{kind}s_matched"] = rests.of(kind).matched if rests else None
        row[f"{kind}s_missed"] = rests.of(kind).missed if rests else None
        row[f"{kind}s_extra"] = rests.of(kind).extra if rests else None
        row[f"{kind}_shift"] = rests.of(kind).largest_shift if rests else None
    return row


def quantity_table(comparison: Comparison) -> pd.DataFrame:
    """One row a run and quantity: value, reference, error as a part of scale, bound."""
    import pandas as pd

    rows = [
        (run.label, run.size, q.name, off.value, q.value, off.error, q.scale, q.bound)
        for run in comparison.runs
        if run.errors is not None
        for off in run.errors.quantities
        for q in [off.quantity]
    ]
    names = ("solver", "size", "quantity", "value", "reference", "error", "scale", "bound")
    return pd.DataFrame(rows, columns=list(names))


def impact_table(comparison: Comparison) -> pd.DataFrame:
    """One row a run and impact: the reference's time and speed, and the run's."""
    import pandas as pd

    contacts = [contact.name for contact in comparison.case.scene.contacts]
    rows = [
        (run.label, run.size, contacts[pair.contact], *_impact_cells(pair))
        for run in comparison.runs
        if run.errors is not None
        for pair in run.errors.impacts.listed
    ]
    names = ("solver", "size", "contact", "t_reference", "t", "shift", "speed_reference", "speed")
    return pd.DataFrame(rows, columns=list(names))


def _impact_cells(pair: Pair) -> tuple[float | None, ...]:
    a, b = pair.reference, pair.found
    return (
        *_times(pair),
        -a.gap_velocity_before if a else None,
        -b.gap_velocity_before if b else None,
    )


def _times(pair: Pair) -> tuple[float | None, ...]:
    a, b = pair.reference, pair.found
    return a.t if a else None, b.t if b else None, pair.shift


def rest_table(comparison: Comparison) -> pd.DataFrame:
    """One row a run and beginning or end of a rest: the reference's time, and the run's."""
    import pandas as pd

    contacts = [contact.name for contact in comparison.case.scene.contacts]
    rows = [
        (
            run.label,
            run.size,
            contacts[pair.contact],
            pair.kind,
            *_times(pair),
        )
        for run in comparison.runs
        if run.errors is not None and run.errors.rests is not None
        for pair in run.errors.rests.listed
    ]
    names = ("solver", "size", "contact", "kind", "t_reference", "t", "shift")
    return pd.DataFrame(rows, columns=list(names))


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
    rows = [list(HEADINGS), *(_cells(run) for run in comparison.runs)]
    if comparison.laws is not None:
        rows.append([LAWS, "alone", *["-"] * 9, *_rigid_cells(comparison.laws), *[""] * 4])
    rows.append(_floor_cells(comparison))
    first = HEADINGS.index(REST_HEADINGS[0])
    rests = {cell for row in rows[1:] for cell in row[first : first + len(REST_HEADINGS)]}
    blank: tuple[str, ...] = () if rests - {"0", "-"} else REST_HEADINGS
    blank += RIGID_HEADINGS if comparison.laws is None else ()
    kept = [i for i, heading in enumerate(HEADINGS) if heading not in blank]
    headings, *others = (tuple(row[i] for i in kept) for row in rows)
    return Cells(headings, tuple(others), tuple(i < 2 for i in kept))


def remarks_of(comparison: Comparison) -> list[str]:
    """What is to be said of single runs, a sentence each."""
    return [
        ": ".join(part for part in (f"{run.label} {run.size}".strip(), run.remark))
        for run in comparison.runs
        if run.remark
    ]


def _cells(run: Judged) -> list[str]:
    errors, timed = run.errors, run.entry is not None and run.repeats > 0
    return [
        run.label,
        run.size,
        *(_error_cells(errors) if errors else ["-"] * 9),
        *_rigid_cells(run.rigid),
        f"{1e3 * run.seconds:.3g}" if timed else "-",
        f"{1e3 * run.first_seconds:.3g}" if timed else "-",
        str(run.work.rhs) if timed else "-",
        str(run.work.steps) if timed else "-",
    ]


def _error_cells(errors: Difference) -> list[str]:
    return [
        brief(errors.largest(PEAKS)),
        brief(errors.largest(FINAL)),
        brief(errors.distance.graph),
        brief(errors.distance.sup),
        event_words(errors.impacts),
        brief(errors.impacts.largest_shift),
        *_rest_cells(errors.rests),
    ]


def _rigid_cells(errors: Difference | None) -> list[str]:
    """Errors against the rigid law."""
    if errors is None:
        return ["-"] * len(RIGID_HEADINGS)
    impacts = event_words(errors.impacts)
    return [brief(errors.largest(PEAKS)), brief(errors.distance.graph), impacts]


def _rest_cells(rests: Paired | None) -> list[str]:
    """Beginnings and ends of rests and the largest shift of either."""
    if rests is None:
        return ["-"] * len(REST_HEADINGS)
    return [*(event_words(rests.of(kind)) for kind in KINDS), brief(rests.largest_shift)]


def event_words(events: Paired) -> str:
    """Matched events, and those missed and extra where there are some: ``4 -1 +2``."""
    missed, extra = events.missed, events.extra
    return f"{events.matched}" + (f" -{missed}" if missed else "") + (f" +{extra}" if extra else "")


def _floor_cells(comparison: Comparison) -> list[str]:
    """The reference's own uncertainty, under the columns it limits."""
    check, rigid = comparison.reference.check, comparison.reference.rigid
    floors = floor_of(comparison.reference, PEAKS), floor_of(comparison.reference, FINAL)
    beside = [brief(floor_of(rigid, PEAKS)), "-", "-"] if rigid else ["-"] * 3
    if rigid and rigid.check:
        beside[1:] = brief(rigid.check.distance.graph), str(rigid.check.impacts.matched)
    other = ["-"] * 7
    if check is not None:
        other = [
            brief(check.distance.graph),
            brief(check.distance.sup),
            str(check.impacts.matched),
            brief(check.impacts.largest_shift),
            *_rest_cells(check.rests),
        ]
    known = [brief(floor) for floor in floors]
    return ["(reference)", "error about", *known, *other, *beside, *[""] * 4]


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
    files = {
        name: table.to_csv(index=False, lineterminator="\n").encode()
        for name, table in tables.items()
    }
    return files | {"comparison.txt": text_table(comparison).encode()}
