"""The case of one record of a suite."""

from __future__ import annotations

import math
from dataclasses import replace

from eventpound.case.case import Case
from eventpound.case.defaults import default_duration, default_output_step
from eventpound.case.suite import Member
from eventpound.case.understood import understood_case
from eventpound.errors import InputError
from eventpound.motion import RecordData


def member_case(case: Case, member: Member, data: RecordData) -> Case:
    """What a suite's case says for one of its records.

    Parameters
    ----------
    case : Case
        Of the suite.
    member : Member
        Which record.
    data : RecordData
        What was read of it.

    Returns
    -------
    Case
        A case of one record.

    Raises
    ------
    InputError
        Where the record cannot be used, or sets no duration.
    """
    motion = member.options.motion(data)
    scene = replace(case.scene, motion=motion)
    run = case.run
    if math.isnan(run.duration):
        try:
            run = replace(run, duration=default_duration(scene, run.start_time))
        except InputError as error:
            raise InputError([f"duration: {problem}" for problem in error.problems]) from error
    if math.isnan(run.output_step):
        run = replace(run, output_step=default_output_step(motion, run.duration))
    understood = {
        "kind": "record",
        "file": member.file,
        "format": data.format,
        "units": data.units,
        "time_step": data.time_step,
        **member.options.understood(),
    }
    return replace(
        case,
        title=f"{case.title}: {member.name}",
        scene=scene,
        run=run,
        record=data,
        suite=None,
        figure=None,
        understood=understood_case(case.title, understood, scene, run, case.solver),
    )
