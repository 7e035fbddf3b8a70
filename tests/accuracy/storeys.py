"""A scene whose rounding collects: two buildings, Rayleigh damping, a Bouc–Wen storey, ε = 0.

The true values are from Gragg–Bulirsch–Stoer extrapolation in 113-bit arithmetic; long double at
three settings gives the same to 1e-16.
"""

from decimal import Decimal

from eventpound.motion.harmonic import Harmonic
from eventpound.scene import GROUND, Body, BoucWen, Contact, Linear, Scene, Spring
from eventpound.scene.damping import rayleigh_dashpots

DURATION = 3.8264165170276545
TRUE = {
    "final.A0.u": Decimal("-0.0133981206543520911"),
    "final.A1.u": Decimal("-0.0297504180607207729"),
}
BODIES = (
    Body("A0", 49068.43620548632),
    Body("A1", 49584.9520842827),
    Body("B0", 236374.27496072117),
    Body("B1", 280786.1157988041),
    Body("B2", 278317.6182292882),
)
SPRINGS = (
    Spring("s0", (GROUND, "A0"), Linear(35209346.1424416)),
    Spring("s1", ("A0", "A1"), Linear(30699043.77817025)),
    Spring("s2", (GROUND, "B0"), Linear(21375530.31090143)),
    Spring(
        "s3", ("B0", "B1"), BoucWen(0.0, 3581393.1492144354, 0.01414635924993363, 50.0, -0.3, 0.7)
    ),
    Spring("s4", ("B1", "B2"), Linear(10369189.588082356)),
)
SCENE = Scene(
    BODIES,
    SPRINGS,
    rayleigh_dashpots(BODIES[:2], SPRINGS, 0.41715532580818004, 0.0016780297412656157)
    + rayleigh_dashpots(BODIES[2:], SPRINGS, 0.11837067009618184, 0.0021063745689250397),
    (
        Contact("c0", "A0", "B0", 0.0018468916758948052, 0.0),
        Contact("c1", "A1", "B1", 0.015777676267827005, 0.0),
    ),
    Harmonic(5.952036214761332, 0.7223082909927406, reverse=True, cycles=2.0),
)
