"""Every number of a run that tables, figures and messages know: one list.

From `LISTED` are made ``summary.json``, the tables of suites, studies and `simulate_many`,
``Response.summary``, labels of figures, suggestions and the page "quantities" of the docs. A path
holds the kind of its owner in angle brackets, ``peaks.<body>.max``; a name has the owner's
own, ``peaks.deck.max``.
"""

from __future__ import annotations

import numpy as np

from eventpound.numerics.arrays import Floats
from eventpound.quantities.base import Quantity, Source, one_of, six_of
from eventpound.quantities.runs import Runs
from eventpound.quantities.values import (
    amplification,
    avoiding_gap,
    close_work,
    drift_ratio,
    ductility,
    elastic_force_of,
    estimated_force,
    has_law,
    is_hysteretic,
    of_laws,
    of_ledger,
    of_scales,
    peak_term,
    stands_apart,
    work_of_support,
    z_of,
)
from eventpound.units import Dimension

_LEDGER = {
    "initial": "at the start",
    "input": "that the ground motion and forces put in",
    "kinetic": "of motion at the end",
    "elastic": "stored in the k x parts of the springs at the end",
    "hysteretic": "of the work done on the Q z parts of the springs",
    "viscous": "of the work done in the dashpots",
    "impact": "lost in impacts",
}
_NUMBER, _LENGTH, _TIME = Dimension.NUMBER, Dimension.LENGTH, Dimension.TIME


def _contact(key: str, called: str, unit: Dimension, text: str, kind: type = float) -> Quantity:
    """A field of `ContactNumbers` as a quantity."""

    def values(many: Runs, i: int) -> Floats:
        column: Floats = getattr(many.contact_numbers, key)[:, i]
        return column

    path = f"contacts.<contact>.{key}"
    return Quantity(path, called, unit, text, values, Source.CONTACTS, kind=kind)


LISTED: tuple[Quantity, ...] = (
    Quantity("t_final", "end of the run", _TIME, "Time reached.", lambda m, i: m.t),
    *six_of(
        "peaks.<body>.*",
        "displacement",
        _LENGTH,
        " relative to the ground",
        one_of(lambda m: m.displacement),
        Source.EXTREMES,
    ),
    Quantity(
        "residual.<body>",
        "residual displacement",
        _LENGTH,
        "Displacement when the run ends: what is left if the motion has died down by then.",
        lambda m, i: m.u[:, i],
    ),
    *six_of(
        "acceleration.<body>.*",
        "absolute acceleration",
        Dimension.ACCELERATION,
        " between impacts (in an impact it is not finite)",
        one_of(lambda m: m.acceleration),
        Source.ACCELERATIONS,
    ),
    *six_of(
        "springs.<spring>.*_elongation",
        "elongation",
        _LENGTH,
        ": of a storey, its drift",
        one_of(lambda m: m.elongation),
        Source.EXTREMES,
    ),
    *six_of(
        "springs.<spring>.*_force",
        "force",
        Dimension.FORCE,
        " of an elastic spring, without the dashpot beside it",
        elastic_force_of,
        Source.FORCES,
        lambda scene, i: not is_hysteretic(scene, i),
    ),
    *six_of(
        "springs.<spring>.*_force",
        "force",
        Dimension.FORCE,
        " of a Bouc-Wen spring, without the dashpot beside it",
        only=is_hysteretic,
    ),
    Quantity(
        "springs.<spring>.dissipated_energy",
        "energy dissipated",
        Dimension.ENERGY,
        "Work done on the Q z part of a Bouc-Wen spring, less Q u_y z^2/2, which it can give back.",
        close_work("springs.<spring>.dissipated_energy"),
        Source.BETWEEN,
        is_hysteretic,
    ),
    Quantity(
        "dashpots.<dashpot>.dissipated_energy",
        "energy dissipated",
        Dimension.ENERGY,
        "Work done in a dashpot.",
        close_work("dashpots.<dashpot>.dissipated_energy"),
        Source.BETWEEN,
    ),
    *six_of(
        "supports.<support>.*_shear",
        "base shear",
        Dimension.FORCE,
        " that springs and dashpots put on a support",
    ),
    Quantity(
        "supports.<support>.work",
        "work",
        Dimension.ENERGY,
        "Work of a support on what stands on it and touches it, impulses included.",
        work_of_support,
        Source.ENERGY,
    ),
    *six_of(
        "velocity.<body>.*",
        "velocity",
        Dimension.VELOCITY,
        " relative to the ground",
    ),
    *six_of(
        "structures.<structure>.*_base_shear",
        "base shear",
        Dimension.FORCE,
        " of one of several structures (bodies joined by springs or dashpots), by its first body",
        only=stands_apart,
    ),
    Quantity(
        "springs.<spring>.ductility",
        "ductility",
        _NUMBER,
        "Largest elongation of either sign over the yield displacement (Bouc-Wen springs).",
        ductility,
        only=is_hysteretic,
    ),
    Quantity(
        "springs.<spring>.drift_ratio",
        "drift ratio",
        _NUMBER,
        "Largest elongation of either sign over the height of the storey, where it is given.",
        drift_ratio,
        only=lambda scene, i: scene.springs[i].height is not None,
    ),
    *six_of(
        "base_shear.*",
        "base shear",
        Dimension.FORCE,
        ": sum of the forces of springs and dashpots on the ground, positive to the right",
        one_of(lambda m: m.base_shear),
        Source.ACCELERATIONS,
    ),
    Quantity(
        "impacts",
        "impacts",
        _NUMBER,
        "Impacts of all contacts, with those that accumulations stand for.",
        lambda m, i: m.impacts.sum(axis=1),
        kind=int,
    ),
    Quantity(
        "resting_time",
        "resting time",
        _TIME,
        "Time at rest, the sum of all contacts.",
        lambda m, i: m.resting_time.sum(axis=1),
    ),
    Quantity(
        "contacts.<contact>.impacts",
        "impacts",
        _NUMBER,
        "Impacts, with those that accumulations stand for.",
        lambda m, i: m.impacts[:, i],
        kind=int,
    ),
    Quantity(
        "contacts.<contact>.resting_time",
        "resting time",
        _TIME,
        "Time at rest.",
        lambda m, i: m.resting_time[:, i],
    ),
    _contact("max_impulse", "largest impulse", Dimension.IMPULSE, "Largest impulse of an impact."),
    _contact(
        "max_force",
        "largest force",
        Dimension.FORCE,
        "Largest force while resting, with a law of its own while closed; none where it was not "
        "unique at some time.",
    ),
    _contact(
        "unique_force",
        "unique force",
        _NUMBER,
        "Whether its force was always unique: not so in a group locked between two barriers.",
        kind=bool,
    ),
    Quantity(
        "contacts.<contact>.smallest_gap",
        "smallest gap",
        _LENGTH,
        "Smallest gap while open; below zero where a contact with a law of its own overlaps.",
        lambda m, i: m.smallest_gap[:, i],
    ),
    Quantity(
        "contacts.<contact>.smallest_force",
        "smallest force",
        Dimension.FORCE,
        "Smallest force of a contact with a law of its own: below zero where it pulls.",
        of_laws(lambda laws: laws.smallest_force),
        Source.LAWS,
        only=has_law,
    ),
    Quantity(
        "contacts.<contact>.largest_overlap",
        "largest overlap",
        _LENGTH,
        "Largest overlap of a contact with a law of its own.",
        lambda m, i: np.maximum(-m.smallest_gap[:, i], 0.0),
        only=has_law,
    ),
    Quantity(
        "contacts.<contact>.longest_contact",
        "longest contact",
        _TIME,
        "Longest time that a contact with a law of its own is closed.",
        of_laws(lambda laws: laws.longest_contact),
        Source.LAWS,
        only=has_law,
    ),
    _contact(
        "t_max_impulse",
        "time of the strongest impact",
        _TIME,
        "Time of the impact of the largest impulse; none without an impact.",
    ),
    _contact(
        "t_first_impact",
        "time of the first impact",
        _TIME,
        "Time of the first impact; none without an impact.",
    ),
    _contact(
        "sum_impulse",
        "sum of impulses",
        Dimension.IMPULSE,
        "Sum of the impulses of all impacts.",
    ),
    _contact(
        "energy_lost",
        "energy lost",
        Dimension.ENERGY,
        "Kinetic energy lost in its impacts, of joint ones its share.",
    ),
    _contact(
        "fastest_closing",
        "fastest closing",
        Dimension.VELOCITY,
        "Largest closing speed of an impact; 0 without one.",
    ),
    _contact(
        "t_fastest_closing",
        "time of the fastest closing",
        _TIME,
        "Time of the impact of the largest closing speed; none without an impact.",
    ),
    _contact(
        "impacts_faster",
        "impacts above the threshold",
        _NUMBER,
        "Impacts that close faster than threshold_speed of [run], 1 cm/s where it is not given.",
        kind=int,
    ),
    Quantity(
        "contacts.<contact>.largest_gap",
        "largest opening",
        _LENGTH,
        "Largest opening of the gap: of a seat, how far it is used up.",
        lambda m, i: m.largest_gap[:, i],
    ),
    Quantity(
        "contacts.<contact>.avoiding_gap",
        "gap without contact",
        _LENGTH,
        "Smallest gap that would have avoided contact.",
        avoiding_gap,
        Source.APART,
        tabled=False,
    ),
    Quantity(
        "contacts.<contact>.estimated_force",
        "impact force (estimate)",
        Dimension.FORCE,
        "Estimate only: force of the strongest impact if the contact were a spring of the "
        "contact_stiffness of [run], J sqrt(k/m)/2 with the reduced mass m of the two bodies.",
        estimated_force,
        Source.CONTACTS,
        tabled=False,
    ),
    Quantity(
        "final.<body>.u",
        "final displacement",
        _LENGTH,
        "Displacement at the end.",
        lambda m, i: m.u[:, i],
    ),
    Quantity(
        "final.<body>.v",
        "final velocity",
        Dimension.VELOCITY,
        "Velocity at the end, relative to the ground.",
        lambda m, i: m.v[:, i],
    ),
    Quantity(
        "final.<spring>.z",
        "final $z$",
        _NUMBER,
        "Hysteretic variable at the end.",
        z_of,
        only=is_hysteretic,
    ),
    Quantity(
        "work.steps", "steps", _NUMBER, "Steps of the solver.", lambda m, i: m.steps, kind=int
    ),
    *(
        Quantity(
            f"energy.{term}",
            f"energy {text}",
            Dimension.ENERGY,
            f"Energy {text}.",
            of_ledger(term),
            Source.ENERGY,
        )
        for term, text in _LEDGER.items()
    ),
    *(
        Quantity(
            "pi_um" + owner,
            "$u_{max}/L_e$",
            _NUMBER,
            f"Largest displacement of either sign over L_e (eq. 8), of {whose}.",
            peak_term,
            tabled=False,
        )
        for owner, whose in (("", "the first body"), (".<body>", "each body"))
    ),
    *(
        Quantity(
            "amplification" + owner,
            "peak with contact / without",
            _NUMBER,
            f"Peak displacement over that of the same scene without contact, of {whose}.",
            amplification,
            Source.FREE,
            tabled=False,
        )
        for owner, whose in (("", "the first body"), (".<body>", "each body"))
    ),
    *(
        Quantity(f"scales.{key}", called, dimension, text, of_scales(attribute), tabled=False)
        for key, attribute, called, dimension, text in (
            ("a_g", "a_g", "$a_g$", Dimension.ACCELERATION, "Amplitude of a pulse, else PGA."),
            (
                "omega_g",
                "omega_g",
                r"$\omega_g$",
                Dimension.ANGULAR_FREQUENCY,
                "2 pi over the period of a pulse, of a record over T_m.",
            ),
            ("L_e", "length", "$L_e$", _LENGTH, "The energetic length a_g / omega_g^2."),
        )
    ),
)
"""All of them, in the order of the tables."""
