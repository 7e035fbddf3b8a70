"""Commands that measure work, time and memory and print tables; docs/measured has them.

What they measure is compiled code, whatever a run of theirs would do by itself.
"""

from __future__ import annotations

from eventpound.numerics.patience import compiled_at_once

_always = compiled_at_once()
_always.__enter__()
