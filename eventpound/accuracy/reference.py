"""The run that others are judged by, and how far it may be off itself.

CVODE at a tight tolerance, checked by the fast solver at the same one: two methods that share the
laws of impact and rest and little else. A scene that the fast solver does not take is checked by
CVODE's other method, in other coordinates. The difference of the two is the floor under every
error stated. Where the case has a
``certificate.json``, its values and bounds take the place of the two runs' for the quantities it
certifies.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from eventpound.accuracy.quantities import errors_of, truth_of, values_by_name
from eventpound.case.case import Case
from eventpound.case.run_options import RunOptions
from eventpound.case.solver_options import SolverOptions
from eventpound.errors import ComputationError, InputError
from eventpound.numerics.arrays import Floats
from eventpound.results.jsontext import read_json
from eventpound.scene.scene import Scene
from eventpound.score.difference import Difference, ScaledValue, Truth
from eventpound.simulation import task_with
from eventpound.solvers import knows_scene, solver_named
from eventpound.solvers.base import History, Recording, Task

CERTIFICATES = ("results/certificate.json", "certificate.json")
"""Where a certificate may lie in a case directory; the first one there is believed."""
DOUBT = 100.0
"""How many times the difference of two runs a certified value may be off one of them."""
ROUNDING = 1e-9
"""Part of the scale that the arithmetic of another machine may make, however small a bound."""


@dataclass(frozen=True)
class CertifiedBounds:
    """Certified quantities of a case.

    Parameters
    ----------
    file : Path
        Where they stand.
    certified : mapping of str to tuple of float
        Value and bound (SI) by the name of the quantity, as in ``summary.json``.
    """

    file: Path
    certified: Mapping[str, tuple[float, float]]

    def instead_of(self, quantities: Sequence[ScaledValue]) -> list[ScaledValue]:
        """Quantities of a run with the values and bounds that are certified in place of its own.

        Raises
        ------
        InputError
            Where a certified value is further from the run's than the bounds of both allow: it is
            of another case.
        """
        found = []
        for q in quantities:
            value, bound = self.certified.get(q.name, (q.value, q.bound))
            # Where the run was not checked, the certificate's bound stands for its own.
            own = bound if math.isnan(q.bound) else q.bound
            slack = bound + DOUBT * own + ROUNDING * q.scale
            if q.name in self.certified and abs(value - q.value) > slack:
                raise InputError(
                    f"{self.file}: {q.name} = {value:.9g} +- {bound:.1e}, but the "
                    f"case as it stands gives {q.value:.9g}; run eventpound verify again"
                )
            found.append(replace(q, value=value, bound=bound))
        return found


def certified_bounds(case: Case) -> CertifiedBounds | None:
    """What the certificate in a case's directory or its results says; None without one.

    Raises
    ------
    InputError
        Where the file is no certificate.
    """
    files = [case.directory / name for name in CERTIFICATES]
    file = next((path for path in files if path.is_file()), None)
    if file is None:
        return None
    try:
        content = read_json(file)
    except InputError as error:
        raise InputError(f"{error}; run eventpound verify again") from error
    return CertifiedBounds(file, _certified(file, content))


def _certified(file: Path, content: Any) -> dict[str, tuple[float, float]]:
    try:
        return {
            entry["quantity"]: (float(entry["value"]), float(entry["bound"]))
            for entry in content["quantities"]
            if entry["certified"]
        }
    except (KeyError, TypeError, ValueError) as error:
        raise InputError(
            f"{file}: 'quantities' must be a list of quantity, value, bound, certified "
            f"({type(error).__name__}: {error}); run eventpound verify again"
        ) from error


REFERENCE = "cvode"
CHECK = "fast"
"""The solver that checks it."""
OTHER_CHECK: Mapping[str, object] = {"method": "BDF", "coordinates": "relative"}
"""Settings of the reference solver as the check of scenes that `CHECK` does not take."""
TIGHTEST = 1e-13


@dataclass(frozen=True)
class Reference:
    """A case's reference.

    Parameters
    ----------
    task : Task
        The case at the tightest tolerance.
    truth : Truth
        Values, bounds, events and scales.
    recording : Recording
        The run.
    check : Difference or None
        The checking run held against the reference; None where it failed.
    words : str
        What the reference is, in a sentence.
    stated : CertifiedBounds or None
        The certificate that values and bounds are from, as far as it goes.
    rigid : Reference or None
        Where contacts have laws, that of the scene under Newton's
        (`eventpound.accuracy.compare`).
    rigid_words : str
        What that is, or why there is none.
    """

    task: Task
    truth: Truth
    recording: Recording
    check: Difference | None
    words: str
    stated: CertifiedBounds | None
    rigid: Reference | None = None
    rigid_words: str = ""
    _rows: dict[bytes, History] = field(default_factory=dict)

    def rows(self, times: Floats) -> History:
        """The reference at other output times (s), and at its events."""
        key = times.tobytes()
        if key not in self._rows:
            task = replace(self.task, output_times=times)
            self._rows[key] = solver_named(REFERENCE).solve(task).history
        return self._rows[key]


def reference_of(case: Case, options: RunOptions, stated: CertifiedBounds | None) -> Reference:
    """Run the reference of a case and its check.

    Parameters
    ----------
    case : Case
        The case.
    options : RunOptions
        The stretch of time.
    stated : CertifiedBounds or None
        What a certificate says of this case over this stretch.

    Raises
    ------
    ComputationError
        Where the reference fails.
    """
    task = task_with(case.scene, options, SolverOptions(REFERENCE, TIGHTEST), None)
    reference = solver_named(REFERENCE).solve(task)
    checking = _checking_run(task)
    truth = truth_of(task, reference)
    check = None
    if checking is not None:
        known = values_by_name(case.scene, checking)
        own = [replace(q, bound=abs(known[q.name] - q.value)) for q in truth.quantities]
        truth = replace(truth, quantities=own)
        check = errors_of(case.scene, checking, truth, reference.history)
    words = f"{REFERENCE} at rtol {TIGHTEST:g}, "
    by = CHECK if _takes(case.scene) else f"{REFERENCE} by its other method"
    words += f"checked by {by}" if checking is not None else f"not checked: {by} failed"
    if stated is not None:
        truth = replace(truth, quantities=stated.instead_of(truth.quantities))
        words = f"{stated.file}, and for what it does not certify {words}"
    rows = {task.output_times.tobytes(): reference.history}
    return Reference(task, truth, reference, check, words, stated, _rows=rows)


def _takes(scene: Scene) -> bool:
    """Whether the solver that checks takes a scene."""
    return knows_scene(solver_named(CHECK), scene)


def _checking_run(task: Task) -> Recording | None:
    try:
        if _takes(task.scene):
            return solver_named(CHECK).solve(task)
        return solver_named(REFERENCE).solve(replace(task, settings=OTHER_CHECK))
    except ComputationError:
        return None
