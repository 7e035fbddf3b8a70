"""Figures whose files are blank, for tests of what stands beside them: drawing takes seconds."""

from collections.abc import Iterator
from contextlib import contextmanager

import pytest
from matplotlib.figure import Figure


@contextmanager
def blank_figures() -> Iterator[None]:
    """Files of figures are of their kind, and show nothing; none is laid out before."""
    save = Figure.savefig

    def blank(figure: Figure, file: object, **words: object) -> None:
        save(Figure((1.0, 1.0)), file, **words)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Figure, "savefig", blank)
        patch.setattr(Figure, "draw_without_rendering", lambda figure: None)
        yield
