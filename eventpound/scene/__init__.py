"""What is modelled: bodies, springs, dashpots, contacts and one ground motion."""

from eventpound.scene.body import Body as Body
from eventpound.scene.contact import BARRIER as BARRIER
from eventpound.scene.contact import Contact as Contact
from eventpound.scene.contact_law import ContactLaw as ContactLaw
from eventpound.scene.dashpot import Dashpot as Dashpot
from eventpound.scene.deck import Deck as Deck
from eventpound.scene.force import Force as Force
from eventpound.scene.joint import Joint as Joint
from eventpound.scene.plan_point import PlanPoint as PlanPoint
from eventpound.scene.point import Point as Point
from eventpound.scene.scene import Scene as Scene
from eventpound.scene.seat import Seat as Seat
from eventpound.scene.spring import GROUND as GROUND
from eventpound.scene.spring import Backfill as Backfill
from eventpound.scene.spring import BilinearElastic as BilinearElastic
from eventpound.scene.spring import BoucWen as BoucWen
from eventpound.scene.spring import DegradingBoucWen as DegradingBoucWen
from eventpound.scene.spring import Linear as Linear
from eventpound.scene.spring import Series as Series
from eventpound.scene.spring import Slider as Slider
from eventpound.scene.spring import Spring as Spring
from eventpound.scene.support import Support as Support
