"""The rigid law beside contact laws: what a spring in a contact does to a result.

A run of a scene with contact laws is held against that scene, which tells what its steps
do, and against the same scene under Newton's law, which tells what they and the springs do. The
reference of the one held against that of the other is what the springs alone do.
"""

from __future__ import annotations

from dataclasses import replace

from eventpound.accuracy.errors import Errors, errors_of
from eventpound.accuracy.reference import Reference, reference_of
from eventpound.case.case import Case, RunOptions
from eventpound.errors import ComputationError, InputError
from eventpound.scene.check import check_scene
from eventpound.scene.rigid import rigid


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
        ε in the place of every law; without, what each stands for.

    Raises
    ------
    InputError
        Where a restitution is given and no contact has a law.
    """
    laws = [contact for contact in case.scene.contacts if contact.law is not None]
    if not laws:
        if restitution is not None:
            raise InputError("--restitution: no contact of the case has a law of its own")
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


def error_of_laws(case: Case, reference: Reference) -> Errors | None:
    """What the contact laws alone do to the motion; None where no rigid law is beside it."""
    beside = reference.rigid
    if beside is None:
        return None
    rows = beside.rows(reference.task.output_times)
    return errors_of(case.scene, reference.truth.recording, beside.truth, rows, rests=False)
