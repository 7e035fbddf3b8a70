"""Every number of a run that tables, figures and messages know: one list.

From `LISTED` are made ``summary.json``, the tables of suites, studies and `simulate_many`,
``Response.summary``, labels of figures, suggestions and the page "quantities" of the docs. A path
holds the kind of its owner in angle brackets, ``peaks.<body>.max``; a name has the owner's
own, ``peaks.deck.max``.
"""

from __future__ import annotations

import numpy as np

from eventpound.quantities import storeys
from eventpound.quantities import values as v
from eventpound.quantities.base import Quantity, TakenFrom, column, of_contact, six_of, sum_of
from eventpound.scene.separation import is_between_bodies, is_between_structures
from eventpound.scene.spring import Backfill, BoucWen, Hysteretic, Slider
from eventpound.units import Dimension

D = Dimension
_CONTACT, _SPRING = "contacts.<contact>.", "springs.<spring>."
_EACH = (("", "of the first body"), (".<body>", "of each body"))
LISTED: tuple[Quantity, ...] = (
    Quantity("t_final", "end of the run", D.TIME, "Time reached.", lambda m, i: m.t),
    *six_of("peaks.<body>.*", "displacement", D.LENGTH, " relative to the ground",
            "displacement", TakenFrom.EXTREMES, symbol="$u_{max}$"),
    Quantity("residual.<body>", "residual displacement", D.LENGTH,
             "Displacement when the run ends: what is left if the motion has died down by then.",
             column("u")),
    *six_of("acceleration.<body>.*", "absolute acceleration", D.ACCELERATION,
            " between impacts (in an impact it is not finite)",
            "acceleration", TakenFrom.ACCELERATIONS),
    *six_of(_SPRING + "*_elongation", "elongation", D.LENGTH, ": of a storey, its drift",
            "elongation", TakenFrom.EXTREMES),
    *six_of(_SPRING + "*_force", "force", D.FORCE,
            " of an elastic spring, without the dashpot beside it", v.elastic_force_of,
            TakenFrom.FORCES, v.is_elastic),
    *six_of(_SPRING + "*_force", "force", D.FORCE,
            " of a spring with a memory, without the dashpot beside it", only=v.law_is(Hysteretic)),
    Quantity(_SPRING + "dissipated_energy", "energy dissipated", D.ENERGY,
             "Work done on the Q z part of a Bouc-Wen spring, less Q u_y z^2/2, which it can "
             "give back.", v.close_work(_SPRING + "dissipated_energy"), TakenFrom.BETWEEN,
             v.is_plain_bouc_wen),
    Quantity(_SPRING + "dissipated_energy", "energy dissipated", D.ENERGY,
             "Work that the soil of a backfill, or a degrading Bouc-Wen spring, does not give "
             "back.", v.by_law("dissipated"), TakenFrom.LAWS, v.told_by_law("dissipated")),
    Quantity(_SPRING + "dissipated_energy", "energy dissipated", D.ENERGY,
             "Work of the friction of a slider.", v.friction_work, TakenFrom.LAWS,
             v.law_is(Slider)),
    Quantity(_SPRING + "slip_path", "slip path", D.LENGTH,
             "Length of all slips of a slider.", v.slip_path, TakenFrom.LAWS, v.law_is(Slider)),
    *(Quantity(_SPRING + name, name.replace("_", " "), D.NUMBER, text, v.by_law(name),
               TakenFrom.LAWS, v.told_by_law(name))
      for name, text in (
          ("strength_lost", "Part of its strength that a degrading Bouc-Wen spring has lost."),
          ("strength_left", "What of it is left."),
          ("stiffness_lost", "Part of its stiffness at z = 0 that it has lost."),
          ("stiffness_left", "What of it is left."))),
    Quantity(_SPRING + "passive_force", "peak passive force", D.FORCE,
             "Largest force of the soil of a backfill.", v.passive_force, only=v.law_is(Backfill)),
    Quantity(_SPRING + "passive_depth", "depth pushed in", D.LENGTH,
             "How far the soil of a backfill was pushed in beyond its gap.", v.passive_depth,
             only=v.law_is(Backfill)),
    Quantity(_SPRING + "residual_gap", "residual gap", D.LENGTH,
             "Compression at which the soil of a backfill would be touched again after the run.",
             v.by_law("residual_gap"), TakenFrom.LAWS, v.told_by_law("residual_gap")),
    Quantity("dashpots.<dashpot>.dissipated_energy", "energy dissipated", D.ENERGY,
             "Work done in a dashpot.", v.close_work("dashpots.<dashpot>.dissipated_energy"),
             TakenFrom.BETWEEN),
    *six_of("supports.<support>.*_shear", "base shear", D.FORCE,
            " that springs and dashpots put on a support"),
    Quantity("supports.<support>.work", "work", D.ENERGY,
             "Work of a support on what stands on it and touches it, impulses included.",
             v.work_of_support, TakenFrom.ENERGY),
    *six_of("velocity.<body>.*", "velocity", D.VELOCITY, " relative to the ground"),
    *six_of("structures.<structure>.*_base_shear", "base shear", D.FORCE,
            " of one of several structures (bodies joined by springs or dashpots), by the name of "
            "its building or frame, else of its first body", only=v.stands_apart),
    Quantity(_SPRING + "ductility", "ductility", D.NUMBER,
             "Largest elongation of either sign over the yield displacement (Bouc-Wen springs).",
             v.ductility, only=v.law_is(BoucWen)),
    Quantity(_SPRING + "residual_elongation", "residual elongation", D.LENGTH,
             "Elongation when the run ends: what is left if the motion has died down by then.",
             v.residual_elongation, only=v.moves_with_bodies),
    Quantity(_SPRING + "drift_ratio", "drift ratio", D.NUMBER,
             "Largest elongation of either sign over the height of a storey or pier that has one.",
             storeys.peak_drift_ratio, only=storeys.has_height),
    Quantity(_SPRING + "stability_coefficient", "stability coefficient", D.NUMBER,
             "P-Delta: theta = P D/(V h) of a storey with a weight P and a height h, D its largest "
             "drift and V what its backbone resists there; P/(k h) of a linear one.",
             storeys.stability_coefficient, only=storeys.has_weight),
    Quantity(_SPRING + "slack_left", "slack left", D.LENGTH,
             "What is left of the slack of a spring that only pulls, of the gap of one that only "
             "pushes.", v.slack_left, only=v.goes_slack),
    Quantity("max_drift", "largest drift", D.LENGTH,
             "Largest elongation of either sign of all storeys: springs with a height, but piers.",
             storeys.largest_drift, only=storeys.has_storeys),
    Quantity("max_drift_ratio", "largest drift ratio", D.NUMBER,
             "Largest drift ratio of all storeys: springs with a height, but piers.",
             storeys.largest_drift_ratio, only=storeys.has_storeys),
    Quantity("structures.<structure>.roof_drift", "roof drift", D.LENGTH,
             "Largest displacement, relative to the ground, of the floors that carry no storey.",
             storeys.roof_drift, only=storeys.has_floors),
    Quantity("structures.<structure>.storey_drift_ratio", "largest storey drift", D.NUMBER,
             "Largest drift ratio of the storeys of a structure.", storeys.storey_drift_ratio,
             only=storeys.has_floors),
    *six_of("seats.<seat>.*_opening", "opening", D.LENGTH,
            ": how far the right end of a seat has moved away from the left one"),
    *six_of("base_shear.*", "base shear", D.FORCE,
            ": sum of the forces of springs and dashpots on the ground, positive to the right",
            "base_shear", TakenFrom.ACCELERATIONS),
    Quantity("impacts", "impacts", D.NUMBER,
             "Impacts of all contacts, with those that accumulations stand for.",
             sum_of("impacts"), kind=int),
    Quantity("impacts_faster", "impacts above the threshold", D.NUMBER,
             "Impacts of all contacts that close faster than threshold_speed.",
             v.impacts_faster, TakenFrom.CONTACTS, v.has_contacts, kind=int),
    Quantity("resting_time", "resting time", D.TIME, "Time at rest, the sum of all contacts.",
             sum_of("resting_time")),
    Quantity(_CONTACT + "impacts", "impacts", D.NUMBER,
             "Impacts, with those that accumulations stand for.", column("impacts"), kind=int),
    Quantity(_CONTACT + "resting_time", "resting time", D.TIME, "Time at rest.",
             column("resting_time")),
    of_contact("max_impulse", "largest impulse", D.IMPULSE, "Largest impulse of an impact."),
    of_contact("max_force", "largest force", D.FORCE,
               "Largest force while resting, with a law of its own while closed; none where it "
               "was not unique at some time."),
    of_contact("unique_force", "unique force", D.NUMBER,
               "Whether its force was always unique: not so in a group locked between two "
               "barriers.", bool),
    Quantity(_CONTACT + "smallest_gap", "smallest gap", D.LENGTH,
             "Smallest gap while open; below zero where a contact with a law of its own overlaps.",
             column("smallest_gap")),
    Quantity(_CONTACT + "smallest_force", "smallest force", D.FORCE,
             "Smallest force of a contact with a law of its own: below zero where it pulls.",
             v.of_laws("smallest_force"), TakenFrom.LAWS, v.has_law),
    Quantity(_CONTACT + "largest_overlap", "largest overlap", D.LENGTH,
             "Largest overlap of a contact with a law of its own.",
             lambda m, i: np.maximum(-m.smallest_gap[:, i], 0.0), only=v.has_law),
    Quantity(_CONTACT + "longest_contact", "longest contact", D.TIME,
             "Longest time that a contact with a law of its own is closed.",
             v.of_laws("longest_contact"), TakenFrom.LAWS, v.has_law),
    of_contact("t_max_impulse", "time of the strongest impact", D.TIME,
               "Time of the impact of the largest impulse; none without an impact."),
    of_contact("t_first_impact", "time of the first impact", D.TIME,
               "Time of the first impact; none without an impact."),
    of_contact("sum_impulse", "sum of impulses", D.IMPULSE, "Sum of the impulses of all impacts."),
    of_contact("energy_lost", "energy lost", D.ENERGY,
               "Kinetic energy lost in its impacts, of joint ones its share."),
    of_contact("fastest_closing", "fastest closing", D.VELOCITY,
               "Largest closing speed of an impact; 0 without one."),
    of_contact("t_fastest_closing", "time of the fastest closing", D.TIME,
               "Time of the impact of the largest closing speed; none without an impact."),
    of_contact("impacts_faster", "impacts above the threshold", D.NUMBER,
               "Impacts that close faster than threshold_speed of [run], 1 cm/s where it is not "
               "given.", int),
    Quantity(_CONTACT + "largest_gap", "largest opening", D.LENGTH,
             "Largest opening of the gap: of a seat, how far it is used up.",
             column("largest_gap")),
    Quantity(_CONTACT + "seat_used", "seat width used", D.LENGTH,
             "Largest opening beyond the gap at rest: what a seat loses.", v.seat_used),
    Quantity(_CONTACT + "separation_needed", "separation needed", D.LENGTH,
             "Gap with which, in all contacts of its joint, nothing touches anywhere; unequal gaps "
             "grow alike.",
             v.separation_needed, TakenFrom.APART, tabled=False),
    Quantity(_CONTACT + "avoiding_gap", "gap needed here, all joints open", D.LENGTH,
             "Smallest gap that would have avoided contact, where no other contact closes either.",
             v.avoiding_gap, TakenFrom.APART, tabled=False),
    Quantity(_CONTACT + "avoiding_gap_alone", "gap if only this contact is opened", D.LENGTH,
             "Smallest gap that would have avoided this contact and others between the same ends, "
             "where all else stays and strikes.", v.avoiding_gap_alone, TakenFrom.APART_ALONE,
             tabled=False),
    *(Quantity(_CONTACT + rule, f"separation by {called} of peaks", D.LENGTH,
               f"Distance by {text} of the peaks of its two ends without contact{where}.",
               value, TakenFrom.FREE, only, tabled=False)
      for rule, called, text, where, value, only in (
          ("absolute_sum", "sum", "the sum", "", v.of_peaks(np.add), is_between_bodies),
          ("srss", "SRSS", "SRSS", "", v.of_peaks(np.hypot), is_between_bodies),
          ("cqc", "CQC", "CQC", ", of two structures", v.cqc_of_peaks, is_between_structures))),
    Quantity(_CONTACT + "estimated_force", "impact force (estimate)", D.FORCE,
             "Estimate only: force of the strongest impact if the contact were a spring of the "
             "contact_stiffness of [run], J sqrt(k/m)/2 with the reduced mass m of the two bodies.",
             v.estimated_force, TakenFrom.CONTACTS, tabled=False),
    Quantity("final.<body>.u", "final displacement", D.LENGTH, "Displacement at the end.",
             column("u")),
    Quantity("final.<body>.v", "final velocity", D.VELOCITY,
             "Velocity at the end, relative to the ground.", column("v")),
    Quantity("final.<spring>.z", "final $z$", D.NUMBER, "Hysteretic variable at the end.", v.z_of,
             only=v.law_is(Hysteretic)),
    Quantity("final.<spring>.epsilon", "final $\\varepsilon$", D.NUMBER,
             "Hysteretic energy of a degrading Bouc-Wen spring at the end, over Q u_y.",
             v.by_law("epsilon"), TakenFrom.LAWS, v.told_by_law("epsilon")),
    Quantity("work.steps", "steps", D.NUMBER, "Steps of the solver.", lambda m, i: m.steps,
             kind=int),
    *(Quantity(f"energy.{term}", f"energy {text}", D.ENERGY, f"Energy {text}.", v.of_ledger(term),
               TakenFrom.ENERGY)
      for term, text in (
          ("initial", "at the start"),
          ("input", "that the ground motion and forces put in"),
          ("kinetic", "of motion at the end"),
          ("elastic", "stored in the k x parts of the springs at the end"),
          ("hysteretic", "of the work done on the Q z parts of the springs"),
          ("viscous", "of the work done in the dashpots"),
          ("impact", "lost in impacts"))),
    *(Quantity("pi_um" + owner, "$u_{max}/L_e$", D.NUMBER,
               f"Largest displacement of either sign over L_e (eq. 8), {whose}.", v.peak_term,
               tabled=False)
      for owner, whose in _EACH),
    *(Quantity("amplification" + owner, "peak with contact / without", D.NUMBER,
               f"Peak displacement over that of the same scene without contact, {whose}.",
               v.amplification, TakenFrom.FREE, tabled=False)
      for owner, whose in _EACH),
    Quantity("demand_over_capacity", "demand over capacity", D.NUMBER,
             "The largest demand over its capacity, of all that have one in the case: above 1 one "
             "of them is exceeded.", v.demand_over_capacity, TakenFrom.CAPACITIES, tabled=False),
    Quantity("scales.a_g", "$a_g$", D.ACCELERATION, "Amplitude of a pulse, else PGA.",
             v.of_scales("a_g"), tabled=False),
    Quantity("scales.omega_g", r"$\omega_g$", D.ANGULAR_FREQUENCY,
             "2 pi over the period of a pulse, of a record over T_m.", v.of_scales("omega_g"),
             tabled=False),
    Quantity("scales.L_e", "$L_e$", D.LENGTH, "The energetic length a_g / omega_g^2.",
             v.of_scales("length"), tabled=False),
)  # fmt: skip
"""All of them, in the order of the tables."""
