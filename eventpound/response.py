"""What a run returns: tables of peaks, events and history, and the final state."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np

from eventpound.basics.given import checked, number, positive
from eventpound.basics.when_asked import made_when_asked
from eventpound.case.run_options import DEFAULTS, Stated
from eventpound.contact.event import STRIKES
from eventpound.errors import EventpoundError, InputError
from eventpound.motion.scaling import PERIODS, read_damping, read_periods
from eventpound.numerics.arrays import Floats
from eventpound.quantities.apart import avoiding_gaps
from eventpound.quantities.base import TakenFrom
from eventpound.quantities.batch_response import BatchResponse, blank_many, keep_recording
from eventpound.quantities.between import Between
from eventpound.quantities.decks import turned_far
from eventpound.quantities.history import event_table, history_at, history_table
from eventpound.quantities.listed import LISTED
from eventpound.quantities.lookup import all_of, asked, chosen, tabled, values_of
from eventpound.quantities.rows import shock_at, shocks_of
from eventpound.quantities.spring_events import spring_event_table
from eventpound.quantities.tables import parts_table, peaks_table, pi_numbers
from eventpound.scene.continuation import FinalState, continued, state_of
from eventpound.scene.pi_columns import ScaleColumns
from eventpound.scene.scene import Scene
from eventpound.solvers import lists_springs, solver_named
from eventpound.solvers.base import Energy, EventKind, Recording, Task, Work
from eventpound.units import Dimension

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes


@made_when_asked("task", "recording")
@dataclass(frozen=True, eq=False)
class Response:
    """The motion of a scene, as tables; equal to nothing but itself.

    Parameters
    ----------
    task : Task
        What was asked; or a function that tells it when it is first asked for.
    solver : str
        Name of the solver.
    recording : Recording
        What it returned, or such a function.
    error_estimate : mapping, optional
        Errors of peaks and final values, where they were estimated (page "results" of the docs).
    stated : Stated
        Numbers of ``[run]`` that quantities need.
    in_equilibrium : bool
        Whether the scene was put where its forces hold it, as ``start`` of ``[run]`` says.

    Examples
    --------
    >>> ball = Body("ball", "1 kg", velocity="1 m/s")
    >>> wall = Contact("wall", "ball", "barrier", gap="1 m", restitution=0.5)
    >>> response = simulate(Scene([ball], contacts=[wall]), "fast", duration="2 s")
    >>> round(float(response.peaks.loc["ball", "max"]), 9)
    1.0
    >>> round(response.quantity("contacts.wall.max_impulse"), 9)
    1.5
    >>> list(response.events["kind"])
    ['impact']
    """

    task: Task
    solver: str
    recording: Recording
    error_estimate: Mapping[str, Any] | None = None
    stated: Stated = DEFAULTS
    in_equilibrium: bool = False

    @property
    def scene(self) -> Scene:
        """What moved."""
        return self.task.scene

    @property
    def success(self) -> bool:
        """Whether the run reached its end."""
        return self.recording.success

    @property
    def message(self) -> str:
        """One sentence on how the run ended."""
        return self.recording.message

    @property
    def warnings(self) -> list[str]:
        """Sentences on what of the run is beyond what its model is good for."""
        return turned_far(self.runs) if self.scene.decks else []

    @property
    def work(self) -> Work:
        """What the run cost."""
        return self.recording.work

    @property
    def energy(self) -> Energy | None:
        """The energy ledger, where it was asked for."""
        return self.recording.energy

    @property
    def runs(self) -> BatchResponse:
        """The run as one of many, which quantities are computed from."""
        scales = self.scene.motion.scales()
        many = replace(
            blank_many(self.scene, {}, accelerations=True),
            recordings=(self.recording,),
            scales=None if scales is None else ScaleColumns(scales.a_g, scales.omega_g),
            stated=self.stated,
            free=lambda name: values_of(self.without_contact.runs, name),
            between=lambda: self._motion_between,
            apart=self._avoiding_gaps,
        )
        keep_recording(many, 0, self.recording)
        return many

    @property
    def summary(self) -> pd.Series[Any]:
        """Every quantity that needs no further run, those that the case names, shears of supports.

        By their names, as the page "quantities" of the docs lists them; SI.
        """
        import pandas as pd

        return pd.Series(self.numbers(), dtype=object, name=self.solver)

    def numbers(self) -> dict[str, float | int | bool | None]:
        """What `summary` holds, as a dictionary."""
        beside = [q for q in LISTED if not q.tabled and q.source is TakenFrom.EXTREMES]
        known = (*tabled(runs := self.runs), *all_of(self.scene, beside))
        return {named.name: named.of_one(runs) for named in known} | dict(self.named)

    @checked
    def quantity(self, name: str) -> float | None:
        """Any quantity, by its name; some take further runs (page "quantities" of the docs).

        Parameters
        ----------
        name : str
            As ``"velocity.deck.abs_max"`` or ``"free.peaks.deck.max"``.

        Returns
        -------
        float or None
            SI; None where it has no value, as the time of an impact without one.

        Raises
        ------
        InputError
            Where there is none of this name.
        ComputationError
            Where a further run fails.
        """
        if len(known := chosen(self.scene, [name], self.stated)) > 1:
            raise InputError(f"quantity: found {name!r}, which stands for {', '.join(known)}")
        values = values_of(self.runs, known[0])
        return None if values is None or np.isnan(values[0]) else float(values[0])

    @cached_property
    def named(self) -> Mapping[str, float | None]:
        """Quantities that the case names, and shears of supports, which cost a few short runs."""
        names = asked([(self.scene, self.stated)])
        if self.success and self.scene.supports:
            names += chosen(self.scene, ["supports.<support>.*_shear"])
        return {name: self.quantity(name) for name in dict.fromkeys(names)}

    @property
    def shocks(self) -> pd.DataFrame:
        """Each record of a sequence by itself, one row a shock; of one record none.

        Each shock is run again, from the state of this run at its beginning to the beginning of
        the next. Columns shock (from 1), start and end (s), record and its scale, failed (why it
        could not be run), then what `summary` holds.
        """
        import pandas as pd

        return pd.DataFrame(self.shock_rows)

    @cached_property
    def shock_rows(self) -> list[dict[str, Any]]:
        """Rows of `shocks`."""
        rows: list[dict[str, Any]] = []
        for task, state in shocks_of(self.task, self._rerun):
            row: dict[str, Any] = {"shock": len(rows) + 1, "start": task.start, "end": task.end}
            row |= shock_at(self.scene.motion, task.start)
            try:
                scene = self.scene if state is None else continued(self.scene, state, task.start)
                own = replace(self, in_equilibrium=self.in_equilibrium and state is None)
                row |= {"failed": "", **own._of_task(replace(task, scene=scene)).numbers()}
            except EventpoundError as error:
                row["failed"] = str(error)
            rows.append(row)
        return rows

    @cached_property
    def without_contact(self) -> Response:
        """The same run of the scene with nothing that can touch.

        Quantities that the case names are not repeated; ``free.`` before a name asks for one.
        """
        return self._of_scene(replace(self.scene, contacts=()))

    @cached_property
    def _avoided(self) -> dict[tuple[int, ...], Floats]:
        return {}

    def _avoiding_gaps(self, widened: tuple[int, ...]) -> Floats:
        if widened not in self._avoided:
            found = avoiding_gaps(self.scene, widened, lambda scene: self._of_scene(scene).runs)
            self._avoided[widened] = found
        return self._avoided[widened]

    def _of_scene(self, scene: Scene) -> Response:
        """The same run of the scene with other contacts."""
        if self.in_equilibrium:
            # Brings SciPy, which other runs do without.
            from eventpound.scene.statics import placed_again

            scene = placed_again(scene, self.task.start)
        return replace(self._of_task(replace(self.task, scene=scene)), stated=DEFAULTS)

    def _of_task(self, task: Task) -> Response:
        return replace(self, task=task, recording=self._rerun(task), error_estimate=None)

    @cached_property
    def _motion_between(self) -> Between:
        return Between(self.task, self._rerun)

    def _rerun(self, task: Task) -> Recording:
        return solver_named(self.solver).solve(task)

    def floor_spectrum(
        self,
        body: str | Sequence[str],
        periods: Sequence[float] | Floats = PERIODS,
        damping: float | str | Sequence[float | str] = 0.05,
    ) -> pd.DataFrame:
        """Largest responses of light oscillators on bodies, through every impact.

        An impact is an impulse on the oscillator, without a contact stiffness to choose. Over
        the run, which is made again with rows close together.

        Parameters
        ----------
        body : str or sequence of str
            What they stand on.
        periods : sequence of float
            T (s), positive.
        damping : float or sequence of float
            Ratios of critical damping, 0.05 or ``"5 %"``; below 1.

        Returns
        -------
        DataFrame
            Columns body, damping, period (s), SD (m), PSV (m/s), PSA (m/s^2), PSA_g (g) and
            SA (m/s^2): largest elongation, its pseudo-velocity and pseudo-acceleration, and
            largest absolute acceleration.

        Raises
        ------
        InputError
            Where a body is not known, or a number is out of its range.
        ComputationError
            Where the run fails.
        """
        several = [damping] if isinstance(damping, float | int | str) else damping
        ratios, period = [read_damping(each) for each in several], read_periods(periods)
        # Brings Numba, which `check` does without.
        from eventpound.quantities.floor import floor_table

        names = [body] if isinstance(body, str) else list(body)
        return floor_table(self.task, self._rerun, names, period, ratios)

    @property
    def peaks(self) -> pd.DataFrame:
        """Extremes of the displacements, one row a body.

        Columns max, t_max, min, t_min, abs_max, t_abs_max (m, s): first
        attainments over the whole run, located exactly.
        """
        return peaks_table(self.runs)

    @property
    def springs(self) -> pd.DataFrame:
        """Quantities of the springs, one row a spring, and those that the case names (SI)."""
        return parts_table(self.scene, self.summary, "spring")

    @property
    def contacts(self) -> pd.DataFrame:
        """Quantities of the contacts, one row a contact, and those that the case names (SI)."""
        return parts_table(self.scene, self.summary, "contact")

    @property
    def pi(self) -> pd.Series[float]:
        """Π-terms, then every quantity with a unit as one (page "quantities" of the docs).

        Without a ground motion only the terms that need no scale.
        """
        import pandas as pd

        return pd.Series(pi_numbers(self.runs), name="pi")

    @property
    def events(self) -> pd.DataFrame:
        """Every impact, accumulation, rest, detachment and separation, slip and stick.

        One row a contact, columns as in ``events.csv``; contacts are named.
        """
        return event_table(self.scene, self.recording)

    @property
    def spring_events(self) -> pd.DataFrame:
        """Where sliders stick and slip, and soil is touched and left; units in the columns.

        Raises
        ------
        InputError
            Where the solver does not tell.
        """
        if not lists_springs(solver_named(self.solver), self.scene):
            raise InputError(f"spring_events: {self.solver} does not list events of springs")
        return spring_event_table(self.scene, self.recording)

    @property
    def history(self) -> pd.DataFrame:
        """State at the output times and events, columns as in ``history.csv``.

        Accelerations leave impacts out, where they are not finite; `at` with a `logger` has what
        an accelerometer shows.
        """
        return self.rows()

    @checked
    def rows(self, jumps: bool = True) -> pd.DataFrame:
        """State at the output times and events, columns as in ``history.csv``.

        Parameters
        ----------
        jumps : bool
            Whether an event has two rows, before and after; without, times increase and an
            event has the row after it, as interpolators and transforms want it.
        """
        table = history_table(self.scene, self.recording)
        return table if jumps else table.drop_duplicates("t", keep="last", ignore_index=True)

    @checked
    def at(
        self,
        t: float | str | Floats | Sequence[float | str],
        side: str = "after",
        logger: float | str | None = None,
    ) -> pd.DataFrame:
        """State at any times, columns as in ``history.csv``.

        The run is made again, step by step the same, with rows there by the solver's own
        interpolant.

        Parameters
        ----------
        t : float, sequence of float or ndarray, shape (n,)
            Times (s) within the run, in any order.
        side : str
            ``"after"`` or ``"before"``: which row of an event, or of a jump of the ground.
        logger : float, optional
            Sampling interval of an accelerometer (s), ``"5 ms"``.

        Returns
        -------
        DataFrame
            A row for each time, in their order. Accelerations ``a.<body>`` leave impacts out. With
            `logger` there are columns ``logged.<body>``: mean absolute accelerations, impacts
            included, over the interval that ends at each time, or since the start (m/s^2).

        Raises
        ------
        InputError
            Where a time is not one of the run, or its solver has no row before an event.
        ComputationError
            Where the run fails.
        """
        times = np.array([number("t", x, Dimension.TIME) for x in np.atleast_1d(t).tolist()])
        interval = positive("logger", logger, Dimension.TIME)
        return history_at(self.task, self._rerun, times, side, interval)

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the displacements of the bodies, with circles at impacts.

        Parameters
        ----------
        ax : Axes, optional
            Where; made where it is not given.

        Returns
        -------
        Axes
            With lines that have the names of the bodies.
        """
        from matplotlib.axes import Axes

        if ax is None:
            import matplotlib.pyplot as plt

            _, ax = plt.subplots()
        if not isinstance(ax, Axes):
            raise InputError(f"Response.plot: ax: found {ax!r}; accepted: Axes of Matplotlib")
        h = self.recording.history
        struck = sorted({e.t for e in self.recording.events if e.kind is EventKind.IMPACT})
        for i, body in enumerate(self.scene.bodies):
            (line,) = ax.plot(h.t, h.u[:, i], label=body.name)
            marked = np.interp(struck, h.t, h.u[:, i])
            ax.plot(struck, marked, "o", markersize=3, fillstyle="none", color=line.get_color())
        ax.set_xlabel("time (s)")
        ax.set_ylabel("displacement (m)")
        ax.legend()
        return ax

    def __repr__(self) -> str:
        ended = "" if self.success else f", incomplete: {self.message}"
        peaks = self.peaks["abs_max"]
        largest = f"largest |u| {peaks.max():.6g} m ({peaks.idxmax()})"
        impacts = f"{self.impacts} impact{'s' * (self.impacts != 1)}"
        run = f"{self.task.start:g} to {self.recording.t:g} s, {impacts}, {largest}{ended}"
        return f"<Response by {self.solver}, rtol {self.task.rtol:g}: {run}>"

    def _repr_html_(self) -> str:
        tables = [self.peaks, *([self.contacts] if self.scene.contacts else [])]
        return f"<p>{escape(repr(self))}</p>" + "".join(t.to_html() for t in tables)

    @property
    def final(self) -> FinalState:
        """Final state: {body: {u, v}, spring: {z}} (m, m/s, -)."""
        r = self.recording
        return state_of(self.scene, r.u, r.v, r.z)

    @property
    def impacts(self) -> int:
        """Number of impacts, those that accumulations stand for included."""
        return sum(e.count for e in self.recording.events if e.kind in STRIKES)
