"""Examples in the docstrings of public names do what they say."""

import doctest

import pytest

import eventpound
from tests.models import ROOT

COMPILED = ("simulate(", "simulate_many(", ".run(")
"""Calls in an example that need a kernel."""


def _examples() -> dict[str, doctest.DocTest]:
    """Those of every public name, and of the methods of a class, by name."""
    finder, names = doctest.DocTestFinder(), {n: getattr(eventpound, n) for n in eventpound.__all__}
    found = [test for name, each in names.items() for test in finder.find(each, name, globs=names)]
    return {test.name: test for test in found if test.examples}


EXAMPLES = _examples()


def test_there_are_some():
    assert len(EXAMPLES) >= 15


@pytest.mark.parametrize("name", EXAMPLES)
def test_an_example(name, request, monkeypatch):
    test = EXAMPLES[name]
    compiled = any(call in each.source for each in test.examples for call in COMPILED)
    if request.config.option.quick and compiled:
        pytest.skip("compiles")
    monkeypatch.chdir(ROOT)
    found: list[str] = []
    doctest.DocTestRunner().run(test, out=found.append)
    assert "".join(found) == ""
