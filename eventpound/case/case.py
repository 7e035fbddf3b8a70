"""A case: a scene, how it is to be run, and what was understood of its file."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from eventpound.case.figure import Figure
from eventpound.case.record_scaling import LARGEST_SCALE
from eventpound.case.suite import Suite
from eventpound.motion.readers.base import RecordData
from eventpound.scene.pi_structure import PiStructure
from eventpound.scene.scene import Scene


@dataclass(frozen=True, slots=True)
class Stated:
    """What ``[run]`` says of quantities: which are wanted, and numbers that some are about.

    Parameters
    ----------
    threshold_speed : float
        Impacts that close faster are counted (m/s).
    contact_stiffness : float, optional
        With it the forces of impacts are estimated (N/m).
    quantities : tuple of str
        What is computed besides, by name or by path (page "quantities" of the docs).
    without_contact : bool
        Whether to run the scene without contact, too, for `amplification` and its peaks.
    avoiding_gap : bool
        Whether to find the gaps that would have avoided contact.
    units : tuple of str
        In which design numbers are told (`eventpound.units.TOLD`); of others the usual.
    events : tuple of str
        Which events of springs are written (`eventpound.case.options.LISTED`).
    """

    threshold_speed: float = 0.01
    contact_stiffness: float | None = None
    quantities: tuple[str, ...] = ()
    without_contact: bool = False
    avoiding_gap: bool = False
    units: tuple[str, ...] = ()
    events: tuple[str, ...] = ()

    def named(self) -> Iterator[tuple[str, str]]:
        """Names and paths of all quantities that are wanted, each after the option that says so."""
        yield from (("quantities", name) for name in self.quantities)
        if self.without_contact:
            yield "without_contact", "amplification.<body>"
            yield "without_contact", "free.peaks.<body>.*"
        if self.contact_stiffness is not None:
            yield "contact_stiffness", "contacts.<contact>.estimated_force"
        if self.threshold_speed != DEFAULTS.threshold_speed:
            yield "threshold_speed", "contacts.<contact>.impacts_faster"
        if self.avoiding_gap:
            for word in ("separation_needed", "avoiding_gap", "avoiding_gap_alone"):
                yield "avoiding_gap", f"contacts.<contact>.{word}"


DEFAULTS = Stated()
"""Where a case does not say."""


@dataclass(frozen=True, slots=True)
class RunOptions:
    """What is to be computed.

    Parameters
    ----------
    start_time : float
        When the run starts (s).
    duration : float
        How long it lasts (s); NaN where each record of a suite sets it.
    output_step : float
        Distance of the rows of the history (s); NaN as above.
    energy : bool
        Whether to keep the energy ledger.
    error_estimate : bool, optional
        Whether to estimate the errors of peaks and final values; None where nothing is said.
    stated : Stated
        What is said of quantities.
    in_equilibrium : bool
        Whether the scene was put where its forces hold it.
    """

    start_time: float
    duration: float
    output_step: float
    energy: bool = False
    error_estimate: bool | None = None
    stated: Stated = DEFAULTS
    in_equilibrium: bool = False


LARGEST_RTOL, SMALLEST_RTOL = 1e-2, 1e-14
"""Relative tolerances that a solver is given; beyond, they mean nothing in doubles."""


@dataclass(frozen=True, slots=True)
class SolverOptions:
    """What computes it, and how accurately.

    Parameters
    ----------
    name : str
        The solver.
    rtol : float
        Relative tolerance.
    atol : mapping of str to float
        Absolute tolerances by ``"displacement"`` (m), ``"velocity"`` (m/s) and
        ``"z"``, where they were given.
    settings : mapping
        Keys of the solver's own (SI).
    """

    name: str = "cvode"
    rtol: float = 1.0e-9
    atol: Mapping[str, float] = field(default_factory=dict)
    settings: Mapping[str, object] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class PiTable:
    """What a case written in Π-terms says.

    Parameters
    ----------
    structure : PiStructure
        Kind and row of the structures.
    terms : mapping of str to float
        Π-terms as they are given, by the keys of `eventpound.scene.pi_terms`.
    periods : float or None
        Length of the run in periods T_p = 2 pi / omega_g.
    """

    structure: PiStructure
    terms: Mapping[str, float]
    periods: float | None


@dataclass(frozen=True, slots=True)
class Case:
    """Everything that a case directory says.

    Parameters
    ----------
    title : str
        One line; the name of the directory where none is given.
    scene : Scene
        What moves.
    run : RunOptions
        What is to be computed.
    solver : SolverOptions
        What computes it.
    directory : Path
        Where the case lies.
    source_hash : str
        SHA-256 of ``case.toml``, in hexadecimal digits.
    record : RecordData or None
        What was read from the file of a record.
    warnings : tuple of str
        What is computed as it is asked for, but hardly meant so.
    understood : dict
        The case in SI with every default filled in: a case again, which can be
        written as JSON or TOML.
    suite : Suite or None
        The records the scene is to run under, one after the other. The motion of
        the scene is then none, and times of `run` that each record sets are NaN.
    figure : Figure or None
        What is drawn.
    pi : PiTable or None
        The Π-terms of a case that is written in them.
    carried : mapping of str to float
        Masses (kg) that the springs' periods are those of, by the names of the springs
        that have one.
    largest_scale : float
        Factor on a record beyond which is warned.
    """

    title: str
    scene: Scene
    run: RunOptions
    solver: SolverOptions
    directory: Path
    source_hash: str
    record: RecordData | None
    warnings: tuple[str, ...]
    understood: dict[str, object]
    suite: Suite | None = None
    figure: Figure | None = None
    pi: PiTable | None = None
    carried: Mapping[str, float] = field(default_factory=dict)
    largest_scale: float = LARGEST_SCALE

    def apart(self, scene: Scene) -> Case:
        """The same of another scene, of which nothing is asked beyond what it gives."""
        return replace(self, scene=scene, run=replace(self.run, stated=DEFAULTS))

    def __repr__(self) -> str:
        scene = self.scene
        many = "" if self.suite is None else ", a suite of records"
        return (
            f"<Case {self.title!r}: {len(scene.bodies)} bodies, {len(scene.springs)} springs, "
            f"{len(scene.dashpots)} dashpots, {len(scene.contacts)} contacts, {scene.motion.kind}"
            f"{many}; {self.solver.name}, rtol {self.solver.rtol:g}>"
        )
