"""The report of design numbers, two sheets: what is needed and of what model; under what, how sure.

In units of the trade with three digits, so that it can be handed on as it is.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import pandas as pd

from eventpound.case.case import Case, member_case, member_of
from eventpound.motion.record import Record
from eventpound.quantities.lookup import Named
from eventpound.report.design_figures import demand_figure, governing_figure
from eventpound.report.design_tables import (
    capacity_words,
    contact_words,
    joint_names,
    kind_tables,
    lacking_contacts,
    page_cells,
    shock_cells,
)
from eventpound.report.html import Section, table_of, text_part
from eventpound.report.model_figure import model_figure
from eventpound.report.plan_view import worst_plan_figure
from eventpound.report.record_tables import record_cells, record_names, scaling_words
from eventpound.report.sheets import WIDTH, Block, Columns, Head, Picture, Sheet, Words, share_of
from eventpound.report.view import View
from eventpound.response import Response
from eventpound.results import gather
from eventpound.results.input_tables import input_tables, rest_words
from eventpound.results.inputs import inputs_of
from eventpound.results.manifest import case_in_manifest, sha256, solved_by
from eventpound.results.tables import Cells, Row
from eventpound.results.trade import Trade, three_digits, trade_of
from eventpound.scene.at_rest import told_at_rest
from eventpound.scene.scene import Scene
from eventpound.scene.spring import Backfill, Slider
from eventpound.simulation import response_of
from eventpound.study.base import suite_base
from eventpound.study.demands import NEEDED, demands_of
from eventpound.study.design import FRACTILES
from eventpound.study.large_scales import large_scales_of
from eventpound.study.records import FAILED, SA, sa_of_suite
from eventpound.units import TOLD, Dimension

_PANELS = (
    *(NEEDED, "seats.<seat>.max_opening", "springs.<spring>.ductility"),
    "contacts.<contact>.seat_used",
    *("springs.<spring>.drift_ratio", "contacts.<contact>.max_impulse", "peaks.<body>.abs_max"),
)
"""Demands that are drawn over the records, the first three that there are."""
_MOST_PANELS, _MOST_LISTED, _MOST_WARNINGS = 3, 4, 4
_ROOM = ((2, 16, 2), (2, 11, 2), (2, 7, 2), (1, 5, 2), (1, 4, 1), (1, 3, 1))
"""Largest elements of a kind for each demand; parts in a table of the model; modes of structures:
the first with which one sheet holds them, the sketch at `_LEAST` of its size at least."""
_PARTS = (40, 30, 21)
"""The same of parts, on a sheet of the model alone."""
_LEAST = 0.8
_HIGH, _ALONE = 3.6, 5.4
"""Heights of the sketch (in), beside numbers and on a sheet of the model alone."""
_MOST_OF_SHOCKS = 14
"""Demands that are told by shock."""
_MOTION, _DEMAND = 95.0, 58.0
"""Heights of pictures (mm)."""
_WIDE = 6
"""Columns of a table that stands beside no other."""
_TALL = 0.7
"""Height of a sketch over its width."""
_LEFT_OUT = ("alpha", "mass on it", "F_y/W", "Q (", "height", "offset", "post-yield")
"""Columns of the model that have no room; they begin so."""
LIMITS = (
    "Bodies move along one line. Impacts follow Newton's law of restitution, or the law of a "
    "contact that has one; local damage, torsion and vertical motion are not computed.",
    "Separation needed: the least gap of a joint, all of its contacts together, with which "
    "nothing touches anywhere, all joints that wide. By sum, SRSS and CQC: of the peaks without "
    "contact (EN 1998-1, 4.4.2.7; ASCE 7-16, 12.12.3).",
    "Seat width used is the motion in the earthquake only; the least bearing length, creep, "
    "shrinkage, temperature and the motion of the ground between supports are to be added.",
    "Residuals are those at the end of each run, with what still swings then.",
)
"""What is not in design numbers."""
_OF_LAWS: dict[type, str] = {
    Slider: "Friction bearings keep their vertical load and their coefficient of friction.",
    Backfill: "Soil resists by its force alone; the wall, its mass and its strength, is left out.",
}
"""And where springs have such a law."""
_FEW = 7
"""Records from which on codes take a mean (EN 1998-1:2004, 4.3.3.4.3)."""


@dataclass(frozen=True)
class Told:
    """What a report is made of.

    Parameters
    ----------
    case : Case
        As it was run.
    design : DataFrame
        Its design numbers.
    runs : DataFrame, optional
        Table of a suite.
    response : Response or None
        The run, of a suite that under the governing record; None of a study.
    record : str
        Which that is; empty of a single run.
    """

    case: Case
    design: pd.DataFrame
    runs: pd.DataFrame | None
    response: Response | None
    record: str

    @property
    def scene(self) -> Scene:
        """What moves."""
        return self.case.scene

    @property
    def trade(self) -> Trade:
        """Units in which it is told."""
        return trade_of(self.scene, self.case.run.stated)

    @property
    def names(self) -> Mapping[str, str]:
        """What the records are called."""
        return {} if self.runs is None else record_names(self.runs)


def governing_record(scene: Scene, design: pd.DataFrame) -> str:
    """The record under which the contact that lacks most needs most, or the largest peak is."""
    rows = design.set_index("quantity")
    if scene.contacts:
        worst = scene.contacts[lacking_contacts(scene, design)[0]]
        return str(rows.loc[NEEDED.replace("<contact>", worst.name), "under"])
    moved = (f"peaks.{body.name}.abs_max" for body in scene.bodies)
    peaks = rows.loc[[name for name in moved if name in rows.index]]
    return str(peaks.loc[peaks["largest"].idxmax(), "under"])


def motion_under(case: Case, record: str) -> Response:
    """The response to one record of a suite, with its history."""
    member = member_of(case, record)
    return response_of(member_case(case, member, member.read()))


def all_numbers(told: Told) -> Section:
    """All design numbers, as a section of the appendix: a table for each kind of elements."""
    tables = kind_tables(told.scene, told.design, told.names, told.trade)
    parts = [table_of(table.cells) for table in tables]
    if told.response is not None and (shocks := told.response.shock_rows):
        under = f"Under {told.names[told.record]}, " if told.record else ""
        parts += [text_part(f"{under}by shock:"), table_of(_by_shock(told, shocks))]
    return "Design numbers", parts


def _by_shock(told: Told, shocks: Sequence[Mapping[str, Any]]) -> Cells:
    return shock_cells(shocks, told.design, told.trade)


def sheets_of_workbook(told: Told) -> dict[str, list[Row]]:
    """All design numbers and the records, as sheets of a workbook in the units of the report."""
    tables = kind_tables(told.scene, told.design, told.names, told.trade)
    found: dict[str, list[Row]] = {t.name: [t.headings, *t.rows] for t in tables}
    if told.response is not None and (shocks := told.response.shock_rows):
        cells = _by_shock(told, shocks)
        found["Shocks"] = [
            cells.headings,
            *([a, b, c, *map(_value, v)] for a, b, c, *v in cells.rows),
        ]
    if told.runs is not None:
        records = record_cells(told.case, told.runs, told.trade, len(told.runs))
        rows = [row for part in records for row in part.rows]
        found["Records"] = [records[0].headings, *([n, *map(_value, v)] for n, *v in rows)]
    return found


def _value(text: str) -> str | float:
    """A cell of a table as a number, where it is one."""
    try:
        return float(text)
    except ValueError:
        return text


def design_sheets(told: Told) -> list[Sheet]:
    """The two sheets of a report, or three where one cannot hold the numbers and the model."""
    sketch, second = _sketch(told), list(_second(told))
    for most, parts, structures in _ROOM:
        first = [*_first(told, most), *_model(told, sketch, parts, structures)]
        if share_of(first) >= _LEAST:
            return [first, second]
    for parts in _PARTS:
        model = list(model_blocks(told, _ALONE, parts))
        if share_of(model) >= _LEAST:
            break
    return [list(_first(told, _ROOM[0][0])), model, second]


def _first(told: Told, most: int) -> Iterator[Block]:
    """What is needed, with at most so many elements of each kind."""
    yield Head(told.case.title, title=True)
    yield Words(tuple(_asked(told)))
    yield Head("Design numbers")
    numbers = page_cells(told.scene, told.design, told.names, told.trade, most)
    # Of a run they are narrow.
    beside = Columns(tuple((table,) for table in numbers))
    yield from (beside,) if told.runs is None else numbers


def _sketch(told: Told, high: float = _HIGH) -> Picture:
    figure = model_figure(told.scene, trade=told.trade, within=(WIDTH / 25.4, high))
    return Picture(figure, high * 25.4)


def model_blocks(told: Told, high: float = _HIGH, parts: int = _PARTS[-1]) -> Iterator[Block]:
    """The sketch, so high at most (in), and the tables of the parts, with so many rows at most."""
    yield from _model(told, _sketch(told, high), parts, _ROOM[0][2])


def _model(told: Told, sketch: Picture, parts: int, structures: int) -> Iterator[Block]:
    """The sketch and the tables of the parts; a tall sketch stands beside tables."""
    yield Head("Model")
    given = input_tables(_inputs(told.case, structures), told.trade.chosen)
    nothing = min(told.trade.nothing(dimension.unit) for dimension in TOLD)
    tables = [_short(table, nothing, parts) for table in given]
    narrow = [table for table in tables if len(table.headings) <= _WIDE]
    wide, high = sketch.figure.get_size_inches()
    if high > _TALL * wide:
        yield Columns(((sketch,), tuple(narrow)))
    else:
        yield sketch
        yield Columns(tuple(map(tuple, _beside(narrow))))
    yield from (table for table in tables if len(table.headings) > _WIDE)


def _beside(tables: Sequence[Cells]) -> list[list[Cells]]:
    """Tables in two columns: each in that which has fewer rows so far."""
    columns: list[list[Cells]] = [[] for _ in tables[:2]]
    for table in tables:
        min(columns, key=lambda column: sum(len(t.rows) + 2 for t in column)).append(table)
    return columns


def _inputs(case: Case, most: int) -> dict[str, Any]:
    """What was understood, without what says little: modes of single bodies, dashpots of modes."""
    inputs = inputs_of(case)
    structures = [each for each in inputs["structures"] if len(each["bodies"]) > 1]
    inputs["structures"] = structures[:most]
    return inputs | ({"dashpots": []} if structures else {})


def what_governs(told: Told) -> str:
    """The record of a suite whose motion is drawn, with its factor or those of its shocks."""
    if told.runs is None or told.response is None:
        return ""
    (factor,) = told.runs.loc[told.runs["record"] == told.record, "scale"]
    each = [f for _, f in getattr(told.response.scene.motion, "shocks", ())] or [factor]
    times = ", ".join(f"{f:.3g}" for f in each)
    return f"record {told.names[told.record]}, which governs, times {times}"


def _second(told: Told) -> Iterator[Block]:
    """Under what, when, and how sure."""
    assert told.response is not None
    scene, peaks = told.scene, told.response.peaks["abs_max"]
    worst = scene.contacts[lacking_contacts(scene, told.design)[0]] if scene.contacts else None
    view = View(gather(told.response, told.case), told.response.scene)
    yield Head(" under ".join(filter(None, ["Motion", what_governs(told)])))
    motion = governing_figure(view, worst, str(peaks.idxmax()), told.trade)
    yield Picture(motion, _MOTION)
    if (plan := worst_plan_figure(view)) is not None:
        wide, high = plan.get_size_inches()
        yield Picture(plan, min(_MOTION, WIDTH * high / wide))
    if shocks := told.response.shock_rows:
        yield Head("Demands by shock")
        yield shock_cells(shocks, told.design, told.trade, most=_MOST_OF_SHOCKS)
    if told.runs is not None:
        yield Head("Demand over the records")
        panels, (low, high) = _panels(told), FRACTILES
        figure = demand_figure(scene, told.runs, panels, told.trade, _sizes(told))
        yield Picture(figure, _DEMAND)
        lines = f"Dotted lines: {low:g} %, dashed: {high:g} % of them, of several the largest."
        yield Words((f"Numbers of records as below. {lines}",))
        yield Head("Records")
        yield Columns(tuple((table,) for table in record_cells(told.case, told.runs, told.trade)))
    yield Head("Limits and warnings")
    yield Words(tuple(f"• {text}" for text in limits(told)))
    yield Head("Origin")
    yield Words(tuple(_origin(told)))


def _sizes(told: Told) -> tuple[str, float] | None:
    """What Sa of the records is called, and what it was to be; None where it is not known."""
    runs = told.runs
    if runs is None or SA not in runs or runs[SA].isna().all():
        return None
    period, _ = sa_of_suite(told.case)
    return f"Sa({period:.3g} s)", told.case.size.wanted(period)


def _asked(told: Told) -> Iterator[str]:
    """Under how many records of which size, or under which motion, and what pounds."""
    runs, design = told.runs, told.design
    if runs is None:
        yield f"Under {_motion(told)}."
    else:
        scaling = scaling_words(told.case, told.trade).partition(" (")[0] or "every record as it is"
        done = int((runs[FAILED] == "").sum())
        failed = f" of {len(runs)}" if done < len(runs) else ""
        yield f"Under {done}{failed} records; {scaling}."
    for i in lacking_contacts(told.scene, design)[:_MOST_LISTED]:
        contact = told.scene.contacts[i]
        yield f"Contact {contact_words(contact, design, told.trade)}."
    yield from capacity_words(design, told.case.run.stated.fractile)


def _motion(told: Told) -> str:
    """The motion of a single run."""
    motion, record = told.scene.motion, told.case.record
    if isinstance(motion, Record):
        said = (record.event, record.date, record.station, record.component) if record else ()
        name = ", ".join(text for text in said if text) or "a record"
        peak = told.trade.words(motion.peak, Dimension.ACCELERATION.unit)
        return f"{name}, times {three_digits(abs(motion.factor))}, peak {peak}"
    scales = motion.scales()
    if scales is None:
        return "no ground motion" if motion.kind == "none" else f"a motion, {motion.kind}"
    peak = told.trade.words(scales.a_g, Dimension.ACCELERATION.unit)
    return f"a pulse, {motion.kind}, {peak}, period {three_digits(scales.period)} s"


def _short(table: Cells, nothing: float, most: int) -> Cells:
    """A table of the model with three digits, without what the report has no room for."""
    kept = [i for i, head in enumerate(table.headings) if not head.startswith(_LEFT_OUT)]
    rows = tuple(
        tuple(row[i] if table.words[i] else _three(row[i], nothing) for i in kept)
        for row in table.rows[:most]
    )
    more = table.more + max(0, len(table.rows) - most)
    heads, words = [table.headings[i] for i in kept], [table.words[i] for i in kept]
    return Cells(tuple(heads), rows, tuple(words), more)


def _three(cell: str, nothing: float) -> str:
    """A number with three digits at most."""
    short = not cell or (f"{float(cell):.3g}" == cell and "e" not in cell)
    return cell if short else three_digits(float(cell), nothing)


def _panels(told: Told) -> list[list[Named]]:
    """Demands that are drawn, those of one kind together."""
    found = [demand.named for demand in demands_of(told.scene, told.case.run.stated)]
    groups = ([n for n in found if n.quantity.path == path] for path in _PANELS)
    needed = joint_names(told.scene)
    groups = ([n for n in group if n.quantity.path != NEEDED or n.i in needed] for group in groups)
    return [group for group in groups if group][:_MOST_PANELS]


def limits(told: Told, warnings: Sequence[str] = ()) -> Iterator[str]:
    """What is not in the numbers, and what the case was warned of, those that matter first."""
    yield from LIMITS
    laws = {type(spring.law) for spring in told.scene.springs}
    yield from (text for law, text in _OF_LAWS.items() if law in laws)
    resting = told_at_rest(told.scene, told.case.run.start_time)
    if resting["not"] or resting["at_kink"] or resting["at_yield"]:
        yield f"At rest: {rest_words(resting)}."
    if told.runs is not None:
        failed = told.runs[told.runs[FAILED] != ""]
        done = len(told.runs) - len(failed)
        if done < _FEW:
            last = f"{FRACTILES[1]:g} % fractile"
            yield f"{done} records are few: the {last} depends on the largest one or two."
        if large := large_scales_of([suite_base(told.case)]):
            yield f"{large}."
        for row in failed.head(_MOST_WARNINGS).to_dict("records"):
            yield f"Left out, because it failed: {row['record']}: {row[FAILED]}."
    yield from _warnings(warnings or told.case.warnings)


def _warnings(given: Sequence[str]) -> Iterator[str]:
    """Warnings without the name of the file, those of one kind together."""
    alike: dict[str, list[str]] = {}
    for warning in given:
        text = warning.partition(".toml: ")[2] or warning
        where, _, said = text.partition(": ")
        alike.setdefault(said or text, []).append(where)
    # A warning of its own says more than one that many springs have.
    kinds = sorted(alike.items(), key=lambda item: len(item[1]))
    for said, places in kinds[:_MOST_WARNINGS]:
        more = f" and {len(places) - 2} more" if len(places) > 2 else ""
        yield f"{', '.join(places[:2])}{more}: {said}"
    if len(kinds) > _MOST_WARNINGS:
        yield f"{len(kinds) - _MOST_WARNINGS} more warnings, which `eventpound check` shows."


def _origin(told: Told) -> Iterator[str]:
    """What computed it, and the hashes that say of what."""
    solver, record = told.case.solver, told.case.record
    yield solved_by(solver.name, solver.rtol)
    hashes: dict[str, Any] = {"case": case_in_manifest(told.case)["case_sha256"]}
    if told.runs is not None:
        hashes["all records"] = sha256("".join(map(str, told.runs["sha256"])).encode())
    elif record is not None:
        hashes["record"] = record.sha256
    yield f"SHA-256: {', '.join(f'{name} {value[:16]}' for name, value in hashes.items())}."
