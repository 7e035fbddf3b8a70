"""Synthetic motions: filtered, modulated white noise with published parameters.

They are no records. Whatever is written of them says "synthetic".
"""

from eventpound.motion.synthetic.files import SyntheticMotion as SyntheticMotion
from eventpound.motion.synthetic.files import synthetic_motion as synthetic_motion
from eventpound.motion.synthetic.population import Parameters as Parameters
from eventpound.motion.synthetic.population import Site as Site
from eventpound.motion.synthetic.population import draw_parameters as draw_parameters
from eventpound.motion.synthetic.population import draw_site as draw_site
