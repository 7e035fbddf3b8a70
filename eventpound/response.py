"""What a run returns: tables of peaks, events and history, and the final state."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np

from eventpound.basics.given import checked, number, positive
from eventpound.case.run_options import DEFAULTS, Stated
from eventpound.contact.event import STRIKES
from eventpound.errors import EventpoundError, InputError
from eventpound.mechanics.supported import components
from eventpound.motion.base import GroundMotion
from eventpound.motion.record import Record
from eventpound.motion.scaling import PERIODS, read_damping, read_periods
from eventpound.numerics.arrays import Floats
from eventpound.quantities.apart import avoiding_gaps
from eventpound.quantities.base import SIX, TakenFrom, pi_unit
from eventpound.quantities.batch_response import BatchResponse, blank_many, keep_recording
from eventpound.quantities.between import Between
from eventpound.quantities.decks import translates, turned_far
from eventpound.quantities.listed import LISTED
from eventpound.quantities.lookup import all_of, asked, chosen, tabled, values_of
from eventpound.quantities.owners import owners_of
from eventpound.quantities.rows import rows_at, settled, shocks_of, warn_unsettled
from eventpound.quantities.spring_events import SpringEvent, spring_events
from eventpound.scene.continuation import FinalState, continued, state_of
from eventpound.scene.pi_columns import ScaleColumns
from eventpound.scene.pi_terms import pi_terms
from eventpound.scene.plan_point import ACROSS
from eventpound.scene.scene import Scene
from eventpound.solvers import lists_springs, solver_named
from eventpound.solvers.base import Energy, Event, EventKind, Recording, Task, Work
from eventpound.solvers.supported import ground_accelerations
from eventpound.units import Dimension

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes


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
        Numbers of ``[run]`` that quantities need, as its `threshold_speed`.
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
            free=self._free,
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
        runs = self.runs
        beside = [q for q in LISTED if not q.tabled and q.source is TakenFrom.EXTREMES]
        known = (*tabled(runs), *all_of(self.scene, beside))
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
        """Quantities that the case names, and base shears of supports, by their names."""
        names = asked([(self.scene, self.stated)])
        if self.success and self.scene.supports:
            names += chosen(self.scene, [SHEAR_OF_SUPPORTS])
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
            row |= _shock_at(self.scene.motion, task.start)
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

    def _free(self, name: str) -> Floats | None:
        return values_of(self.without_contact.runs, name)

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
        names = [each.name for each in self.scene.bodies]
        wanted = [body] if isinstance(body, str) else list(body)
        # A deck that turns shakes no oscillator on a line.
        known = [each.name for i, each in enumerate(self.scene.bodies) if translates(self.scene, i)]
        if unknown := [name for name in wanted if name not in known] or (not wanted and ["none"]):
            raise InputError(f"body: found {', '.join(unknown)}; accepted: {', '.join(known)}")
        several = [damping] if isinstance(damping, float | int | str) else damping
        ratios = [read_damping(each) for each in several]
        period = read_periods(periods)
        # Brings Numba, which `check` does without.
        from eventpound.quantities.floor import floor_table, largest_responses

        places = [names.index(name) for name in wanted]

        def numbers(recording: Recording) -> dict[str, tuple[Floats, Floats]]:
            found = largest_responses(recording.history, self.scene, places, period, ratios)
            return {"floor spectrum": (found, found)}

        found, apart = settled(self.task, self._rerun, numbers)
        warn_unsettled("floor spectrum", apart["floor spectrum"])
        table = floor_table(found["floor spectrum"][0], wanted, period, ratios)
        units = {"body": "", "damping": "", "period": "s", "SD": "m", "PSV": "m/s"}
        table.attrs["units"] = units | {"PSA": "m/s^2", "PSA_g": "g", "SA": "m/s^2"}
        return table

    @property
    def peaks(self) -> pd.DataFrame:
        """Extremes of the displacements, one row a body.

        Columns max, t_max, min, t_min, abs_max, t_abs_max (m, s): first
        attainments over the whole run, located exactly.
        """
        import pandas as pd

        runs = self.runs
        table = pd.DataFrame(
            {
                word: [float(pick(runs.displacement, i)[0]) for i in range(runs.u.shape[1])]
                for word, (_, pick) in SIX.items()
            },
            index=pd.Index([body.name for body in self.scene.bodies], name="body"),
        )
        table.attrs["units"] = {word: "s" if word.startswith("t_") else "m" for word in SIX}
        return table

    @property
    def springs(self) -> pd.DataFrame:
        """Quantities of the springs, one row a spring, and those that the case names (SI)."""
        return self._table("springs", "spring")

    @property
    def contacts(self) -> pd.DataFrame:
        """Quantities of the contacts, one row a contact, and those that the case names (SI)."""
        return self._table("contacts", "contact")

    @property
    def pi(self) -> pd.Series[float]:
        """Π-terms, then every quantity with a unit as one (page "quantities" of the docs).

        Without a ground motion only the terms that need no scale.
        """
        import pandas as pd

        found: dict[str, float] = dict(pi_terms(self.scene))
        scales, mass = self.scene.motion.scales(), self.scene.bodies[0].mass
        runs = self.runs
        for named in tabled(runs) if scales is not None else ():
            unit = pi_unit(named.quantity.dimension, scales, mass) if scales else 1.0
            if named.quantity.dimension.unit:
                found[named.name] = float(named.of(runs)[0]) / unit
        return pd.Series(found, name="pi")

    def _table(self, kind: str, owner: str) -> pd.DataFrame:
        """Quantities of one kind of parts, a row each, with units in ``attrs``."""
        import pandas as pd

        rows: dict[str, dict[str, object]] = {}
        units: dict[str, str] = {}
        values = self.summary
        for named in all_of(self.scene):
            path = named.quantity.path
            if path.startswith(f"{kind}.<{owner}>.") and named.name in values:
                column = path.rpartition(">.")[2]
                name = owners_of(self.scene, owner)[named.i]
                rows.setdefault(name, {})[column] = values[named.name]
                units[column] = named.quantity.dimension.unit
        table = pd.DataFrame.from_dict(rows, orient="index")
        table.index.name = owner
        table.attrs["units"] = units
        return table

    @property
    def events(self) -> pd.DataFrame:
        """Every impact, accumulation, rest, detachment and separation, slip and stick.

        One row a contact, columns as in ``events.csv``; contacts are named.
        """
        import pandas as pd

        return pd.DataFrame(self.event_rows(), columns=list(EVENT_COLUMNS))

    @property
    def spring_events(self) -> pd.DataFrame:
        """Where sliders stick and slip, and soil is touched and left; units in the columns.

        Raises
        ------
        InputError
            Where the solver does not tell.
        """
        import pandas as pd

        if not lists_springs(solver_named(self.solver), self.scene):
            raise InputError(f"spring_events: {self.solver} does not list events of springs")
        found = spring_events(self.scene, self.recording)
        table = pd.DataFrame(found, columns=list(SpringEvent._fields))
        # Of an empty table, too.
        numbers = {"time_s": float, "direction": int, "elongation_m": float, "force_N": float}
        kinds = [event.kind.value for event in found]
        return table.assign(kind=kinds).astype(numbers | {"spring": str, "kind": str})

    def event_rows(self) -> list[tuple[Any, ...]]:
        """Rows of `events`."""
        names = [contact.name for contact in self.scene.contacts]
        listed: Sequence[Event] = self.recording.events
        if self.recording.slides:
            listed = sorted((*listed, *self.recording.slides), key=lambda e: e.t)
        return [(e.t, e.kind.value, e.group, names[e.contact], *e[4:]) for e in listed]

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
        import pandas as pd

        table = pd.DataFrame(self.history_columns())
        if not jumps:
            table = table.drop_duplicates("t", keep="last", ignore_index=True)
        table.attrs["units"] = {
            name: HISTORY_UNITS.get(name.partition(".")[0], "") for name in table
        }
        return table

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
        earlier = np.empty(0) if interval is None else np.maximum(times - interval, self.task.start)
        both = np.concatenate([times, earlier])
        recording, places = rows_at(self.task, self._rerun, both, side)
        rows = replace(self, recording=recording).rows().iloc[places].reset_index(drop=True)
        table = rows[: times.size].assign(t=times)
        for body in self.scene.bodies if earlier.size else ():
            speed = rows[f"v.{body.name}"].to_numpy(copy=True)
            for signal, part in components(self.scene, body.direction):
                speed += part * signal.velocity(both)
            gained = speed.reshape(2, -1)
            taken, smooth = times - earlier, table[f"a.{body.name}"].to_numpy(copy=True)
            logged = np.divide(gained[0] - gained[1], taken, out=smooth, where=taken > 0.0)
            table[f"logged.{body.name}"] = logged
            table.attrs["units"][f"logged.{body.name}"] = HISTORY_UNITS["a"]
        return table

    def history_columns(self) -> dict[str, Floats]:
        """Columns of `history`, by their names."""
        h = self.recording.history
        columns = {"t": h.t, "a_g": h.ground}
        if self.scene.in_plan:
            columns["a_across"] = ground_accelerations(self.scene, ACROSS, h)
        springs = [i for i, spring in enumerate(self.scene.springs) if spring.frame is None]
        for prefix, values, names in (
            ("u", h.u, [b.name for b in self.scene.bodies]),
            ("v", h.v, [b.name for b in self.scene.bodies]),
            ("a", h.a, [b.name for b in self.scene.bodies]),
            *((name, h.z[:, [i]], [s]) for i, (s, name) in enumerate(self.scene.memory)),
            ("force", h.force[:, springs], [self.scene.springs[i].name for i in springs]),
            ("gap", h.gap, [c.name for c in self.scene.contacts]),
            ("lambda", h.contact_force, [c.name for c in self.scene.contacts]),
        ):
            for column, name in enumerate(names):
                columns[f"{prefix}.{name}"] = values[:, column]
        supports = self.recording.supports
        if supports is not None:
            for column, support in enumerate(self.scene.supports):
                columns[f"s.{support.name}"] = supports.s[:, column]
                columns[f"sv.{support.name}"] = supports.sv[:, column]
                columns[f"sf.{support.name}"] = supports.force[:, column]
        return columns

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
        run = f"{self.task.start:g} to {self.recording.t:g} s, {impacts}"
        return f"<Response by {self.solver}, rtol {self.task.rtol:g}: {run}, {largest}{ended}>"

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


def _shock_at(motion: GroundMotion, t: float) -> dict[str, Any]:
    """Name and factor of the record of a sequence that is going on at a time (s)."""
    if not isinstance(motion, Record) or not motion.shocks:
        return {}
    number = max(int(np.searchsorted(motion.begins, t, "right")) - 1, 0)
    name, factor = motion.shocks[number]
    return {"record": name, "scale": factor}


class _MadeWhenAsked:
    """A field of a frozen dataclass that may be given as a function, which is called once."""

    def __init__(self, name: str) -> None:
        self._name = name

    def __get__(self, owner: object, kind: type | None = None) -> Any:
        if owner is None:
            return self
        value = owner.__dict__[self._name]
        if callable(value):
            value = owner.__dict__[self._name] = value()
        return value

    def __set__(self, owner: object, value: object) -> None:
        owner.__dict__[self._name] = value


# Once the class is made, for which these would be defaults of the fields.
for _field in ("task", "recording"):
    setattr(Response, _field, _MadeWhenAsked(_field))
HISTORY_UNITS = {
    "t": "s",
    "a_g": "m/s^2",
    "a_across": "m/s^2",
    "u": "m",
    "v": "m/s",
    "a": "m/s^2",
    "force": "N",
    "gap": "m",
    "lambda": "N",
    "s": "m",
    "sv": "m/s",
    "sf": "N",
}
"""Of the columns of a history, by what stands before the name; a memory's have none."""
SHEAR_OF_SUPPORTS = "supports.<support>.*_shear"
"""Stands in every summary; beside the motion it costs a few short runs."""
EVENT_COLUMNS = Event._fields
