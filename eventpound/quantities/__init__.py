"""One list of all numbers of a run, from which tables, figures and messages are made.

``base`` says what an entry is, ``listed`` has them all, ``values`` how each is computed, ``lookup``
leads from names to values; ``contacts`` computes what events tell, ``between`` what only
close rows of a history tell.
"""

from eventpound.quantities.base import SIX, Quantity, Source, pi_unit
from eventpound.quantities.listed import LISTED
from eventpound.quantities.lookup import (
    FREE,
    Named,
    all_of,
    asked,
    chosen,
    find,
    is_whole,
    ledger_of,
    listing,
    names_of,
    needs_accelerations,
    needs_energy,
    needs_free,
    needs_impacts,
    needs_one,
    tabled,
    unstated,
    values_of,
)
from eventpound.quantities.owners import owners

__all__ = [
    "FREE",
    "LISTED",
    "SIX",
    "Named",
    "Quantity",
    "Source",
    "all_of",
    "asked",
    "chosen",
    "find",
    "is_whole",
    "ledger_of",
    "listing",
    "names_of",
    "needs_accelerations",
    "needs_energy",
    "needs_free",
    "needs_impacts",
    "needs_one",
    "owners",
    "pi_unit",
    "tabled",
    "unstated",
    "values_of",
]
