"""The case that ``eventpound new`` writes: small, commented, ready to run."""

from __future__ import annotations

import os
from pathlib import Path

from eventpound.case.loading import CASE_FILE
from eventpound.errors import InputError

TEMPLATE = """\
# A case of eventpound. Numbers are SI; a string carries a unit, "1.27 cm".
# Every table and key is described in docs/case-format.md.
#   eventpound check .      read it and say what was understood or is wrong
#   eventpound run .        compute it, into results/
title = "An oscillator beside a barrier, under a cosine pulse"

[excitation]
kind = "cosine"              # sine | cosine | type-c | ricker | antisymmetric-ricker |
                             # mavroeidis-papageorgiou | harmonic | record | none
amplitude = "0.4 g"          # a_p
period = "0.8 s"             # T_p
# reverse = true             # turn the motion round
# A record instead: kind = "record", file = "NAME.AT2", and perhaps scale = 1.5 or pga = "0.4 g"

[[body]]
name = "deck"
mass = "1301 t"

[[spring]]                   # pulls the deck back to the ground
between = ["ground", "deck"]
name = "frame"
law = "bouc-wen"             # linear | bilinear-elastic | bouc-wen | series
initial_stiffness = "233443 kN/m"
yield_force = "3621 kN"      # any three independent ones of initial_stiffness, stiffness,
hardening = 0.05             # strength, yield_force, yield_displacement and hardening

[[dashpot]]
between = ["ground", "deck"]
ratio = "5 %"                # or coefficient = "1743 kN s/m"
refers_to = "initial-stiffness"

[[contact]]
between = ["deck", "barrier"]   # left, right: a rigid barrier on the right of the deck
name = "joint"
gap = "1.27 cm"
restitution = 0.7

[run]
# duration = "4 s"           # by default until 4 T_p after the end of a pulse
# output_step = "0.005 s"    # rows of history.csv
# energy = true              # keep the energy ledger

[solver]
name = "cvode"               # `eventpound solvers` lists them
rtol = 1e-9
"""


def write_template(directory: str | Path) -> Path:
    """Write a case to begin with.

    Parameters
    ----------
    directory : str or Path
        Made where it is missing.

    Returns
    -------
    Path
        The ``case.toml`` written.

    Raises
    ------
    InputError
        Where there is a ``case.toml`` already, or it cannot be written.
    """
    folder = Path(directory)
    file = folder / CASE_FILE
    if file.exists():
        raise InputError(f"{file}: is there already; it is not overwritten")
    temporary = folder / f".{CASE_FILE}.{os.getpid()}.partial"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        temporary.write_text(TEMPLATE, encoding="utf-8")
        temporary.replace(file)
    except OSError as error:
        raise InputError(f"{directory}: cannot be written to: {error.strerror}") from error
    return file
