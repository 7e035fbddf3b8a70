"""Ground motions: pulses, harmonics, records, and none.

Page "ground-motion" of the docs has their formulas.
"""
# `eventpound.motion.forcing`, which needs Numba, is imported where it is used.

from eventpound.motion.base import Family as Family
from eventpound.motion.base import GroundMotion as GroundMotion
from eventpound.motion.base import Piece as Piece
from eventpound.motion.base import Scales as Scales
from eventpound.motion.free import NoMotion as NoMotion
from eventpound.motion.harmonic import Harmonic as Harmonic
from eventpound.motion.mavroeidis_papageorgiou import (
    MavroeidisPapageorgiou as MavroeidisPapageorgiou,
)
from eventpound.motion.pulses import Cosine as Cosine
from eventpound.motion.pulses import Sine as Sine
from eventpound.motion.pulses import TypeC as TypeC
from eventpound.motion.readers import RecordData as RecordData
from eventpound.motion.readers import read_record as read_record
from eventpound.motion.record import Record as Record
from eventpound.motion.ricker import AntisymmetricRicker as AntisymmetricRicker
from eventpound.motion.ricker import Ricker as Ricker
