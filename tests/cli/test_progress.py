"""What is said while kernels are compiled."""

from eventpound.cli.progress import CompilationLine
from eventpound.numerics.compiling import Compiling


def test_every_long_compilation_is_announced_the_short_ones_once(capsys):
    """Those of the steps are short; that of the events comes later, in the same run or another."""
    line = CompilationLine()
    for name, total in (("steps", 40), ("steps", 40), ("looks", 20), ("events", 300)):
        for done in (1, total):
            line(Compiling(name, done, total, 0.1))
        line(None)
    first, second = capsys.readouterr().err.splitlines()
    assert "compiling what this needs" in first
    assert "about 36 s" in second
