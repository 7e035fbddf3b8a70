"""Files that were damaged at random: read, or refused with a message, and never anything else."""

from __future__ import annotations

import random
from pathlib import Path

import pytest

from eventpound.errors import InputError
from eventpound.motion.readers import RecordData, read_components
from tests.motion.readers.writers import WRITERS, Written, motion

SIZE, STEP = 60, 0.1
MUTATIONS = 60
"""For each format; 1 500 of each were tried when this was written."""


def mutated(content: bytes, random_: random.Random) -> bytes:
    """One to three changes of a kind that happens to files."""
    for _ in range(random_.randint(1, 3)):
        lines = content.split(b"\n")
        place = random_.randrange(len(content)) if content else 0
        line = random_.randrange(len(lines))
        match random_.randrange(7):
            case 0:
                content = content[:place]
            case 1:
                content = b"\n".join(lines[:line] + lines[line + 1 :])
            case 2:
                content = b"\n".join([*lines[:line], lines[line], *lines[line:]])
            case 3:
                content = content[:place] + random_.randbytes(1) + content[place + 1 :]
            case 4:
                content = (
                    content[:place]
                    + random_.choice([b"NaN", b"-", b" ", b"9e999", b"*"])
                    + (content[place + 1 :])
                )
            case 5:
                content = content[:place] + content[place + random_.randint(1, 30) :]
            case 6:
                digits = [i for i, byte in enumerate(content[:2000]) if 48 <= byte < 58]
                at = random_.choice(digits) if digits else 0
                content = content[:at] + b"%d" % random_.randint(0, 9) + content[at + 1 :]
    return content


@pytest.mark.parametrize("name", WRITERS)
def test_damage_is_refused_with_a_message_or_harmless(name: str, tmp_path: Path) -> None:
    written = WRITERS[name](motion(SIZE, STEP), STEP)
    content = written.text.encode()
    path = tmp_path / "damaged"
    random_ = random.Random(name)
    for _ in range(MUTATIONS):
        path.write_bytes(mutated(content, random_))
        outcome = _read(path, written)
        if isinstance(outcome, InputError):
            assert all("damaged" in problem for problem in outcome.problems)
        else:
            assert all(data.acceleration.size > 1 and data.time_step > 0.0 for data in outcome)


def _read(path: Path, written: Written) -> list[RecordData] | InputError:
    units, time_step = written.units or "g", written.time_step or STEP
    try:
        return read_components(path, units=units, time_step=time_step, as_needed=True)
    except InputError as error:
        return error
