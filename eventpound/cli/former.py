"""Names that commands had before, each answered with the command that does the same now."""

from __future__ import annotations

import shlex

SECOND_WORDS = {"problems": ("pack", "score"), "records": ("synthetic",)}
"""Words that make a command of its own of the one before."""
_NOW = {
    "quantities": ("check", "--markdown", "--quantities"),
    "export": ("run", "--out", "--export DIR"),
    "figures": ("plot", "", ""),
    "spectrum": ("study", "", "--spectrum"),
    "fragility": ("study", "", "--fragility"),
    "record": ("records", "", ""),
    "synthetic": ("records synthetic", "", ""),
    "score": ("problems score", "", ""),
    "problems": ("problems pack", "", ""),
    "floor": ("floor-spectrum", "", ""),
    "compile": ("solvers", "--solver", "--compile"),
}
"""The command of now, an option that is called differently, and what it is called or joins them."""


def joined(words: list[str]) -> list[str]:
    """The words of a command line, a command of two words as one."""
    at = _first(words)
    if words[at + 1 : at + 2] and words[at + 1] in SECOND_WORDS.get(words[at], ()):
        return [*words[:at], " ".join(words[at : at + 2]), *words[at + 2 :]]
    return words


def now(words: list[str]) -> str | None:
    """What a command of before is called now, with its words; None for one of now."""
    at = _first(words)
    name, rest = "".join(words[at : at + 1]), words[:at] + words[at + 1 :]
    if name not in _NOW or (name == "problems" and all(word.startswith("-") for word in rest)):
        return None
    command, option, instead = _NOW[name]
    if option and option in rest:
        rest = [instead.split()[0] if word == option else word for word in rest]
    elif name == "figures" and not rest:
        rest = ["cases"]
    else:
        rest += instead.split()
    return f"{name!r} is now: eventpound {command} {shlex.join(rest)}"


def _first(words: list[str]) -> int:
    """Where the command stands, behind what is said of all of them."""
    return next((i for i, word in enumerate(words) if not word.startswith("-")), len(words))
