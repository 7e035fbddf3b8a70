"""Results on disk: written whole or not at all, and read back."""

from eventpound.results.export import export as export
from eventpound.results.files import check_writable as check_writable
from eventpound.results.files import write_together as write_together
from eventpound.results.run_files import StoredResults as StoredResults
from eventpound.results.run_files import gather as gather
from eventpound.results.run_files import read as read
from eventpound.results.run_files import write as write
