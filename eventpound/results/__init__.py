"""Results on disk: written whole or not at all, and read back."""

from eventpound.results.export import export
from eventpound.results.files import check_writable, write_together
from eventpound.results.read import StoredResults, gather, read
from eventpound.results.write import write

__all__ = [
    "StoredResults",
    "check_writable",
    "export",
    "gather",
    "read",
    "write",
    "write_together",
]
