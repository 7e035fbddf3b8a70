"""Places of the numbers of a single body in one array `w` (`Series.single`).

A function that is given one array, not a hundred, costs next to nothing to
call. The hysteretic link is seen along u: with σ the direction of u and
``ξ = ξ_r + σ (u - u_r) / scale``, its force is ``q σ y`` for each unit of mass.
"""

from __future__ import annotations

(KNOWN, U, V, RIGHT, LEFT, SIGMA, U_R, XI_R, PART, Z, A) = range(11)
"""What moves: whether `w` is filled in, u (m), v (m/s), gaps to the barriers on either
side (m, inf where there is none), σ, u_r (m), ξ_r, part of the backbone, σ y, and the
absolute acceleration that the links give (m/s²)."""
(STIFFNESS, DAMPING, PULL, STRENGTH, SCALE, PER_SCALE) = range(11, 17)
"""Constants of `eventpound.solvers.fast.single_model.Oscillator`."""
(CORE_END, DOWN_END, SATURATION, EXPONENT, KAPPA_DOWN) = range(17, 22)
"""Borders of the backbone's parts in ξ, its exponent n, and κ on the part DOWN."""
(MASS, RIGHT_GAP, LEFT_GAP, ATOL_U, ATOL_V, RTOL) = range(22, 28)
"""Mass (kg), gaps at u = 0 (m), and what a step is given of the tolerances."""
(STILL, NO_ACCELERATION, NO_FORCE, STANDING, OWN, LEAST_GAP) = range(28, 34)
"""Speed (m/s), acceleration, contact force for each unit of mass (m/s²) and change of u (m)
that are rounding; the gap below which it is a variable of its own, and the one that is
penetration (m)."""
(EVEN, ODD, OF_U, OF_V, STEP, REACH, TERM) = range(34, 41)
"""Coefficients of the ground (`eventpound.solvers.fast.single_ground`); errors allowed
(m, m/s) and length (s) of the step; ``h^k`` and the last term of its series (m)."""
(CHANGE, RATE, BEND, NEXT_Z, NEXT_A, NEXT_EVEN, NEXT_ODD, NEXT_G) = range(41, 49)
"""At the end of the step: change of u (m), velocity, relative acceleration, and what Z, A,
EVEN and ODD become there, and the acceleration of the ground."""
(PIECE_KNOWN, SEGMENT, COSINE, SINE, FLAT_TIME) = range(49, 54)
"""One more than the piece that the ground's series is of, the sample of a record that EVEN
and ODD follow, -1 where they are not known, the phase of a sinusoid; and the time within
which a peak is flat to rounding (s)."""
(RESTS_ON, RELEASED, HELD_BACK, RIGHT_FORCE, LEFT_FORCE, OWN_SPEED) = range(54, 60)
"""Side of the barrier that the body rests on, 0 for none; whether its force has just passed
zero; whether impacts are held back from the list; contact forces (N); the scene's own speed
(m/s)."""
_SERIES = 64
ROOM = 48
"""Coefficients there is room for in a series."""
OF_X, OF_Z, OF_POWER, OF_SPEED, OF_NZ, OF_G, OF_W = (_SERIES + ROOM * i for i in range(7))
"""Where series start: u, ``σ y``, ``|y|^n``, the rate of ξ, ``(n + 1) k (σ y)_k``, the
ground, and a polynomial in work."""
TABLES = _SERIES + 7 * ROOM
"""Where the steps from sample to sample start (`eventpound.solvers.fast.single_record`)."""
TABLE_SIZE = 8
"""Numbers of one of the two."""
