"""``python -m eventpound``."""

import sys

from eventpound.cli import main

sys.exit(main())
