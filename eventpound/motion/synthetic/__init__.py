"""Synthetic motions: filtered, modulated white noise with published parameters.

They are no records. Whatever is written of them says "synthetic".
"""

from eventpound.motion.synthetic.files import SyntheticMotion, synthetic_motion
from eventpound.motion.synthetic.population import Parameters, Site, draw_parameters, draw_site

__all__ = [
    "Parameters",
    "Site",
    "SyntheticMotion",
    "draw_parameters",
    "draw_site",
    "synthetic_motion",
]
