"""Figures of a suite: its files, spectra and similarity.

Figure of a suite: the peak of every body against L_e, in groups of T_m (paper, Fig. 12). Figure of
a pounding pair in dimensionless terms (paper, Fig. 11): displacements and their distance over L_e
against omega_g t, impacts as open and the ends of continuous contact as filled circles, and below
the loops of the springs that hold the two bodies to the ground.
"""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path, PurePath
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from eventpound.case.case import Case, member_case, member_of
from eventpound.case.figure import Figure as Wanted
from eventpound.case.figure import FigureKind
from eventpound.case.record_file import find_record
from eventpound.errors import InputError
from eventpound.motion import read_record
from eventpound.motion.pulse_fit import fit_pulse
from eventpound.motion.record import Record
from eventpound.numerics.arrays import Floats
from eventpound.report.displacements import show_zero
from eventpound.report.loops import draw_loop
from eventpound.report.markers import draw_circles, draw_rests, event_legend
from eventpound.report.notes import add_notes
from eventpound.report.pulse_fit import record_scales_figure
from eventpound.report.similarity_contours import similarity_contours_figure
from eventpound.report.style import (
    DASHED,
    PALETTE,
    Paper,
    legend_above,
    literal,
    new_figure,
    on_paper,
    plain_logarithms,
    styled,
    zero_lines,
)
from eventpound.report.view import DrawnSpring, View
from eventpound.results import gather, write_together
from eventpound.scene.contact import BARRIER, Contact
from eventpound.scene.ends import End
from eventpound.scene.spring import GROUND
from eventpound.simulation import response_of
from eventpound.study.suite_statistics import Order, groups_of, order_of, peaks_of

_MARKERS = "os^DvPX*"
_WIDTH, _HEIGHT = 7.4, 3.1
_IN_A_COLUMN, _MOST_COLUMNS, _NARROW = 4, 3, 4.6
"""Panels one below the other, columns of them, and the width of one of several (in)."""


@styled()
def suite_spectrum_figure(
    table: pd.DataFrame, bodies: Mapping[str, str], groups: int, title: str
) -> Figure:
    """Draw the peaks of a suite.

    Parameters
    ----------
    table : DataFrame
        As `eventpound.simulate_suite` returns it; failed records are left out.
    bodies : mapping of str to str
        Bodies and what they are called: a panel each, row by row; a column for every four.
    groups : int
        Groups of T_m with the same number of records.
    title : str
        Above the figure.
    """
    columns = min(-(-len(bodies) // _IN_A_COLUMN), _MOST_COLUMNS)
    rows = -(-len(bodies) // columns)
    width = _WIDTH if columns == 1 else _NARROW * columns
    figure = new_figure(width, 0.5 + _HEIGHT * rows, title)
    panels = figure.subplots(rows, columns, squeeze=False, sharex=True).ravel()
    for axes, (body, name) in zip(panels, bodies.items(), strict=False):
        _draw(axes, table, body, groups, "; " if columns == 1 else "\n")
        axes.set_ylabel(rf"{literal(name)}: $u_{{\mathrm{{max}}}}$ (cm)")
    for axes in panels[len(bodies) :]:
        axes.set_visible(False)
    for axes in panels[: len(bodies)][-columns:]:
        axes.set_xlabel(r"energetic length scale $L_e = a_g/\omega_g^2$ (cm)")
        axes.tick_params(labelbottom=True)
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return figure


def _draw(axes: Axes, table: pd.DataFrame, body: str, groups: int, between: str) -> None:
    peaks, order = peaks_of(table, body), order_of(table, body)
    length, u = 100.0 * peaks["L_e"].to_numpy(), 100.0 * peaks["u"].to_numpy()
    periods = peaks["T_m"].to_numpy()
    group = groups_of(periods, groups)
    for number in range(groups):
        inside = group == number
        if not np.any(inside):
            continue
        own = periods[inside]
        look: Any = {"markersize": 4.5, "fillstyle": "none", "color": PALETTE[number]}
        look["label"] = rf"$T_m$ {own.min():.2f} to {own.max():.2f} s ({own.size})"
        axes.plot(length[inside], u[inside], _MARKERS[number], **look)
    if math.isfinite(order.scatter):
        _draw_line(axes, np.array([length.min(), length.max()]), order)
    plain_logarithms(axes)
    axes.set_title(between.join(_words(order)), loc="left")


def _draw_line(axes: Axes, ends: Floats, order: Order) -> None:
    """The line of least squares, and the band that holds two thirds of the records."""
    line = 100.0 * order.factor * (ends / 100.0) ** order.exponent
    axes.plot(ends, line, color="#444444", linewidth=0.9, label="line of least squares")
    spread = math.exp(order.scatter)
    look: Any = {"color": "#888888", "alpha": 0.15, "linewidth": 0.0, "zorder": 0}
    axes.fill_between(ends, line / spread, line * spread, label="one standard deviation", **look)


def _words(order: Order) -> list[str]:
    """Numbers of a panel; what is the same for all motions has no rank and no line."""
    ranks = {"$L_e$": order.rank_length, "PGA": order.rank_acceleration, "$T_m$": order.rank_period}
    known = [f"{name} {rank:.2f}" for name, rank in ranks.items() if math.isfinite(rank)]
    words = [f"{order.records} motions"]
    if known:
        words.append(f"rank correlation with {', '.join(known)}")
    if math.isfinite(order.scatter):
        factor = math.exp(order.scatter)
        words.append(f"slope {order.exponent:.2f}, scatter a factor {factor:.2f}")
    return words


def plot_suite(
    case: Case,
    table: pd.DataFrame,
    directory: str | os.PathLike[str],
    *,
    solver: str | None = None,
    rtol: float | None = None,
    paper: Paper | None = None,
) -> list[Path]:
    """Draw the figures of a suite and write them, all or none.

    Parameters
    ----------
    case : Case
        Of the suite; without ``[figure]`` it gets its spectrum.
    table : DataFrame
        As `eventpound.simulate_suite` returns it.
    directory : path
        Where they go.
    solver, rtol : optional
        What computes the response to a single record, instead of the case's own.
    paper : Paper, optional
        Kinds of files, width and resolution; PNG by default.

    Returns
    -------
    list of Path
        What was written; nothing where no record is left to draw.
    """
    done = table[table["failed"] == ""]
    if done.empty:
        return []
    by = (solver or case.solver.name, rtol or case.solver.rtol)
    plain = Wanted(FigureKind.SUITE_SPECTRUM, name=FigureKind.SUITE_SPECTRUM.value)
    drawn = {f"{each.name}.png": _drawn(case, each, done, by) for each in case.figures or (plain,)}
    return write_together(directory, on_paper(drawn, paper or Paper()))


def _drawn(case: Case, wanted: Wanted, done: pd.DataFrame, by: tuple[str, float]) -> Figure:
    """One figure of a suite; a single response is computed by a solver at a tolerance."""
    title = (wanted.title or case.title) + kind_of_motions(done)
    named = named_lengths(case, wanted)
    match wanted.kind:
        case FigureKind.RECORD_SCALES:
            drawn = _scales_figure(case, wanted, list(done["record"]), title)
        case FigureKind.SIMILARITY_CONTOURS:
            known = done[done["L_e"].notna()]
            names = [PurePath(name).stem for name in known["record"]]
            lengths = known["L_e"].to_numpy()
            drawn = similarity_contours_figure(lengths, names, wanted, title, named)
        case FigureKind.BRIDGE_RESPONSE:
            name = done["record"].iloc[0]
            member = member_of(case, name)
            one = member_case(case, member, member.read())
            run = response_of(one, *by)
            view = View(gather(run, one), one.scene)
            drawn = bridge_response_figure(view, f"{title}: {PurePath(name).name}")
        case _:
            called = {b.name: wanted.names.get(b.name, b.name) for b in case.scene.bodies}
            drawn = suite_spectrum_figure(done, called, wanted.groups, title)
    gone = "; ".join(motion.name for motion in wanted.motions if motion.name not in named)
    left_out = f"Left out, their records cannot be read here: {gone}." if gone else ""
    add_notes(drawn, [wanted.note, left_out])
    return drawn


def named_lengths(case: Case, wanted: Wanted) -> dict[str, float]:
    """L_e (m) of the motions that a figure names; records that are not here are left out.

    Parameters
    ----------
    case : Case
        To whose directory files are relative.
    wanted : Figure of a case
        With the motions.
    """
    found = {}
    for motion in wanted.motions:
        if motion.file is None:
            assert motion.length is not None
            found[motion.name] = motion.length
            continue
        try:
            data = read_record(find_record(motion.file, case.directory))
        except InputError:
            continue
        scales = Record(data.acceleration, data.time_step).scales()
        if scales is not None:
            found[motion.name] = scales.length
    return found


def _scales_figure(case: Case, wanted: Wanted, records: list[str], title: str) -> Figure:
    """The first record with its pulse, the last without."""
    members = [member_of(case, name) for name in (records[0], records[-1])]
    pulsed, plain = (member.options.motion(member.read()) for member in members)
    names = [PurePath(member.name).name for member in members]
    if wanted.added_pulse is not None and members[0].synthetic is not None:
        pulse = wanted.added_pulse
        values = pulsed.values + pulse.acceleration(pulsed.times)
        pulsed = Record(values, pulsed.time_step, start=pulsed.start)
        names[0] += f" with a {pulse.kind} pulse added"
    best = fit_pulse(pulsed, wanted.pulses)[0]
    return record_scales_figure(pulsed, best, plain, names, title)


def kind_of_motions(done: pd.DataFrame) -> str:
    """Synthetic motions are called so wherever they appear."""
    synthetic = done["record"].str.contains(r"(?:^|/)synthetic-\d", regex=True)
    if synthetic.all():
        return " (synthetic)"
    return " (some of the motions are synthetic)" if synthetic.any() else ""


# Periods 2 pi / omega_g that are shown before the first and after the last event.
_BEFORE, _AFTER = 4.0, 8.0
_EVENT = "#222222"


@styled()
def bridge_response_figure(view: View, title: str) -> Figure:
    """Draw the response of two bodies that collide.

    Parameters
    ----------
    view : View
        Results of a run under a motion that has scales.
    title : str
        Above the figure.

    Raises
    ------
    InputError
        Where the scene has no contact between two bodies.
    """
    pairs = [c for c in view.contacts if BARRIER not in (c.left, c.right)]
    if not pairs:
        raise InputError("[figure]: bridge-response needs a contact between two bodies")
    contact, view = pairs[0], replace(view, pi=True)
    figure = new_figure(9.0, 8.4, title)
    panels = figure.subplot_mosaic(
        [["u", "u"], ["g", "g"], ["left", "right"]], height_ratios=(1.2, 1.0, 1.3)
    )
    _draw_displacements(panels["u"], view, contact)
    _draw_distance(panels["g"], view, contact)
    panels["u"].sharex(panels["g"])
    panels["u"].tick_params(labelbottom=False)
    panels["g"].set_xlabel(r"dimensionless time $\omega_g t$")
    panels["g"].set_xlim(*_shown(view, contact))
    for name, body in (("left", contact.left), ("right", contact.right)):
        draw_loop(panels[name], view, _holding(view, body))
    figure.align_ylabels([panels["u"], panels["g"]])
    return figure


def _draw_displacements(axes: Axes, view: View, contact: Contact) -> None:
    """The left body, and the right one moved by the gap: where the lines meet they touch."""
    t, length = view.t, view.scale("L_e")
    left = view.displacement(contact.left) / length
    right = (view.displacement(contact.right) + contact.gap) / length
    zero_lines(axes)
    axes.fill_between(t, left, right, color="#888888", alpha=0.18, linewidth=0.0)
    lines = axes.plot(t, left, color=PALETTE[0], label=f"$u$ of {contact.left}")
    lines += axes.plot(t, right, color=PALETTE[1], label=rf"$u$ of {contact.right} + $\delta$")
    axes.set_ylabel(r"displacement $u\,\omega_g^2/a_g$")
    draw_circles(axes, view, contact.name, (t, left), _EVENT)
    legend_above(axes, lines)


def _draw_distance(axes: Axes, view: View, contact: Contact) -> None:
    """The distance of the bodies, with the events of their contact."""
    name, length = contact.name, view.scale("L_e")
    axes.axhline(contact.gap / length, color="#AAAAAA", **DASHED)
    axes.plot(view.t, view.column(f"gap.{name}") / length, color=PALETTE[2], zorder=3)
    draw_rests(axes, view, name, 0.0, PALETTE[2])
    draw_circles(axes, view, name, (view.t[:1], np.zeros(1)), _EVENT)
    axes.set_ylabel(r"distance $g_N\,\omega_g^2/a_g$")
    show_zero(axes)
    gap = contact.gap / length
    at: tuple[str, str] = ("axes fraction", "data")
    axes.annotate(rf"$\Pi_\delta$ = {gap:.2f}", (1.005, gap), xycoords=at, va="center")
    if entries := event_legend(view, [name]):
        legend_above(axes, entries)


def _holding(view: View, body: End) -> DrawnSpring:
    """The hysteretic spring between a body and the ground, else any of its springs."""
    own = [spring for spring in view.springs if set(spring.sides) == {GROUND, body}]
    hysteretic = [spring for spring in own if spring.law.hysteretic]
    if not own:
        raise InputError(f"[figure]: bridge-response needs a spring from the ground to {body}")
    return (hysteretic or own)[0]


def _shown(view: View, contact: Contact) -> tuple[float, float]:
    """The dimensionless times around the events; all of them where there are none."""
    t, events, period = view.t, view.impact_times(contact.name), 2.0 * np.pi
    if not events.size:
        return float(t[0]), float(t[-1])
    first, last = events.min() - _BEFORE * period, events.max() + _AFTER * period
    return max(float(t[0]), float(first)), min(float(t[-1]), float(last))
