"""Contact laws built in Python."""

import pytest

from eventpound.errors import InputError
from eventpound.scene import ContactLaw


def test_units_of_a_law_built_in_python():
    assert ContactLaw("hertz", "2.75e6 kN/m^1.5").stiffness == 2.75e9
    with pytest.raises(InputError, match=r"ContactLaw: stiffness: .*'kN/m' is no unit of Hertz"):
        ContactLaw("hertz", "3 kN/m")
