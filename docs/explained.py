"""Pictures of the first page, docs/contact.md, docs/sensitivities.md; loops in docs/case-format.md.

`python docs/explained.py` draws them.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import eventpound
from eventpound import ContactLaw
from eventpound.report.model_figure import model_figure
from eventpound.report.study_curves import tornado_figure

HERE = Path(__file__).parent
FOLDER = HERE / "explained"
SIZE, DPI, FINE = (6.4, 3.6), 110, 160
FORCE_IN_MN = 1e-6


def first() -> None:
    """A bridge as it is modelled; how far its joint closes, as built and if nothing could touch."""
    case = eventpound.load_case(HERE.parent / "cases" / "bridge-el-centro")
    # Beside a second picture there is room for short names in letters that can be read.
    springs = [
        replace(each, name=each.name.removesuffix("-abutment")) for each in case.scene.springs
    ]
    model = model_figure(replace(case.scene, springs=springs), within=(4.3, 2.3))
    _save(model, "first-model.png", FINE)
    response = eventpound.simulate(case, "fast", output_step="5 ms")
    gap = case.scene.contacts[0].gap
    figure, axis = plt.subplots(figsize=(5.0, 3.1), dpi=DPI, layout="constrained")
    for run, color, label in (
        (response.without_contact, "#999999", "if nothing could touch"),
        (response, "#0072b2", "as built"),
    ):
        history = run.history
        closing = history["u.segment1"] - history["u.segment2"]
        axis.plot(history["t"], 1e3 * closing, color=color, label=label, linewidth=1)
    struck = response.events["t"][response.events["kind"] == "impact"]
    circles = {"color": "#d55e00", "fillstyle": "none", "linestyle": "none", "markersize": 5}
    axis.plot(struck, np.full(len(struck), 1e3 * gap), "o", label="impact", **circles)
    needed = response.quantity("contacts.joint.separation_needed")
    axis.axhline(1e3 * needed, color="#d55e00", linestyle="--", linewidth=1)
    said = {"textcoords": "offset points", "color": "#d55e00", "weight": "bold", "fontsize": 11}
    axis.annotate(f"{1e3 * needed:.0f} mm: no impact", (12.0, 1e3 * needed), (0, -14), **said)
    axis.set(xlim=(0, 30), xlabel="time (s)", ylabel="closing of the joint (mm)")
    axis.grid(alpha=0.3)
    axis.legend(loc="lower right", fontsize=8)
    _save(figure, "first-motion.png", FINE)


def rest() -> None:
    """Impacts that accumulate, a rest, a detachment: displacement, velocity, contact force."""
    case = eventpound.load_case(HERE.parent / "cases" / "elastoplastic-barrier-reverse")
    response = eventpound.simulate(replace(case, run=replace(case.run, output_step=1e-4)))
    history, events = response.history, response.events
    struck = events[events["kind"] == "impact"]["t"].to_numpy()
    left = events[events["kind"] == "detachment"]["t"].to_numpy()
    t, u, v = (history[name].to_numpy() for name in ("t", "u.deck", "v.deck"))
    force = history.filter(like="lambda").iloc[:, 0].to_numpy()
    shown = (struck[0] - 0.03, left[-1] + 0.06)
    figure, axes = plt.subplots(3, sharex=True, figsize=(6.4, 5.4), dpi=DPI, layout="constrained")
    scales = (100.0, 1.0, FORCE_IN_MN)
    labels = ("displacement (cm)", "velocity (m/s)", "contact force (MN)")
    for axis, values, scale, label in zip(axes, (u, v, force), scales, labels, strict=True):
        axis.plot(t, scale * values, color="#0072b2", linewidth=1.2)
        axis.set_ylabel(label)
        axis.axvspan(struck[-1], left[-1], color="#e69f00", alpha=0.2)
        axis.grid(alpha=0.3)
    at = np.interp(struck, t, u)
    axes[0].plot(struck, 100 * at, "o", color="#d55e00", fillstyle="none")
    axes[0].plot(left[-1:], 100 * np.interp(left[-1:], t, u), "o", color="#d55e00")
    axes[0].annotate("impact", (struck[0], 100 * at[0]), (-16, 10), textcoords="offset points")
    middle = 0.5 * (struck[-1] + left[-1])
    axes[0].annotate("rest", (middle, 100 * at[-1]), (-16, 10), textcoords="offset points")
    axes[0].annotate("detachment", (left[-1], 100 * at[-1]), (4, 10), textcoords="offset points")
    axes[2].set(xlim=shown, xlabel="time (s)")
    near = (t >= shown[0]) & (t <= shown[1])
    axes[0].set_ylim(100 * u[near].min() - 0.5, 100 * u[near].max() + 0.4)
    axes[1].set_ylim(1.1 * v[near].min(), 1.1 * v[near].max())
    _save(figure, "rest.png")


def contact_spring() -> None:
    """One deck beside an abutment: Newton's law, and contact springs of three stiffnesses."""
    case = eventpound.load_case(HERE.parent / "cases" / "elastic-barrier")
    exact = eventpound.simulate(case).history
    figure, axis = plt.subplots(figsize=SIZE, dpi=DPI, layout="constrained")
    axis.plot(exact["t"], 100 * exact["u.deck"], color="black", linewidth=2, label="Newton's law")
    stiffness = case.scene.springs[0].law.stiffness
    colours = ("#e69f00", "#56b4e9", "#009e73")
    for factor, colour in zip((10, 100, 1000), colours, strict=True):
        law = ContactLaw("kelvin-voigt", factor * stiffness)
        contacts = tuple(replace(contact, law=law) for contact in case.scene.contacts)
        sprung = replace(case, scene=replace(case.scene, contacts=contacts))
        history = eventpound.simulate(sprung, "penalty", settings={"time_step": 1e-4}).history
        axis.plot(
            history["t"],
            100 * history["u.deck"],
            color=colour,
            linewidth=1,
            label=f"contact spring, {factor} times the piers",
        )
    axis.set(xlim=(0, 3), xlabel="time (s)", ylabel="displacement (cm)")
    axis.grid(alpha=0.3)
    axis.legend(loc="lower right", fontsize=8)
    _save(figure, "contact-spring.png")


def backfill() -> None:
    """Force on the soil at the right of a deck: gap, backbone, unloading, and what gap stays."""
    case = eventpound.load_case(HERE.parent / "cases" / "deck-on-backfill")
    response = eventpound.simulate(replace(case, run=replace(case.run, output_step=1e-3)))
    history, law = response.history, case.scene.springs[2].law
    left = response.quantity("springs.right.residual_gap")
    figure, axis = plt.subplots(figsize=SIZE, dpi=DPI, layout="constrained")
    axis.plot(100 * history["u.deck"], -FORCE_IN_MN * history["force.right"], color="#0072b2")
    for place, text in ((law.gap, "gap"), (left, "residual gap")):
        axis.plot(100 * place, 0.0, "o", color="#d55e00", fillstyle="none")
        axis.annotate(text, (100 * place, 0.0), (0, 6), textcoords="offset points", ha="right")
    axis.set(xlabel="displacement of the deck (cm)", ylabel="force on the soil (MN)")
    axis.grid(alpha=0.3)
    _save(figure, "backfill.png")


def tornado() -> None:
    """What the opening of the joint of a bridge depends on."""
    case = eventpound.load_case(HERE.parent / "cases" / "bridge-el-centro")
    table = eventpound.sensitivities(case, of=["contacts.joint.largest_gap"])
    _save(tornado_figure(table, case.title), "tornado.png")


def slider() -> None:
    """Force of friction pendulums against displacement of a deck: slip, stick, impact."""
    case = eventpound.load_case(HERE.parent / "cases" / "deck-on-sliders")
    response = eventpound.simulate(replace(case, run=replace(case.run, output_step=1e-3)))
    history = response.history
    figure, axis = plt.subplots(figsize=SIZE, dpi=DPI, layout="constrained")
    axis.plot(100 * history["u.deck"], FORCE_IN_MN * history["force.bearings"], color="#0072b2")
    axis.set(xlabel="displacement of the deck (cm)", ylabel="force of the bearings (MN)")
    axis.grid(alpha=0.3)
    _save(figure, "slider.png")


def degrading() -> None:
    """Loops of a pier that loses strength and stiffness."""
    case = eventpound.load_case(HERE.parent / "cases" / "pier-that-degrades")
    response = eventpound.simulate(replace(case, run=replace(case.run, output_step=2e-3)))
    figure, axis = plt.subplots(figsize=SIZE, dpi=DPI, layout="constrained")
    history = response.history
    axis.plot(100 * history["u.deck"], FORCE_IN_MN * history["force.pier"], color="#0072b2")
    axis.set(xlabel="displacement of the deck (cm)", ylabel="force of the pier (MN)")
    axis.grid(alpha=0.3)
    _save(figure, "degrading.png")


def _save(figure: plt.Figure, name: str, dpi: int = DPI) -> None:
    FOLDER.mkdir(exist_ok=True)
    figure.savefig(FOLDER / name, dpi=dpi)
    plt.close(figure)


if __name__ == "__main__":
    first()
    rest()
    contact_spring()
    backfill()
    tornado()
    slider()
    degrading()
