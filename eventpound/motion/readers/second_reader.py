"""ObsPy as a second reader of a format that we read ourselves, where it is installed.

Samples are ours in any case, so that no result depends on what is installed; a note says
whether ObsPy reads the same.
"""

from __future__ import annotations

import importlib
import io
import warnings

import numpy as np

from eventpound.motion.readers.base import Source
from eventpound.numerics.arrays import Floats
from eventpound.units import STANDARD_GRAVITY

ROUNDINGS = 8.0
"""Roundings of the largest sample that two ways of scaling counts may be apart."""


def beside_obspy(source: Source, obspy_name: str, acceleration: Floats) -> tuple[str, ...]:
    """A note on what ObsPy makes of a file of one component; none without ObsPy.

    Parameters
    ----------
    source : Source
        The file.
    obspy_name : str
        What ObsPy calls the format.
    acceleration : ndarray, shape (n,)
        Our samples, their mean not removed (m/s^2).
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            obspy = importlib.import_module("obspy")
    except ImportError:
        return ()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            (trace,) = obspy.read(io.BytesIO(source.content), format=obspy_name)
        theirs = np.asarray(trace.data * trace.stats.calib, dtype=np.float64)
    except Exception as error:  # ObsPy raises what its parsers happen to raise
        return (f"ObsPy cannot read it: {error}",)
    if theirs.size != acceleration.size:
        return (f"ObsPy reads {theirs.size} samples, not {acceleration.size}",)
    apart = float(np.max(np.abs(theirs - acceleration), initial=0.0))
    largest = float(np.max(np.abs(acceleration), initial=0.0))
    if apart <= ROUNDINGS * float(np.finfo(float).eps) * largest:
        return ("ObsPy reads the same samples",)
    return (f"ObsPy reads other samples, by up to {apart / STANDARD_GRAVITY:.3g} g",)
