"""Every threshold of the solvers, of the mechanics and of the numerics, with its scale and reason.

Most are parts of a scene's own scales: its length L, its time T, and what follows from them, the
speed L/T, the acceleration L/T² and the force m L/T². Others are beside what a number is summed
from, or beside the tolerance that a user gives. A threshold has one name, and stands here only:
a literal power of ten elsewhere fails a test (`tests/test_tolerances.py`).
"""

from __future__ import annotations

import sys

EPS = sys.float_info.epsilon
"""Distance from one to the next number."""

# What is rounding, as parts of the scales of a scene.
GAP_COEFFICIENT = 1e-11
"""Taylor coefficients of a gap below this part of those of its bodies are rounding, where lower
ones vanish."""
ACCELERATION = 1e-13
"""Accelerations of gaps, as part of L/T². Their derivatives below this part of the same in the
scene's own time, or below what springs and dashpots make of such an acceleration or derivative two
orders or one before. Bodies without links under the tail of a Gaussian pulse are an exception: they
have the ground's acceleration alone, whose sign is known however small it is."""
RISEN = 1e-11
"""Part of the largest acceleration of a scene by which two of ground and supports have begun to
differ: above `ACCELERATION`, so that what holds to both can be told to give way, and their travel
until then is rounding."""
LENGTH = 1e-13
"""Distances to a kink, as part of L: which side a link is on, and whether it has passed it."""
GAP = 1e-15
"""Gaps within a step, as part of L: the dense output has no more."""
SPEED = 1e-13
"""Elongation rates, as part of L/T."""
FORCE = 1e-12
"""Contact forces, as part of m L/T²."""
GROUND_ERROR = 1e-12
"""What ground and loads may be off where only contact forces follow them, as part of L/T²."""
CLOSING_PLACE = 1e-12
"""Part of L to which the place of a closing is known, of a contact with a law."""
OWN_GAP = 1e-4
"""Part of L below which a gap is a variable of its own, not a difference of displacements."""
LEAST_PLAY = 1e-9
"""Distance between two barriers, as part of L, below which a body may touch both at once."""
FRAMED = 1e-5
"""Part of L that the stiffest body must move by for a moving frame to carry the scene: the
frame moves by some L, and what it carries is rounded so."""
STILL_GAP_RATE = 1e-9
"""Part of L/T below which a gap rate of a method with fixed steps counts as none."""
BALANCE = 1e-12
"""Part of L/T that the balance of momentum of such a step may miss."""
AT_REST = 1e-10
"""Part of L, or L/T, up to which a motion is rest: none of its digits is asked for."""
GAINED_IN_STEP = 1e-2
"""Part of what impulses of such a step pass on by which they may gain energy: forces of the step
act in it, too."""
NO_SPEED = 1e-30
"""Part of L/T that is none at all."""

# What is rounding beside the terms that a number is summed from.
DIRECT = 1e-13
"""Part of the absolute acceleration of a body below which the acceleration of its gap is rounding:
it is a sum of forces."""
UNDECIDED = 1e-10
"""The same of Taylor coefficients of higher orders, as part of the largest of their order among
the bodies that the undecided contacts join."""
QUIET = 1e-13
"""Speeds an impact leaves below this part of the fastest approach count as none."""
CANCELLED = 1e-13
"""Part of its terms below which what is left of a gap rate is their rounding; so is a tangential
impulse below this part of the normal one."""
BALANCE_ROUNDING = 64.0 * EPS
"""Part of the sum of its terms up to which a balance of momentum is rounding."""
TIE_ROUNDING = 64.0 * EPS
"""The same of what eliminations leave of the coefficients of coordinates that follow others."""
LCP_ROUNDING = 512.0 * EPS
"""Entries of w of an LCP below this part of the terms they are summed from count as zero."""
SINGULAR = 1e-9
"""A Schur complement below this part of its diagonal entry counts as zero.

Without a cycle of contacts it is at least the ratio of the lightest mass to
all masses; where a cycle makes it zero, rounding leaves EPS over that ratio.
Masses of a ratio up to some 1e7 lie on the right side of both."""
DEPENDENT = 1e-9
"""Part of its length below which what a row has beside the others is their rounding."""
SAME_ANSWER = 1e-6
"""Difference of what two answers to contacts with friction do, as part of what asks for them, below
which they are one: at the border of two states both answer, each to its own rounding."""
LEMKE_PIVOT = 1e-11
"""Entries of Lemke's tableau, of entries near 1, below which they are rounding and no pivot."""
LEMKE_TIE = 1e-12
"""Difference of two ratios in it below which they are a tie."""
GAINED = 1e-9
"""Part of what impulses pass on, beyond the rounding of sums, that no impact may gain."""
TAKEN_OVER = 1e-3
"""Part of its bound by which friction that has just come to it is below it again where forces that
are not unique are shared anew: far more than the error of a located force."""
OF_DENSE_OUTPUT = 8.0 * EPS
"""Part of the largest value of a coordinate below which a coefficient of its dense output is
rounding."""
INSIDE = 1e-12
"""Part of the largest distance by which a bound of least distances may be passed."""

# What is one instant.
SAME_INSTANT = 1e-13
"""Local times of events that differ relatively by less are one: so far rounding parts them."""
TOGETHER = 1e-12
"""Part of T within which closings belong to one instant, away from cascades."""
OF_A_FLIGHT = 1e-9
"""Part of the time since the last impact within which they do in a cascade."""
FLEETING = 1e-12
"""Part of T below which a mode that follows a rest is none. Contacts that come to rest at the
limit of one cascade do so one after the other here, and rounding decides in which order: what
accelerates those that are first until the last rests is nobody's acceleration."""
RELEASED_AT = 1e-9
"""Part of T within which a contact force tells its zero to rounding, and those that vanish together
do so."""
REVERSAL_WITHIN = 1e-12
"""Part of a step within which a reversal is located: on the wrong side of it z errs by the
square of the distance. Reversals that are as near to each other or to an end are there."""
SAME_SAMPLE = 1e-9
"""Part of a step, of a record's time step or of a run that is no step of its own: times that are
sums of steps miss each other by rounding."""
SOON = 1e-5
"""Part of the run after an instant in which supports that begin to move at it have a speed."""

# When a cascade of impacts is over.
LAST_SPEED = 1e-15
"""Closing speeds below this part of the scene's own, L/T, are taken as plastic. The fastest of
the run would depend on where it begins: a run continued from a state of another must go on as
that does."""
LAST_SPEED_OF_SLIDERS = 1e-11
"""The same in a scene with sliders: near `SPEED` friction has no direction any more, and would let
what loses nothing bounce on. The flights between slower ones are one instant (`TOGETHER`): a body
that friction stopped again after each would go on for ever."""
LISTED_SPEED = 1e-9
"""Impacts slower than this part of the fastest are counted, not listed."""
FADED = 1e-12
"""Closing speeds below this part of the fastest of the same instant are rounding."""
LAST_INTERVAL = 1e-120
"""Part of T below which an interval between two impacts is none: they are one instant. So short
are only those that a plastic contact makes, which opens by its acceleration a, by a τ²/2, before
the next: their squares follow each other, infinitely many in no time, each impact with a part
of the last one's speed. In the limit none is left. a τ² must still be a number."""
LOSSLESS = 1e-12
"""Part of the energy that impacts pass on below which they lose none."""
CASCADE_OVER = 1e-6
"""Part of T without impacts after which a cascade has ended."""

# What is an error.
PENETRATED = 1e-12
"""Part of L by which a gap below zero is an error."""
GAP_NOISE = 1e3
"""Multiples of the noise of a gap that are an error."""
PULLED = 1e3
"""Multiples of the rounding of a contact force by which one that pulls is an error."""
DRIFTED = 1e-9
"""Part of L, or of the largest displacement, by which a gap with variables of its own may
differ from that of the displacements; rounding and `GAP_COEFFICIENT` leave a hundredth of it."""
ENERGY_ERROR = 1e3
"""Multiples of rtol by which the energy ledger may fail to close."""
OF_ROWS = 1e-9
"""Part of the largest in the rows of a run below which a rate or z, read off them, has no sign."""
OF_SUPPORT = 1e-6
"""Part of the largest velocity in a scene by which a support may differ from its motion, which it
does by rounding, or by a body between two supports that leave it no room; and of the largest
displacement by which contacts of such a body may be open: the impacts between which it is
caught come ever closer."""

# What is an extreme.
ATTAINED_ANEW = 2e-13
"""Part of a scene's scales by which an extreme must be exceeded to be attained anew."""
SETTLED = 1e-2
"""Part of the rounding of a length by which a settled instant must exceed an extreme."""
FLAT_TURN = 1e-2
"""Part of the rounding of an extreme below which a motion, whose peak times are wanted as
exactly as its peaks, does not turn; a force or acceleration does not below the whole of it."""
FLAT_WITHIN = 10.0 * ATTAINED_ANEW**0.5
"""Part of T over which a peak is flat to the rounding of extremes, tenfold."""

# Parts of the tolerance of a run, and tolerances at which a way of computing changes.
SERIES_SHARE = 1e-3
"""Part of the tolerance a truncated local series may use."""
SERIES_DEFECT = 1e-2
"""Part of the tolerance the rate may differ by at the end of such a series, times its length."""
HELD_BELOW = 1e-9
"""rtol below which hysteretic links keep their directions. Above it the errors of all other steps
hide those at reversals, and a row of many such links, which reverse often, would take twice the
time."""
STOP_AT_SAMPLES = 1e-8
"""Tolerance below which the integrator stops at every sample of a record."""
FINEST_RTOL = 1e-14
"""Smallest relative tolerance of a step of IDA; below it rounding decides which are accepted."""
NO_RTOL = 1e-15
"""Relative tolerance where the absolute ones alone are to govern."""
LEFT_OUT = 1e6
"""Times the tolerance of a contact force, which IDA's error test is to leave out."""
LEDGER_WEIGHT = 1e-6
"""Factor of the rows of the ledger in the scene's own scales, those of the momentum being 1."""

# Lengths of steps.
DIFFERENCE_STEP = 1e-5
"""Part of a number by which it is varied for a derivative: through dozens of impacts a larger step
misses by its square, a smaller one by what is left of the tolerance."""
FIRST_STEP = 1e-3
"""Part of T that a first step may take."""
FIRST_TRIAL = 1e-6
"""Part of T of the trial from which the length of the first step is estimated."""
LONGEST_STEP = 1e3
"""Multiples of T of a step that neither ground nor loads limit."""
RETRIED = 1e-3
"""Factor of a step whose error is no number."""
NO_ERROR = 1e-30
"""Errors of a step, as part of the tolerance, below which they are none."""

# Functions and roots.
ITERATED = 4e-16
"""Relative change at which the root of an iteration stands."""
BESIDE_ONE = 1e-17
"""Part of a number below which a term, or a change, is nothing beside it."""
FEW_TERMS = 1e-3
"""Argument below which six terms of the series of the backbone do."""
OF_BACKBONE = 1e-15
"""Rounding of the backbone Φ: distance from one at which its table ends, from a line at which it
is one, and of ξ from the border of a part at which it is there."""
BEYOND_TABLE = 1e-6
"""How far below -1 the table of a backbone reaches."""
STEEP = 2e-16
"""What is left of the slope of a backbone, 1 - κ |y|^n, where it is none."""
NO_Z = 1e-16
"""|z| below which it is zero beside what it is about to become: the recurrence divides by it."""
NO_POWER = 1e-16
"""|z|^n below which it is rounding beside one."""
NO_TERM = 1e-20
"""Part of what a sum begins with, dt, dt² or dt³, below which the terms of an exponential are
left out."""
NO_ZERO = 1e-150
"""What a root function nearer to zero counts as: products of two are still numbers, by whose signs
SUNDIALS tells a root."""

# Other programs.
OPENSEES_CHANGE = 1e-12
"""Change of a displacement, beside L, at which Newton's iterations of OpenSees end."""
OPENSEES_FAR = 1e6
"""Strain (m) at which the last point of a line of OpenSees lies."""
OPENSEES_NEVER = 1e30
"""Force (N) at which a gap material yields: none reaches it."""
OPENSEES_LARGEST = 1e300
"""Largest number that OpenSees may be given."""

# What `compare` asks for where nobody says it.
COMPARED = (1e-4, 1e-6, 1e-8, 1e-10)
"""Relative tolerances at which each solver runs."""
REPEATS = 5
"""Runs whose median time counts."""

# Of decks in plan, whose geometry is that of rest.
TURNED = 0.05
"""Rotation (rad) beyond which is warned: its cosine is off by 1e-3, and places by that part."""
TURNED_TOO_FAR = 0.2
"""Rotation (rad) at which a run ends: 2 % off, beyond what counts as small."""
MOST_SKEW = 1.4
"""Largest skew of a deck (rad), 80 degrees: the edge of another is no end of it any more."""
PARALLEL = 1e-6
"""Difference of two skews (rad) up to which edges are parallel: no gap along them changes by more
than that part of their width."""
OUT_OF_PLACE = 0.01
"""Part of the length of a deck by which its centre may be elsewhere than a joint has it: an error
of the arms, and of what turns it, of that part."""
