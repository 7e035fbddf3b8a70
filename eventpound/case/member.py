"""The case of one record of a suite."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from eventpound.case.case import Case
from eventpound.case.suite import Member
from eventpound.case.understood import sources_of, understood_case
from eventpound.motion import RecordData


def member_of(case: Case, name: str) -> Member:
    """A record of the suite of a case, by its name."""
    assert case.suite is not None
    return next(m for m in case.suite.members(case.directory) if m.name == name)


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
    scene = replace(member.on(case.scene), motion=member.options.motion(data))
    run = case.run.completed(scene)
    read = member.of_file(data)
    sources = sources_of(case.understood)
    understood = understood_case(case.title, read, scene, run, case.solver, sources)
    records = {name: own.of_file(own.read()) for name, own in member.supports}
    driven: dict[str, Any] = {
        key: case.understood[key] for key in ("support", "force") if key in case.understood
    }
    if records:
        driven["support"] = [
            {**table, "excitation": records[table["name"]]} if table["name"] in records else table
            for table in driven["support"]
        ]
    return replace(
        case,
        title=f"{case.title}: {member.name}",
        scene=scene,
        run=run,
        record=data,
        suite=None,
        figures=(),
        understood=understood | driven,
    )
