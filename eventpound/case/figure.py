"""``[figure]``, or several ``[[figure]]``: what a case draws, and the numbers that it needs.

=====================  =========  ================================================================
kind                   of         draws
=====================  =========  ================================================================
curves                 a study    columns of its table over each other (`eventpound.study.figure`)
map                    a study    one of them in colours over two axes
record-scales          a suite    two records with their scales, the first with its pulse
similarity-contours    a suite    contours of Pi_delta and Pi_uy, the suite as lines
bridge-response        a suite    the response to the first record in dimensionless terms
suite-spectrum         a suite    the peaks of every body against L_e
=====================  =========  ================================================================

All have ``name``, that of the file, ``claim``, ``note`` and ``title``.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import StrEnum

from eventpound.case.keys import read_keys, text_key
from eventpound.case.table import Table
from eventpound.errors import InputError
from eventpound.motion import GroundMotion, MavroeidisPapageorgiou
from eventpound.motion.pulse_fit import PULSES
from eventpound.units import Dimension, quantity


class FigureKind(StrEnum):
    """What a figure shows."""

    CURVES = "curves"
    MAP = "map"
    RECORD_SCALES = "record-scales"
    SIMILARITY_CONTOURS = "similarity-contours"
    BRIDGE_RESPONSE = "bridge-response"
    SUITE_SPECTRUM = "suite-spectrum"

    @property
    def needs_scene(self) -> bool:
        """Whether bodies have to move for it."""
        return self in (FigureKind.BRIDGE_RESPONSE, FigureKind.SUITE_SPECTRUM)


OF_STUDIES = (FigureKind.CURVES, FigureKind.MAP)
OF_SUITES = (
    *(FigureKind.SUITE_SPECTRUM, FigureKind.RECORD_SCALES),
    *(FigureKind.SIMILARITY_CONTOURS, FigureKind.BRIDGE_RESPONSE),
)
"""Kinds, the first of each what is drawn where a figure does not say."""


def read_kind(table: Table, kinds: Sequence[FigureKind], of: str) -> FigureKind | None:
    """What a figure shows; None where that is wrong, which is noted.

    Parameters
    ----------
    table : Table
        Of the figure.
    kinds : sequence of FigureKind
        What there can be.
    of : str
        Of what these are, for messages.
    """
    given = table.text("kind", "the kind of a figure", kinds[0].value)
    if given in kinds:
        return FigureKind(given)
    if given:
        accepted = f"{', '.join(kind.value for kind in kinds)}, which are drawn of {of}"
        table.reject("kind", accepted)
    return None


def one_or_several(top: Table, key: str) -> list[Table]:
    """The tables of a key, ``[key]`` or several ``[[key]]``."""
    if not top.has(key):
        return []
    return top.tables(key) if isinstance(top.data[key], list) else [top.table(key)]


@dataclass(frozen=True, slots=True)
class LengthRange:
    """Lengths that a kind of joint or isolator has.

    Parameters
    ----------
    name : str
        The kind.
    low, high : float
        Gap or yield displacement (m).
    """

    name: str
    low: float
    high: float


@dataclass(frozen=True, slots=True)
class NamedMotion:
    """A motion that a figure names beside those of the suite.

    Parameters
    ----------
    name : str
        What it is called.
    length : float or None
        Its L_e (m), where that is all that is known of it.
    file : str or None
        Its record, else.
    """

    name: str
    length: float | None
    file: str | None


@dataclass(frozen=True, slots=True)
class Figure:
    """What is drawn.

    Parameters
    ----------
    kind : FigureKind
        The figure.
    groups : int
        Of a suite spectrum: groups of T_m with the same number of records.
    names : mapping of str to str
        Of a suite spectrum: what bodies are called.
    pulses : tuple of str
        Of record scales: kinds of pulse that are fitted.
    added_pulse : GroundMotion or None
        Of record scales: a pulse added to the first motion if it is synthetic.
    contours : tuple of float
        Of similarity contours: their values, increasing.
    similarity : float
        Of similarity contours: the value below which similarity is complete.
    joints, isolators : tuple of LengthRange
        Of similarity contours: gaps and yield displacements.
    motions : tuple of NamedMotion
        Of similarity contours: lines with a name.
    name : str
        Of its file, without the ending.
    """

    kind: FigureKind
    groups: int = 4
    names: Mapping[str, str] = field(default_factory=dict)
    pulses: tuple[str, ...] = tuple(PULSES)
    added_pulse: GroundMotion | None = None
    contours: tuple[float, ...] = (0.1, 0.5, 1.0, 2.0, 5.0)
    similarity: float = 0.1
    joints: tuple[LengthRange, ...] = field(default=())
    isolators: tuple[LengthRange, ...] = field(default=())
    motions: tuple[NamedMotion, ...] = field(default=())
    title: str = text_key("some text", "above it; that of the case where it is empty")
    claim: str = text_key("some text", "what it is held against, for the page of all figures")
    note: str = text_key("some text", "a line below it")
    name: str = ""


def read_figure(table: Table, bodies: Sequence[str]) -> Figure | None:
    """Read a figure of a suite.

    Parameters
    ----------
    table : Table
        With ``kind`` and the keys of that kind.
    bodies : sequence of str
        Of the case.

    Returns
    -------
    Figure or None
        None where there are problems; they are noted.
    """
    kind = read_kind(table, OF_SUITES, "a suite")
    if kind is None:
        return None
    figure: Figure | None = Figure(kind)
    words, name = read_keys(table, Figure), table.file_name("name", kind.value)
    match kind:
        case FigureKind.RECORD_SCALES:
            figure = _read_scales(table, kind)
        case FigureKind.SIMILARITY_CONTOURS:
            figure = _read_contours(table, kind)
        case FigureKind.SUITE_SPECTRUM:
            figure = _read_spectrum(table, kind, bodies)
    table.close()
    return figure and replace(figure, name=name, **words)


def _read_spectrum(table: Table, kind: FigureKind, bodies: Sequence[str]) -> Figure | None:
    groups = table.quantity("groups", Dimension.NUMBER, 4.0)
    table.require("groups", groups in range(1, 9), "a whole number from 1 to 8")
    own = table.table("names")
    names = {body: own.text(body, "what it is called") for body in bodies if own.has(body)}
    own.close()
    return Figure(kind, groups=int(groups), names=names) if groups in range(1, 9) else None


def _read_scales(table: Table, kind: FigureKind) -> Figure | None:
    pulses = table.texts("pulses", "names of pulses") if table.has("pulses") else tuple(PULSES)
    if not set(pulses) <= set(PULSES):
        table.reject("pulses", f"some of {', '.join(PULSES)}")
        return None
    return Figure(kind, pulses=pulses, added_pulse=_read_pulse(table))


def _read_pulse(table: Table) -> GroundMotion | None:
    """A Mavroeidis-Papageorgiou pulse, ``added_pulse = { amplitude, period, start }``."""
    if not table.has("added_pulse"):
        return None
    own = table.table("added_pulse")
    amplitude = own.quantity("amplitude", Dimension.ACCELERATION)
    period = own.quantity("period", Dimension.TIME)
    start = own.quantity("start", Dimension.TIME, 0.0)
    own.close()
    with table.noting("added_pulse"):
        return MavroeidisPapageorgiou(amplitude, period, False, start)
    return None


def _read_contours(table: Table, kind: FigureKind) -> Figure:
    default = Figure(kind)
    contours = _numbers(table, "contours") if table.has("contours") else default.contours
    similarity = table.quantity("similarity", Dimension.NUMBER, default.similarity)
    joints = [_read_range(own, "gap") for own in table.tables("joint")]
    isolators = [_read_range(own, "yield_displacement") for own in table.tables("isolator")]
    return Figure(
        kind,
        contours=tuple(contours),
        similarity=similarity,
        joints=tuple(joints),
        isolators=tuple(isolators),
        motions=tuple(_read_motion(own) for own in table.tables("motion")),
    )


def _read_motion(table: Table) -> NamedMotion:
    """A name, and ``file`` or ``length``."""
    name = table.text("name", "what it is called")
    length = table.optional_quantity("length", Dimension.LENGTH, "a positive length L_e")
    file = table.text("file", "the file of a record") if table.has("file") else None
    if (length is None) == (file is None):
        table.report_missing("file", "a record, or length = its L_e")
    table.close()
    return NamedMotion(name, length, file)


def _read_range(table: Table, key: str) -> LengthRange:
    """A name and one length or two, ``gap = ["0.6 cm", "1.3 cm"]``."""
    name = table.text("name", "what it is called")
    low = high = 0.0
    if table.has(key):
        given = table.data[key]
        ends = given if isinstance(given, list) else [given, given]
        try:
            low, high = (quantity(end, Dimension.LENGTH) for end in ends)
        except (InputError, ValueError):
            low = 0.0
        if not 0.0 < low <= high:
            table.reject(key, 'a positive length, or two, the smaller first: ["0.6 cm", "1.3 cm"]')
    else:
        table.report_missing(key, 'a length or two of them, ["0.6 cm", "1.3 cm"]')
    table.close()
    return LengthRange(name, low, high)


def _numbers(table: Table, key: str) -> Sequence[float]:
    """A list of increasing positive numbers; empty where it is wrong."""
    accepted = "a list of increasing positive numbers"
    numbers = table.numbers(key, accepted)
    increasing = bool(numbers) and numbers[0] > 0.0 and sorted(set(numbers)) == list(numbers)
    table.require(key, increasing, accepted)
    return numbers if increasing else ()
