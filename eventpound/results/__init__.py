"""Results on disk: written whole or not at all, and read back."""

from eventpound.results.export import export as export
from eventpound.results.files import check_writable as check_writable
from eventpound.results.files import write_together as write_together
from eventpound.results.read import StoredResults as StoredResults
from eventpound.results.read import gather as gather
from eventpound.results.read import read as read
from eventpound.results.write import write as write
