"""A seat: what carries an end of a deck, whose opening is looked at."""

from __future__ import annotations

from eventpound.basics.given import converting


@converting
class Seat:
    """A ledge or an abutment that carries a body, on which nothing has to touch.

    It opens where the second end moves to the right of the first, as the gap of a contact does.

    Parameters
    ----------
    name : str
        Unique among the seats.
    between : tuple of str
        Left and right end: bodies, supports or the ground.
    """

    name: str
    between: tuple[str, str]
