"""``eventpound check``: read a case and say what was understood."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from eventpound.cli.arguments import (
    Commands,
    add_case,
    add_command,
    check_solver_of,
    load,
    show_warnings,
)
from eventpound.errors import InputError

if TYPE_CHECKING:
    from eventpound.case import Case
    from eventpound.scene.spring import Spring

_MOST_SPRINGS = 12
"""Hysteretic springs that are listed."""
_MOST_BODIES = 300
"""Of a scene whose longest periods are looked for."""


def add(commands: Commands[argparse.ArgumentParser]) -> None:
    """Add the command to the parser."""
    text = "read a case and say what was understood or is wrong"
    add_case(add_command(commands, "check", _check, text))


def _check(options: argparse.Namespace) -> int:
    from eventpound.case.loading import read_document

    if "study" in read_document(options.case)[0]:
        return _check_study(options.case)
    case = load(options.case)
    check_solver_of(case)
    print(f"case      {case.title}")
    for line in (*_scene_lines(case), *_motion_lines(case)):
        print(line)
    print(f"solver    {case.solver.name}, rtol {case.solver.rtol:g}")
    return 0


def _scene_lines(case: Case) -> Iterator[str]:
    """How many parts there are, hysteretic springs and longest periods."""
    from eventpound.scene.spring import BoucWen

    scene = case.scene
    counts = {
        "bodies": scene.bodies,
        "springs": scene.springs,
        "dashpots": scene.dashpots,
        "contacts": scene.contacts,
    }
    yield "scene     " + ", ".join(f"{what}: {len(some)}" for what, some in counts.items())
    hysteretic = [spring for spring in scene.springs if isinstance(spring.law, BoucWen)]
    for spring in hysteretic[:_MOST_SPRINGS]:
        yield _spring_line(spring, case.carried.get(spring.name))
    if len(hysteretic) > _MOST_SPRINGS:
        yield f"          and {len(hysteretic) - _MOST_SPRINGS} more bouc-wen springs"
    if scene.springs and len(scene.bodies) <= _MOST_BODIES:
        yield from _period_lines(case, bool(hysteretic))


def _spring_line(spring: Spring, mass: float | None) -> str:
    """A hysteretic spring: its six parameters, and its periods where they have a mass."""
    from eventpound.scene.damping import initial_stiffness, post_yield_stiffness
    from eventpound.scene.periods import period_of
    from eventpound.scene.spring import BoucWen

    law = spring.law
    assert isinstance(law, BoucWen)
    first, later = initial_stiffness(law) or 0.0, post_yield_stiffness(law) or 0.0
    text = (
        f"spring    {spring.name}: bouc-wen, K0 = {first:.5g} N/m, K_s = {later:.5g} N/m, "
        f"F_y = {first * law.yield_displacement:.5g} N, Q = {law.strength:.5g} N, "
        f"u_y = {law.yield_displacement:.5g} m"
    )
    if mass is None:
        return text
    return (
        f"{text}\n          period of {mass:.6g} kg on it: {period_of(mass, first):.4g} s initial, "
        f"{period_of(mass, later):.4g} s post-yield"
    )


def _period_lines(case: Case, hysteretic: bool) -> Iterator[str]:
    """Longest period of the whole scene, before and after yield."""
    from eventpound.scene.periods import longest_period

    try:
        first = longest_period(case.scene)
        later = longest_period(case.scene, yielded=True) if hysteretic else None
    except InputError:
        return
    if first is not None:
        yielded = "" if later is None else f", {later:.4g} s with every spring post-yield"
        yield f"period    {first:.4g} s, the longest of the scene without contact{yielded}"


def _motion_lines(case: Case) -> Iterator[str]:
    """The ground motion, or how many there are, and the run."""
    motion, run = case.scene.motion, case.run
    scales = motion.scales()
    sizes = "" if scales is None else f", a_g = {scales.a_g:.6g} m/s^2, T_g = {scales.period:.6g} s"
    if case.suite is None:
        yield f"motion    {motion.kind}{sizes}"
        yield (
            f"run       {run.start_time:g} to {run.start_time + run.duration:.6g} s, "
            f"a row every {run.output_step:.6g} s"
        )
    else:
        yield f"suite     {len(case.suite.members(case.directory))} records, a run each"
        if case.suite.options.scaling:
            yield f"scaling   {case.suite.options.scaling}"


def _check_study(path: Path) -> int:
    """Say what was understood of a case with a [study]."""
    from eventpound.study.reading import load_study

    case = load_study(path)
    study = case.study
    show_warnings(case.warnings)
    print(f"study     {study.title}")
    print(f"runs      {study.size} of {len(study.bases)} scenes, {study.chunk_size} a chunk")
    print(f"axes      {', '.join(study.columns)}")
    print(f"tabulates {', '.join(study.quantities)}")
    print(f"solver    {study.solver}, rtol {study.rtol:g}")
    return 0
