"""Kernels are compiled once before all tests; ``--quick`` leaves out what would compile."""

import signal
import subprocess
import sys

import pytest

from eventpound.numerics.compiled import by_python
from eventpound.numerics.compiling import Compiling, watched


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--quick", action="store_true", help="skip every test that would compile")


def pytest_sessionstart(session: pytest.Session) -> None:
    """Make all kernels before the whole of the tests, in parallel and for all workers."""
    config = session.config
    everything = config.args_source is pytest.Config.ArgsSource.TESTPATHS
    worker = hasattr(config, "workerinput")
    if everything and not (worker or config.option.collectonly or config.option.quick):
        subprocess.run([sys.executable, "-m", "eventpound", "solvers", "--compile"], check=True)


@pytest.fixture(autouse=True)
def heeded_interrupts():
    """A shell that runs the tests in the background has them ignore SIGINT."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.fixture(autouse=True)
def compiles_nothing(request):
    """Under ``--quick`` a test ends, skipped, where it begins to compile."""
    if not request.config.option.quick:
        yield
        return
    with watched(_skip):
        yield


@pytest.fixture
def undrawn():
    """Figures are blank: a test of numbers and words does not wait until they are drawn."""
    from tests.blank import blank_figures

    with blank_figures():
        yield


@pytest.fixture
def interpreted():
    """Kernels that no run calls from Python are not compiled for a test: Python runs them.

    That compiled code gives the same is shown of whole runs, in solvers/test_in_python.py.
    """
    with by_python():
        yield


def _skip(state: Compiling | None) -> None:
    if state is not None:
        pytest.skip(f"compiles {state.name}")
