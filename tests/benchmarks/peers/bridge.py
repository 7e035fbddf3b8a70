"""OpenSeesPy on a bridge under El Centro: what is wrong by its steps, and what by its spring.

`cases/bridge-el-centro` with Kelvin-Voigt contacts of some stiffnesses K in the place of Newton's
law. A peak is the largest |u| of a segment, its error in parts of it; of both the larger error: of
our run with the spring and of OpenSees against Newton's law, and of OpenSees against our run with
the same spring. Times are of the processor.
"""

import time
from dataclasses import replace
from importlib.util import find_spec
from typing import Any

import numpy as np

from eventpound import Case, ComputationError, ContactLaw, load_case
from eventpound.numerics.arrays import Floats
from eventpound.simulation import response_of
from eventpound.solvers.opensees import PACKAGE
from tests.models import CASES

CASE = CASES / "bridge-el-centro"
STIFFNESSES = (1e8, 1e9, 1e10)
STEPS = (1e-3, 1e-4)
RTOL = 1e-6


def with_spring(case: Case, stiffness: float) -> Case:
    """The case with Kelvin-Voigt contacts of a stiffness (N/m)."""
    law = ContactLaw("kelvin-voigt", stiffness)
    contacts = tuple(replace(contact, law=law) for contact in case.scene.contacts)
    return replace(case, scene=replace(case.scene, contacts=contacts))


def peaks(case: Case, solver: str, **options: Any) -> tuple[Floats | None, float]:
    """Peaks of the bodies (m), None where the run fails, and its processor time (s)."""
    began = time.process_time()
    try:
        found = response_of(case, solver, **{"rtol": RTOL} | options).recording.displacement
    except ComputationError:
        return None, time.process_time() - began
    return np.maximum(found.maximum, -found.minimum), time.process_time() - began


def _far(found: Floats | None, true: Floats | None) -> str:
    if found is None or true is None:
        return "fails"
    return f"{100.0 * float(np.abs(found / true - 1.0).max()):.2g}"


def main() -> None:
    """Print the table."""
    steps = " / ".join(f"{step:g}" for step in STEPS)
    heads = ["contact", "ours (ms)", "ours, peaks off (%)", f"OpenSees at {steps} s, peaks off (%)"]
    heads += ["off our spring's (%)", "time (s)"]
    print("| " + " | ".join(heads) + " |\n|" + " --- |" * len(heads))
    case = load_case(CASE)
    for solver in ("cvode", "fast"):
        peaks(case, solver)
    true, _ = peaks(case, "cvode")
    spent = min(peaks(case, "fast")[1] for _ in range(5))
    print(f"| Newton, `fast` | {1e3 * spent:.3g} | 0 |" + " |" * (len(heads) - 3), flush=True)
    for stiffness in STIFFNESSES:
        sprung = with_spring(case, stiffness)
        peaks(sprung, "cvode")
        own, spent = peaks(sprung, "cvode")
        cells = [f"K = {stiffness:.0e} N/m, `cvode`", f"{1e3 * spent:.3g}", _far(own, true)]
        if find_spec(PACKAGE) is None:
            cells += ["absent", "", ""]
        else:
            runs = [peaks(sprung, "opensees", settings={"time_step": step}) for step in STEPS]
            cells += [" / ".join(_far(found, of) for found, _ in runs) for of in (true, own)]
            cells.append(" / ".join(f"{seconds:.2g}" for _, seconds in runs))
        print("| " + " | ".join(cells) + " |", flush=True)
