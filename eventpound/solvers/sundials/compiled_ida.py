"""IDA called from compiled code: the motion in descriptor form between events."""

from __future__ import annotations

import numpy as np

from eventpound.numerics.arrays import Floats
from eventpound.numerics.lending import on_loan
from eventpound.solvers.events.integrator import Bounds
from eventpound.solvers.events.step_check import Examination
from eventpound.solvers.sundials.callback_data import address_of
from eventpound.solvers.sundials.descriptor_modes import DescriptorMode, DescriptorModes
from eventpound.solvers.sundials.ida_stepping import (
    IdaData,
    IdaHandles,
    advance,
    at_root,
    begin,
    derivatives,
    jacobian_function,
    residual_function,
    root_functions,
)
from eventpound.solvers.sundials.integrators import Direct, InDescriptorForm
from eventpound.solvers.sundials.library import IdaLibrary
from eventpound.solvers.sundials.loop import Numbers
from eventpound.solvers.sundials.memory import IdaMemory


class DirectIda(InDescriptorForm, Direct):
    """An `eventpound.solvers.events.integrator.Integrator`.

    Parameters
    ----------
    library : IdaLibrary
        See `eventpound.solvers.sundials.library.ida_library`.
    modes : DescriptorModes
        The forms that the scene takes.
    """

    def __init__(self, library: IdaLibrary, modes: DescriptorModes) -> None:
        super().__init__(modes)
        self.library = library
        self._memory: IdaMemory
        self._handles: IdaHandles

    def _meaning(self, flag: int) -> str:
        # Only a run that fails pays for scikit-sundae, which brings SciPy.
        from sksundae._cy_ida import IDAMESSAGES

        return IDAMESSAGES[flag]

    def _begin(self, tau: float, y: Floats, atol: Floats) -> None:
        own = self._own
        self._hand(IdaData(self._calls, self._problem, self._present_roots))
        memory = self._memory = self._memory_for(own)
        self._handles = on_loan(
            IdaHandles(
                memory.address,
                memory.vector,
                memory.rate_vector,
                memory.look,
                memory.state_address,
                memory.rate_address,
                self._given,
                self._mode.dynamics,
                np.zeros(1),
                self._followed,
                self.scales.time,
            )
        )
        tolerances = own.local_tolerances(self._frame)
        memory.start(tau, begin(self._handles, tau, y, tolerances, self._scratch))
        if self._roots is not None:
            callback = address_of(root_functions, self._given, 3)
            memory.find_roots(callback, self._roots.directions)

    def _memory_for(self, own: DescriptorMode) -> IdaMemory:
        rtol, atol = own.local_tolerances(self._frame)
        key = rtol, atol.tobytes(), own.algebraic.tobytes()
        if key not in self._memories:
            self._memories[key] = IdaMemory(
                self.library,
                rtol,
                atol,
                own.algebraic,
                address_of(residual_function, self._given, 3),
                address_of(jacobian_function, self._given, 4, reals=2, after=3),
                self._given.address,
            )
        found: IdaMemory = self._memories[key]
        return found

    def _steps(
        self, tau: float, first: int, excess: float, bounds: Bounds, e: Examination
    ) -> Numbers:
        return advance(self._handles, tau, first, excess, bounds, e)

    def _at_root(
        self, start: float, tau: float, bound: Floats, allowed: float, y: Floats
    ) -> tuple[int, float]:
        return at_root(self._handles, start, tau, bound, allowed, y)

    def _derivatives(self, t: float) -> Floats:
        return derivatives(self._handles, t)
