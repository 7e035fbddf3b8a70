"""A scene as the oracle reads it: words and numbers, one thing a line.

    run START END
    body MASS U V
    elastic A B PARTS (COMPRESSION EXTENSION OFFSET)...
    boucwen A B K Q U_Y N BETA GAMMA Z
    dashpot A B C
    contact LEFT RIGHT GAP RESTITUTION CLOSED
    motion none
    motion record START DT SCALE OVER COUNT SAMPLES...
    motion KIND AMPLITUDE PERIOD START FIRST SECOND
    moments COUNT TIMES...

Bodies are counted from 0; -1 is the ground or a barrier. Numbers are hexadecimal, so that
none is rounded. Samples are multiplied by SCALE/OVER. FIRST and SECOND are the cycles of a
harmonic and a type-C pulse; gamma and phase of a Mavroeidis-Papageorgiou pulse; a time and
the periods from there to the middle of a Ricker wavelet. A closed contact is one whose gap the
package's rule, in double precision, calls closed.
"""

import math
from collections.abc import Iterator, Sequence

import numpy as np

from eventpound.motion.base import GroundMotion
from eventpound.motion.free import NoMotion
from eventpound.motion.harmonic import Harmonic
from eventpound.motion.mavroeidis_papageorgiou import MavroeidisPapageorgiou
from eventpound.motion.pulses import Cosine, Sine, TypeC
from eventpound.motion.record import Record
from eventpound.motion.ricker import AntisymmetricRicker, Ricker
from eventpound.scene import (
    BARRIER,
    GROUND,
    BilinearElastic,
    BoucWen,
    Linear,
    Scene,
    Series,
    Spring,
)


def scene_text(scene: Scene, start: float, end: float, moments: Sequence[float] = ()) -> str:
    """The lines of a scene that runs from `start` to `end` (s), displacements at some moments."""
    place = {body.name: i for i, body in enumerate(scene.bodies)} | {GROUND: -1, BARRIER: -1}
    lines = [_line("run", start, end)]
    lines += [_line("body", b.mass, b.displacement, b.velocity) for b in scene.bodies]
    lines += [_spring(spring, place) for spring in scene.springs]
    lines += [_line("dashpot", *_ends(d.between, place), d.coefficient) for d in scene.dashpots]
    u = {body.name: body.displacement for body in scene.bodies} | {BARRIER: 0.0}
    for c in scene.contacts:
        closed = c.gap <= u[c.left] - u[c.right]
        ends = _ends((c.left, c.right), place)
        lines.append(_line("contact", *ends, c.gap, c.restitution, int(closed)))
    lines.append(_line("motion", *_motion(scene.motion)))
    lines.append(_line("moments", len(moments), *moments))
    return "\n".join(lines) + "\n"


def _line(word: str, *values: float | str) -> str:
    return " ".join(
        (word, *(v if isinstance(v, str) else str(v) if isinstance(v, int) else float(v).hex()
                 for v in values))
    )  # fmt: skip


def _ends(between: tuple[str, str], place: dict[str, int]) -> tuple[int, int]:
    return place[between[0]], place[between[1]]


def _spring(spring: Spring, place: dict[str, int]) -> str:
    law, ends = spring.law, _ends(spring.between, place)
    if isinstance(law, BoucWen):
        shape = (law.yield_displacement, law.exponent, law.beta, law.gamma, law.initial_z)
        return _line("boucwen", *ends, law.stiffness, law.strength, *shape)
    parts = law.parts if isinstance(law, Series) else (law,)
    numbers = [number for part in parts for number in _elastic(part)]
    return _line("elastic", *ends, len(parts), *numbers)


def _elastic(law: Linear | BilinearElastic) -> tuple[float, float, float]:
    if isinstance(law, Linear):
        return law.stiffness, law.stiffness, 0.0
    return law.compression, law.extension, law.offset


def _motion(motion: GroundMotion) -> Iterator[float | str]:
    if isinstance(motion, NoMotion):
        yield "none"
        return
    yield motion.kind
    if isinstance(motion, Record):
        recorded = float(np.max(np.abs(motion.samples)))
        scale, over = (motion.scale, 1.0) if motion.pga is None else (motion.pga, recorded)
        yield from (motion.start, motion.time_step, -scale if motion.reverse else scale, over)
        yield from (motion.samples.size, *(float(sample) for sample in motion.samples))
        return
    if not isinstance(
        motion,
        Sine | Cosine | Harmonic | TypeC | MavroeidisPapageorgiou | Ricker | AntisymmetricRicker,
    ):
        raise ValueError(f"the oracle does not know motions of the kind {motion.kind}")
    yield from (motion.signed_amplitude, motion.period, motion.start)
    if isinstance(motion, Harmonic):
        yield from (math.inf if motion.cycles is None else motion.cycles, 0.0)
    elif isinstance(motion, TypeC):
        yield from (float(motion.cycles), 0.0)
    elif isinstance(motion, MavroeidisPapageorgiou):
        yield from (motion.gamma, motion.phase)
    elif isinstance(motion, Ricker | AntisymmetricRicker):
        at_start = motion.center is None
        yield from (motion.start, motion.LEAD) if at_start else (motion.center, 0.0)
    else:
        yield from (0.0, 0.0)
