"""The report of design numbers, two sheets: what is needed and of what model; under what, how sure.

In units of the trade with three digits, so that it can be handed on as it is.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
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
from eventpound.results.shown_units import Units, three_digits, units_of_scene
from eventpound.results.tables import Cells, Row, sheet_of
from eventpound.scene.at_rest import springs_at_rest
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
    """What the report of a run is made of.

    Parameters
    ----------
    case : Case
        As it was run.
    design : DataFrame
        Its design numbers.
    response : Response
        The motion that is drawn.
    """

    case: Case
    design: pd.DataFrame
    response: Response

    @property
    def scene(self) -> Scene:
        """What moves."""
        return self.case.scene

    @property
    def units(self) -> Units:
        """Units in which it is told."""
        return units_of_scene(self.scene, self.case.run.stated)

    @property
    def names(self) -> Mapping[str, str]:
        """What the records are called."""
        return {}

    @property
    def drawn(self) -> str:
        """The record under which the motion that is drawn was."""
        return ""

    @property
    def governs(self) -> str:
        """That record, with its factor or those of its shocks."""
        return ""

    def under(self) -> str:
        """Under which motion."""
        motion, record = self.scene.motion, self.case.record
        if isinstance(motion, Record):
            said = (record.event, record.date, record.station, record.component) if record else ()
            name = ", ".join(text for text in said if text) or "a record"
            peak = self.units.words(motion.peak, Dimension.ACCELERATION.unit)
            return f"{name}, times {three_digits(abs(motion.factor))}, peak {peak}"
        scales = motion.scales()
        if scales is None:
            return "no ground motion" if motion.kind == "none" else f"a motion, {motion.kind}"
        peak = self.units.words(scales.a_g, Dimension.ACCELERATION.unit)
        return f"a pulse, {motion.kind}, {peak}, period {three_digits(scales.period)} s"

    def numbers(self, cells: Sequence[Cells]) -> Sequence[Block]:
        """Its tables of numbers on a sheet; those of a run are narrow, and stand side by side."""
        return [Columns(tuple((table,) for table in cells))]

    def records(self) -> list[Block]:
        """What is told of the records."""
        return []

    def all_records(self) -> dict[str, list[Row]]:
        """The records, as a sheet of a workbook."""
        return {}

    def limits(self) -> Iterator[str]:
        """What the records do not tell."""
        yield from ()

    def hashes(self) -> dict[str, str]:
        """Of the records."""
        return {} if self.case.record is None else {"record": self.case.record.sha256}


@dataclass(frozen=True)
class ToldOfSuite(Told):
    """What the report of a suite is made of.

    Parameters
    ----------
    runs : DataFrame
        Its table.
    record : str
        That which governs, under which the motion was.
    """

    runs: pd.DataFrame
    record: str

    @property
    def names(self) -> Mapping[str, str]:
        """What the records are called."""
        return record_names(self.runs)

    @property
    def drawn(self) -> str:
        """The record under which the motion that is drawn was."""
        return self.names[self.record]

    @property
    def governs(self) -> str:
        """That record, with its factor or those of its shocks."""
        (factor,) = self.runs.loc[self.runs["record"] == self.record, "scale"]
        each = [f for _, f in getattr(self.response.scene.motion, "shocks", ())] or [factor]
        return f"record {self.drawn}, which governs, times {', '.join(f'{f:.3g}' for f in each)}"

    def under(self) -> str:
        """Under how many records, of which size."""
        scaling = scaling_words(self.case, self.units).partition(" (")[0] or "every record as it is"
        done = int((self.runs[FAILED] == "").sum())
        failed = f" of {len(self.runs)}" if done < len(self.runs) else ""
        return f"{done}{failed} records; {scaling}"

    def numbers(self, cells: Sequence[Cells]) -> Sequence[Block]:
        """Its tables of numbers on a sheet."""
        return cells

    def records(self) -> list[Block]:
        """Demands over the records, and the records."""
        panels, (low, high) = _panels(self), FRACTILES
        figure = demand_figure(self.scene, self.runs, panels, self.units, _sizes(self))
        lines = f"Dotted lines: {low:g} %, dashed: {high:g} % of them, of several the largest."
        tables = record_cells(self.case, self.runs, self.units)
        return [
            Head("Demand over the records"),
            Picture(figure, _DEMAND),
            Words((f"Numbers of records as below. {lines}",)),
            Head("Records"),
            Columns(tuple((table,) for table in tables)),
        ]

    def all_records(self) -> dict[str, list[Row]]:
        """The records, as a sheet of a workbook."""
        parts = map(sheet_of, record_cells(self.case, self.runs, self.units, len(self.runs)))
        return {"Records": [row for i, part in enumerate(parts) for row in part[i > 0 :]]}

    def limits(self) -> Iterator[str]:
        """What the records do not tell: few are done, large factors, why some failed."""
        failed = self.runs[self.runs[FAILED] != ""]
        done = len(self.runs) - len(failed)
        if done < _FEW:
            last = f"{FRACTILES[1]:g} % fractile"
            yield f"{done} records are few: the {last} depends on the largest one or two."
        if large := large_scales_of([suite_base(self.case)]):
            yield f"{large}."
        for row in failed.head(_MOST_WARNINGS).to_dict("records"):
            yield f"Left out, because it failed: {row['record']}: {row[FAILED]}."

    def hashes(self) -> dict[str, str]:
        """Of all records."""
        return {"all records": sha256("".join(map(str, self.runs["sha256"])).encode())}


def told_of_suite(case: Case, design: pd.DataFrame, runs: pd.DataFrame) -> ToldOfSuite:
    """What the report of a suite is made of; the governing record is run again, for its history."""
    record = governing_record(case.scene, design)
    member = member_of(case, record)
    response = response_of(member_case(case, member, member.read()))
    return ToldOfSuite(case, design, response, runs, record)


def governing_record(scene: Scene, design: pd.DataFrame) -> str:
    """The record under which the contact that lacks most needs most, or the largest peak is."""
    rows = design.set_index("quantity")
    if scene.contacts:
        worst = scene.contacts[lacking_contacts(scene, design)[0]]
        return str(rows.loc[NEEDED.replace("<contact>", worst.name), "under"])
    moved = (f"peaks.{body.name}.abs_max" for body in scene.bodies)
    peaks = rows.loc[[name for name in moved if name in rows.index]]
    return str(peaks.loc[peaks["largest"].idxmax(), "under"])


def all_numbers(told: Told) -> Section:
    """All design numbers, as a section of the appendix: a table for each kind of elements."""
    tables = kind_tables(told.scene, told.design, told.names, told.units)
    parts = [table_of(table) for table in tables]
    if shocks := told.response.shock_rows:
        under = f"Under {told.drawn}, " if told.drawn else ""
        by_shock = table_of(shock_cells(shocks, told.design, told.units))
        parts += [text_part(f"{under}by shock:"), by_shock]
    return "Design numbers", parts


def sheets_of_workbook(told: Told) -> dict[str, list[Row]]:
    """All design numbers and the records, as sheets of a workbook in the units of the report."""
    tables = kind_tables(told.scene, told.design, told.names, told.units)
    found = {table.headings[0]: sheet_of(table) for table in tables}
    if shocks := told.response.shock_rows:
        found["Shocks"] = sheet_of(shock_cells(shocks, told.design, told.units))
    return found | told.all_records()


def design_sheets(told: Told) -> list[Sheet]:
    """The two sheets of a report, or three where one cannot hold the numbers and the model."""
    sketch, second = _sketch(told.case), list(_second(told))
    for most, parts, structures in _ROOM:
        first = [*_first(told, most), *_model(told.case, sketch, parts, structures)]
        if share_of(first) >= _LEAST:
            return [first, second]
    for parts in _PARTS:
        model = list(model_blocks(told.case, _ALONE, parts))
        if share_of(model) >= _LEAST:
            break
    return [list(_first(told, _ROOM[0][0])), model, second]


def _first(told: Told, most: int) -> Iterator[Block]:
    """What is needed, with at most so many elements of each kind."""
    yield Head(told.case.title, title=True)
    yield Words(tuple(_asked(told)))
    yield Head("Design numbers")
    yield from told.numbers(page_cells(told.scene, told.design, told.names, told.units, most))


def _sketch(case: Case, high: float = _HIGH) -> Picture:
    units = units_of_scene(case.scene, case.run.stated)
    figure = model_figure(case.scene, units=units, within=(WIDTH / 25.4, high))
    return Picture(figure, high * 25.4)


def model_blocks(case: Case, high: float = _HIGH, parts: int = _PARTS[-1]) -> Iterator[Block]:
    """The sketch, so high at most (in), and the tables of the parts, with so many rows at most."""
    yield from _model(case, _sketch(case, high), parts, _ROOM[0][2])


def _model(case: Case, sketch: Picture, parts: int, structures: int) -> Iterator[Block]:
    """The sketch and the tables of the parts; a tall sketch stands beside tables."""
    yield Head("Model")
    units = units_of_scene(case.scene, case.run.stated)
    given = input_tables(_inputs(case, structures), units.chosen)
    nothing = min(units.nothing(dimension.unit) for dimension in TOLD)
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


def _second(told: Told) -> Iterator[Block]:
    """Under what, when, and how sure."""
    scene, peaks = told.scene, told.response.peaks["abs_max"]
    worst = scene.contacts[lacking_contacts(scene, told.design)[0]] if scene.contacts else None
    view = View(gather(told.response, told.case), told.response.scene)
    yield Head(" under ".join(filter(None, ["Motion", told.governs])))
    motion = governing_figure(view, worst, str(peaks.idxmax()), told.units)
    yield Picture(motion, _MOTION)
    if (plan := worst_plan_figure(view)) is not None:
        wide, high = plan.get_size_inches()
        yield Picture(plan, min(_MOTION, WIDTH * high / wide))
    if shocks := told.response.shock_rows:
        yield Head("Demands by shock")
        yield shock_cells(shocks, told.design, told.units, most=_MOST_OF_SHOCKS)
    yield from told.records()
    yield Head("Limits and warnings")
    yield Words(tuple(f"• {text}" for text in limits(told.case, told.case.warnings, told.limits())))
    yield Head("Origin")
    yield Words(tuple(_origin(told)))


def _sizes(told: ToldOfSuite) -> tuple[str, float] | None:
    """What Sa of the records is called, and what it was to be; None where it is not known."""
    if SA not in told.runs or told.runs[SA].isna().all():
        return None
    period, _ = sa_of_suite(told.case)
    return f"Sa({period:.3g} s)", told.case.size.wanted(period)


def _asked(told: Told) -> Iterator[str]:
    """Under what, and what pounds."""
    yield f"Under {told.under()}."
    for i in lacking_contacts(told.scene, told.design)[:_MOST_LISTED]:
        contact = told.scene.contacts[i]
        yield f"Contact {contact_words(contact, told.design, told.units)}."
    yield from capacity_words(told.design, told.case.run.stated.fractile)


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


def limits(case: Case, warnings: Sequence[str], of_records: Iterable[str] = ()) -> Iterator[str]:
    """What is not in the numbers, and what the case was warned of, those that matter first."""
    yield from LIMITS
    laws = {type(spring.law) for spring in case.scene.springs}
    yield from (text for law, text in _OF_LAWS.items() if law in laws)
    resting = springs_at_rest(case.scene, case.run.start_time)
    if resting["not"] or resting["at_kink"] or resting["at_yield"]:
        yield f"At rest: {rest_words(resting)}."
    yield from of_records
    yield from _warnings(warnings or case.warnings)


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
    solver = told.case.solver
    yield solved_by(solver.name, solver.rtol)
    hashes: dict[str, Any] = {"case": case_in_manifest(told.case)["case_sha256"]} | told.hashes()
    yield f"SHA-256: {', '.join(f'{name} {value[:16]}' for name, value in hashes.items())}."
