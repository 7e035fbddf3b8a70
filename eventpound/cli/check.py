"""``eventpound check``: read a case and say what was understood."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from eventpound.cli.arguments import Commands, add_case, add_command, load


def add(commands: Commands[argparse.ArgumentParser]) -> None:
    """Add the command to the parser."""
    text = "read a case and say what was understood or is wrong"
    add_case(add_command(commands, "check", _check, text))


def _check(options: argparse.Namespace) -> int:
    from eventpound.case.loading import read_document

    if "study" in read_document(options.case)[0]:
        return _check_study(options.case)
    case = load(options.case)
    scene, run = case.scene, case.run
    counts = {
        "bodies": scene.bodies,
        "springs": scene.springs,
        "dashpots": scene.dashpots,
        "contacts": scene.contacts,
    }
    print(f"case      {case.title}")
    print("scene     " + ", ".join(f"{what}: {len(some)}" for what, some in counts.items()))
    scales = scene.motion.scales()
    sizes = "" if scales is None else f", a_g = {scales.a_g:.6g} m/s^2, T_g = {scales.period:.6g} s"
    print(f"motion    {scene.motion.kind}{sizes}")
    if case.suite is None:
        print(
            f"run       {run.start_time:g} to {run.start_time + run.duration:.6g} s, "
            f"a row every {run.output_step:.6g} s"
        )
    else:
        print(f"suite     {len(case.suite.members(case.directory))} records, a run each")
    print(f"solver    {case.solver.name}, rtol {case.solver.rtol:g}")
    return 0


def _check_study(path: Path) -> int:
    """Say what was understood of a case with a [study]."""
    from eventpound.study.reading import load_study

    case = load_study(path)
    study = case.study
    for warning in case.warnings:
        print(f"eventpound: warning: {warning}", file=sys.stderr)
    print(f"study     {study.title}")
    print(f"runs      {study.size} of {len(study.bases)} scenes, {study.chunk_size} a chunk")
    print(f"axes      {', '.join(study.columns)}")
    print(f"tabulates {', '.join(study.quantities)}")
    print(f"solver    {study.solver}, rtol {study.rtol:g}")
    return 0
