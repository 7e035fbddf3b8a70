"""Ground motions: pulses, harmonics, records, and none.

The compiled evaluation of a motion's pieces is in `eventpound.motion.forcing`,
which is imported where it is used because it needs numba.
"""

from eventpound.motion.base import Family, GroundMotion, Piece, Scales
from eventpound.motion.free import NoMotion
from eventpound.motion.harmonic import Harmonic
from eventpound.motion.mavroeidis_papageorgiou import MavroeidisPapageorgiou
from eventpound.motion.pulses import Cosine, Sine, TypeC
from eventpound.motion.readers import RecordData, read_record
from eventpound.motion.record import Record
from eventpound.motion.ricker import AntisymmetricRicker, Ricker

__all__ = [
    "AntisymmetricRicker",
    "Cosine",
    "Family",
    "GroundMotion",
    "Harmonic",
    "MavroeidisPapageorgiou",
    "NoMotion",
    "Piece",
    "Record",
    "RecordData",
    "Ricker",
    "Scales",
    "Sine",
    "TypeC",
    "read_record",
]
