"""How far an answer of a solver may be from the truth."""

RTOL = 1e-10
STEPS = 300.0
"""Each step errs by a fraction of the tolerance. Over tens of oscillations these add up,
and an error of a few hundred times rtol × scale is what a correct run can show."""


def allowed(scale: float, rtol: float = RTOL) -> float:
    """Global error (in the unit of `scale`) of a run at a relative tolerance."""
    return STEPS * rtol * scale
