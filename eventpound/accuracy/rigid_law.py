"""The rigid law beside contact laws: what a spring in a contact does to a result.

A run of a scene with contact laws is held against that scene, which tells what its steps
do, and against the same scene under Newton's law, which tells what they and the springs do. The
reference of the one held against that of the other is what the springs alone do.
"""

from __future__ import annotations

from dataclasses import replace

from eventpound.accuracy.quantities import errors_of
from eventpound.accuracy.reference import Reference, reference_of
from eventpound.case.case import Case, RunOptions
from eventpound.errors import ComputationError, InputError
from eventpound.scene.check import check_scene
from eventpound.scene.rigid import rigid
from eventpound.score import Difference


def check_restitution(case: Case, restitution: float | None) -> None:
    """Refuse a restitution that no contact of a case can be held against.

    Raises
    ------
    InputError
        Where no contact has a law, or it is not from 0 to 1.
    """
    if restitution is None:
        return
    if all(contact.law is None for contact in case.scene.contacts):
        raise InputError("--restitution: no contact of the case has a law of its own")
    if not 0.0 <= restitution <= 1.0:
        raise InputError(f"--restitution: found {restitution!r}; accepted: a number from 0 to 1")


def with_rigid(
    case: Case, run: RunOptions, reference: Reference, restitution: float | None = None
) -> Reference:
    """A reference with that of the rigid law beside it, where contacts have laws.

    Parameters
    ----------
    case : Case
        What is run.
    run : RunOptions
        The stretch of time.
    reference : Reference
        Of the case over that.
    restitution : float, optional
        ε in the place of every law; without, what each stands for. `check_restitution` has it.
    """
    laws = [contact for contact in case.scene.contacts if contact.law is not None]
    if not laws:
        return reference
    scene = rigid(case.scene, restitution)
    try:
        check_scene(scene)
        beside = reference_of(replace(case, scene=scene), run, None)
    except (InputError, ComputationError) as error:
        return replace(reference, rigid_words=f"not to be had: {error}")
    names = {contact.name for contact in laws}
    said = [f"{c.name} {c.restitution:.3g}" for c in scene.contacts if c.name in names]
    words = f"Newton's with a restitution of {', '.join(said)}; {beside.words}"
    return replace(reference, rigid=beside, rigid_words=words)


def error_of_laws(case: Case, reference: Reference) -> Difference | None:
    """What the contact laws alone do to the motion; None where no rigid law is beside it."""
    beside = reference.rigid
    if beside is None:
        return None
    rows = beside.rows(reference.task.output_times)
    return errors_of(case.scene, reference.recording, beside.truth, rows, rests=False)
