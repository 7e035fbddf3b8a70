"""Tables of one run, with their units in ``attrs``, and its numbers without dimension."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from eventpound.quantities.base import SIX, pi_unit
from eventpound.quantities.lookup import all_of, tabled
from eventpound.quantities.owners import owners_of
from eventpound.quantities.runs import Runs
from eventpound.scene.pi_terms import pi_terms
from eventpound.scene.scene import Scene

if TYPE_CHECKING:
    import pandas as pd


def peaks_table(run: Runs) -> pd.DataFrame:
    """Extremes of the displacements of a run, a row a body."""
    import pandas as pd

    peaks = {
        word: [float(pick(run.displacement, i)[0]) for i in range(run.u.shape[1])]
        for word, (_, pick) in SIX.items()
    }
    names = [body.name for body in run.scene.bodies]
    table = pd.DataFrame(peaks, index=pd.Index(names, name="body"))
    table.attrs["units"] = {word: "s" if word.startswith("t_") else "m" for word in SIX}
    return table


def parts_table(scene: Scene, values: Mapping[str, Any], owner: str) -> pd.DataFrame:
    """Quantities of one kind of parts, as springs, that are among some values, a row each."""
    import pandas as pd

    rows: dict[str, dict[str, object]] = {}
    units: dict[str, str] = {}
    names = owners_of(scene, owner)
    for named in all_of(scene):
        before, _, column = named.quantity.path.partition(f"s.<{owner}>.")
        if before == owner and named.name in values:
            rows.setdefault(names[named.i], {})[column] = values[named.name]
            units[column] = named.quantity.dimension.unit
    table = pd.DataFrame.from_dict(rows, orient="index")
    table.index.name = owner
    table.attrs["units"] = units
    return table


def pi_numbers(run: Runs) -> dict[str, float]:
    """Π-terms of a run, then every quantity with a unit as one, where there are scales."""
    found, scene = dict(pi_terms(run.scene)), run.scene
    scales = scene.motion.scales()
    for named in tabled(run) if scales is not None else ():
        if named.quantity.dimension.unit and scales is not None:
            unit = pi_unit(named.quantity.dimension, scales, scene.bodies[0].mass)
            found[named.name] = float(named.of(run)[0]) / unit
    return found
