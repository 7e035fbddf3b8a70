"""What is modelled: bodies, springs, dashpots, contacts and one ground motion."""

from eventpound.scene.body import Body
from eventpound.scene.contact import BARRIER, Contact
from eventpound.scene.contact_law import ContactLaw
from eventpound.scene.dashpot import Dashpot
from eventpound.scene.force import Force
from eventpound.scene.point import Point
from eventpound.scene.scene import Scene
from eventpound.scene.spring import (
    GROUND,
    Backfill,
    BilinearElastic,
    BoucWen,
    DegradingBoucWen,
    Linear,
    Series,
    Slider,
    Spring,
)
from eventpound.scene.support import Support

__all__ = [
    "BARRIER",
    "GROUND",
    "Backfill",
    "BilinearElastic",
    "Body",
    "BoucWen",
    "Contact",
    "ContactLaw",
    "Dashpot",
    "DegradingBoucWen",
    "Force",
    "Linear",
    "Point",
    "Scene",
    "Series",
    "Slider",
    "Spring",
    "Support",
]
