"""Which options of ``[run]`` hold for which way to run a case: one table.

What holds is computed, with its columns. What would make no sense is refused by name before
anything runs. What a command that computes something else leaves out is said in a warning.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from enum import StrEnum

from eventpound.basics.warned import OptionWarning, warn_caller
from eventpound.case.case import DEFAULTS, Case, RunOptions
from eventpound.errors import InputError, told_of
from eventpound.quantities.lookup import asked, ledger_of, needs_energy
from eventpound.scene.scene import Scene


class Way(StrEnum):
    """A way to run a case, as messages call it."""

    RUN = "a single run"
    SUITE = "a suite"
    STUDY = "a study"
    MANY = "simulate_many"
    VERIFY = "verify"
    COMPARE = "compare"
    EXPORT = "export"
    FLOOR = "floor spectra"


_RUNS = frozenset({Way.RUN, Way.SUITE, Way.STUDY, Way.MANY})
HOLDS: Mapping[str, frozenset[Way]] = {
    "start_time": frozenset(Way),
    "duration": frozenset(Way),
    "start": frozenset(Way) - {Way.STUDY, Way.MANY},
    "output_step": frozenset({Way.RUN, Way.SUITE}),
    "energy": _RUNS,
    "quantities": _RUNS,
    "without_contact": _RUNS,
    "contact_stiffness": _RUNS,
    "threshold_speed": _RUNS,
    "avoiding_gap": _RUNS,
    "units": frozenset({Way.RUN, Way.SUITE}),
    "events": frozenset({Way.RUN, Way.SUITE}),
    "error_estimate": frozenset({Way.RUN, Way.SUITE}),
}
"""Ways in which each option of ``[run]`` does what it says."""
REFUSED: Mapping[str, tuple[frozenset[Way], str]] = {
    "start": (
        frozenset({Way.STUDY, Way.MANY}),
        '"initial", where numbers of the scene vary: all would start in the equilibrium of one',
    ),
    "error_estimate": (
        frozenset({Way.STUDY, Way.MANY}),
        "a single run or a suite; of some runs, `eventpound verify` of a case with their numbers",
    ),
}
"""Ways that refuse an option, and what is accepted. Others leave out what does not hold."""
_GIVEN: Mapping[str, Callable[[RunOptions], bool]] = {
    "start": lambda run: run.in_equilibrium,
    "energy": lambda run: run.energy,
    "quantities": lambda run: bool(run.stated.quantities),
    "without_contact": lambda run: run.stated.without_contact,
    "contact_stiffness": lambda run: run.stated.contact_stiffness is not None,
    "threshold_speed": lambda run: run.stated.threshold_speed != DEFAULTS.threshold_speed,
    "avoiding_gap": lambda run: run.stated.avoiding_gap,
    "units": lambda run: bool(run.stated.units),
    "events": lambda run: bool(run.stated.events),
    "error_estimate": lambda run: bool(run.error_estimate),
}
"""Whether an option is given; times always have a value."""


def refuse_options(case: Case, way: Way, varied: Iterable[str] = ()) -> None:
    """Refuse options of a case that make no sense in a way to run it.

    Parameters
    ----------
    case : Case
        What is run.
    way : Way
        How.
    varied : iterable of str
        Dotted keys of numbers that vary.

    Raises
    ------
    InputError
        With a line for every option.
    """
    # Those of the ground motion move no equilibrium.
    moving = any(not key.startswith("excitation.") for key in varied)
    problems = [
        f"[run]: {option}: not for {way}; accepted: {accepted}"
        for option, (ways, accepted) in REFUSED.items()
        if way in ways and _GIVEN[option](case.run) and (option != "start" or moving)
    ]
    if problems:
        raise InputError(problems)


def warn_left_out(case: Case | Scene, way: Way) -> None:
    """Say which options of a case play no part in what is computed of it.

    Warns
    -----
    OptionWarning
        In one line, where there are some.
    """
    if not isinstance(case, Case):
        return
    left = [name for name, given in _GIVEN.items() if way not in HOLDS[name] and given(case.run)]
    if left:
        warn_caller(without_part(left, way), OptionWarning)


def without_effect(way: Way) -> list[str]:
    """Options that a way to run neither follows nor refuses."""
    refused = {option for option, (ways, _) in REFUSED.items() if way in ways}
    return [option for option, ways in HOLDS.items() if way not in ways and option not in refused]


def without_part(options: Iterable[str], way: Way) -> str:
    """What is said of options that play no part."""
    return f"[run]: {', '.join(options)}: no part of {way}, only of `eventpound run`"


def quantities_asked(parts: Iterable[tuple[Scene, RunOptions]]) -> list[str]:
    """Names of the quantities that ``[run]`` asks for where many runs are tabulated.

    Parameters
    ----------
    parts : iterable of (Scene, RunOptions)
        Scenes and the options of each; where there are several, one that has it is enough.

    Raises
    ------
    InputError
        Naming every option that no scene has anything for.
    """
    parts = list(parts)
    with told_of("[run]: "):
        names = asked((scene, run.stated) for scene, run in parts)
    ledger = [
        name
        for scene, run in parts
        if run.energy or needs_energy(names)
        for name in ledger_of(scene)
    ]
    return list(dict.fromkeys([*ledger, *names]))
