"""The case that ``eventpound new`` writes: small, commented, ready to run."""

from __future__ import annotations

import json
import os
from pathlib import Path

from eventpound.case.loading import CASE_FILE
from eventpound.errors import InputError

_HEAD = """\
# A case of eventpound. Numbers are SI; a string carries a unit, "1.27 cm".
# Every table and key is described in the page "case-format" of the documentation.
#   eventpound check .          read it and show what was understood or is wrong
#   eventpound plot --model .   draw it
#   eventpound run .            compute it, into results/
"""
_PULSE = """\
[excitation]
kind = "cosine"              # sine | cosine | type-c | ricker | antisymmetric-ricker |
                             # mavroeidis-papageorgiou | harmonic | record | none
amplitude = "0.4 g"          # a_p
period = "0.8 s"             # T_p
# reverse = true             # turn the motion round
# A record instead: kind = "record", file = "NAME.AT2", and perhaps scale = 1.5 or pga = "0.4 g"
"""
_RECORD = """\
[excitation]
kind = "record"
file = {}
# scale = 1.5                # or pga = "0.4 g"; or psa = "0.5 g" with psa_period = "1.2 s"
"""
_END = """\

[run]
# duration = "4 s"           # by default 4 T_p after a pulse, 5 periods after a record
# output_step = "0.005 s"    # rows of history.csv
# energy = true              # keep the energy ledger
# without_contact = true     # the same without contact, and amplification
# quantities = ["velocity.<body>.abs_max"]     # `eventpound check . --quantities` lists them

[solver]
name = "cvode"               # `eventpound solvers` lists them
rtol = 1e-9
"""
_SEGMENT = """\
[[body]]
name = "segment{n}"
mass = "{mass}"

[[spring]]                   # its piers; elongation is u_second - u_first
between = ["ground", "segment{n}"]
name = "piers{n}"
law = "bouc-wen"
initial_period = "{period}"      # of the mass of its body
yield_force = "0.15 W"       # of the weight of that mass, or a force
hardening = 0.05

[[dashpot]]
between = ["ground", "segment{n}"]
ratio = "5 %"
refers_to = "{period}"          # critical at this period: 2 m omega

"""
_FLOOR = """
[[contact]]                  # floors at one height
between = ["A{0}", "B{0}"]
name = "floor{0}"
gap = "2 cm"
restitution = 0.6
"""
_SCENES = {
    "oscillator": (
        "An oscillator beside a barrier, under a cosine pulse",
        """\
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
""",
    ),
    "bridge": (
        "A bridge of three segments with two joints",
        _SEGMENT.format(n=1, mass="1300 t", period="0.5 s")
        + _SEGMENT.format(n=2, mass="3200 t", period="1.1 s")
        + _SEGMENT.format(n=3, mass="1300 t", period="0.5 s")
        + """\
[[spring]]                   # the left abutment: elongation falls as segment 1 moves left
between = ["ground", "segment1"]
name = "abutment"
law = "bilinear-elastic"
compression = "150 MN/m"
extension = 0                # it does not pull

[[contact]]                  # left body, right body
between = ["segment1", "segment2"]
name = "joint1"
gap = "25 mm"
restitution = 0.7

[[contact]]
between = ["segment2", "segment3"]
name = "joint2"
gap = "25 mm"
restitution = 0.7
""",
    ),
    "buildings": (
        "Two buildings of five and four storeys that pound",
        """\
[[building]]                 # bodies A1 to A5, springs storey-A1 to storey-A5
name = "A"
storeys = 5                  # a value is one for all storeys or a list, the lowest first
mass = "200 t"
height = "3.2 m"             # for drift ratios
stiffness = "300 MN/m"
yield_force = "0.3 W"        # of the weight that the storey carries; left out: linear
hardening = 0.05
ratio = "5 %"                # Rayleigh damping at modes 1 and 2

[[building]]
name = "B"
storeys = 4
mass = "250 t"
height = "3.2 m"
stiffness = ["700 MN/m", "700 MN/m", "500 MN/m", "500 MN/m"]
yield_force = "0.3 W"
ratio = "5 %"
"""
        + "".join(map(_FLOOR.format, range(1, 5))),
    ),
    "isolated": (
        "A building on isolators, with a moat wall on either side",
        """\
[[body]]
name = "slab"
mass = "400 t"

[[body]]
name = "floor1"
mass = "300 t"

[[body]]
name = "floor2"
mass = "300 t"

[[spring]]
between = ["ground", "slab"]
name = "isolators"
law = "bouc-wen"
post_yield_period = "2.5 s"
of_mass = ["slab", "floor1", "floor2"]       # the isolators carry all of it
strength = "0.05 W"          # of the weight of that mass
yield_displacement = "1 cm"

[[spring]]
between = ["slab", "floor1"]
name = "storey1"
law = "linear"
stiffness = "400 MN/m"
height = "3.2 m"

[[spring]]
between = ["floor1", "floor2"]
name = "storey2"
law = "linear"
stiffness = "400 MN/m"
height = "3.2 m"

[[rayleigh]]                 # dashpots beside the storeys; the isolators dissipate by their loops
springs = ["storey1", "storey2"]
ratio = "2 %"
mode = 2                     # of the isolated building: the first in which the storeys work

[[contact]]
between = ["barrier", "slab"]
name = "left-wall"
gap = "8 cm"
restitution = 0.5

[[contact]]
between = ["slab", "barrier"]
name = "right-wall"
gap = "8 cm"
restitution = 0.5
""",
    ),
}
SCENES = tuple(_SCENES)
"""What a case to begin with may be of."""


def write_template(
    directory: str | Path, scene: str = SCENES[0], record: str | Path | None = None
) -> Path:
    """Write a case to begin with.

    Parameters
    ----------
    directory : str or Path
        Made where it is missing.
    scene : str
        One of `SCENES`.
    record : str or Path, optional
        A record in the place of the pulse.

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
        temporary.write_text(template(scene, record), encoding="utf-8")
        temporary.replace(file)
    except OSError as error:
        raise InputError(f"{directory}: cannot be written to: {error.strerror}") from error
    return file


def template(scene: str = SCENES[0], record: str | Path | None = None) -> str:
    """Text of a case to begin with; `scene` and `record` as for `write_template`."""
    title, parts = _SCENES[scene]
    # A string of JSON is one of TOML.
    motion = _PULSE if record is None else _RECORD.format(json.dumps(str(Path(record).resolve())))
    if record is not None:
        title = title.replace(", under a cosine pulse", "")
    return f"{_HEAD}title = {json.dumps(title)}\n\n{motion}\n{parts}{_END}"
