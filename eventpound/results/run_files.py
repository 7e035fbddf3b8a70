"""Results of a run, written to files, the tables first, the manifest last, and read back.

``summary.json`` has the numbers that one looks at first:

    ductility  mu = max_t |x| / u_y       of a Bouc-Wen spring, x its elongation (m)
    Pi_um      = max_t |u| / L_e          of every body (founding paper, eq. 8)
    residual   = u at the end of the run  (m)

All values are SI; what does not exist in a scene is left out, what has no value
(the scales of a free motion, a force that is not unique) is None.

``history.csv`` has the motion at the output times and, before and after, at events. Its columns:
``t`` (s), ``a_g`` (m/s^2); ``u.<body>`` (m) and ``v.<body>`` (m/s) relative to the ground,
``a.<body>`` (m/s^2) absolute; ``z.<spring>`` (-); ``force.<spring>`` (N); ``gap.<contact>`` (m);
``lambda.<contact>`` (N); ``s.<support>``, ``sv.<support>`` (m, m/s) relative to the ground,
``sf.<support>``, the force on it (N). ``events.csv`` has one row for every contact of every event:
``t`` (s), ``kind``, ``group``, ``contact``, ``gap_velocity_before`` and ``gap_velocity_after``
(m/s), ``impulse`` (N s), ``energy_lost`` (J), ``count``.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from eventpound.basics.given import checked
from eventpound.basics.input_files import read_columns, to_numbers
from eventpound.case.case import Case
from eventpound.case.scene_tables import SUMMARY as SUMMARY
from eventpound.errors import InputError
from eventpound.numerics.arrays import Floats
from eventpound.quantities.base import parts_of
from eventpound.quantities.batch_response import BatchResponse
from eventpound.quantities.history import EVENT_COLUMNS, event_rows, history_columns
from eventpound.quantities.lookup import FREE, Named, find, tabled
from eventpound.quantities.spring_events import SpringEvent, spring_events
from eventpound.response import Response
from eventpound.results.files import write_together
from eventpound.results.jsontext import read_json, to_json
from eventpound.results.manifest import FORMAT, describe_run, describe_scene, sha256
from eventpound.results.tables import rows_csv, table_csv
from eventpound.scene.pi_terms import pi_terms
from eventpound.scene.scene import Scene

if TYPE_CHECKING:
    import pandas as pd


def summarise(
    response: Response, error_estimate: Mapping[str, object] | None = None
) -> dict[str, object]:
    """Summary of a run.

    Parameters
    ----------
    response : Response
        What the run returned.
    error_estimate : mapping, optional
        Errors of peaks and final values, as `eventpound.accuracy.estimate` finds them, in
        place of those of the response.

    Returns
    -------
    dict
        Described key by key on the page "results" of the docs.
    """
    recording, runs = response.recording, response.runs
    summary: dict[str, Any] = {
        "solver": response.solver,
        "success": response.success,
        "message": response.message,
        **({"warnings": response.warnings} if response.warnings else {}),
    }
    for named in tabled(runs):
        _put(summary, named, named.of_one(runs))
    for kind in ("springs", "contacts"):
        summary.setdefault(kind, {})
    for name, value in response.named.items():
        _put_named(summary, response.scene, name, value)
    scales = response.scene.motion.scales()
    known = (None,) * 3 if scales is None else (scales.a_g, scales.omega_g, scales.length)
    summary["scales"] = dict(zip(("a_g", "omega_g", "L_e"), known, strict=True))
    estimate = response.error_estimate if error_estimate is None else error_estimate
    return summary | {
        "pi": _pi(response.scene, runs),
        "error_estimate": estimate,
        "constraint_drift": asdict(recording.drift) if recording.drift else None,
        "work": asdict(response.work),
        "scene": describe_scene(response.scene),
        **({} if response.energy is None else {"energy": _ledger(response)}),
    }


def _ledger(response: Response) -> dict[str, Any]:
    """The energy ledger, with the work of each support by its name."""
    ledger = asdict(response.energy) if response.energy else {}
    works = ledger.pop("supports", ())
    names = [support.name for support in response.scene.supports]
    return ledger | ({"supports": dict(zip(names, works, strict=True))} if names else {})


def _put(summary: dict[str, Any], named: Named, value: object) -> None:
    """Put a value where its path says; the name of its owner is one key, dots and all."""
    before, _, after = parts_of(named.quantity.path)
    if not named.quantity.owner:
        keys = before.split(".")
    else:
        end = len(named.name) - len(after)
        keys = [*before.split(".")[:-1], named.name[len(before) : end], *after.split(".")[1:]]
    table = summary
    for key in keys[:-1]:
        table = table.setdefault(key, {})
    table[keys[-1]] = value


def _put_named(summary: dict[str, Any], scene: Scene, name: str, value: object) -> None:
    """Put a quantity that was named; of the first body where it says none, as others do."""
    if name.startswith(FREE):
        summary = summary.setdefault(FREE.removesuffix("."), {})
        name = name.removeprefix(FREE)
    if find(scene, f"{name}.{scene.bodies[0].name}"):
        name = f"{name}.{scene.bodies[0].name}"
    named = find(scene, name)
    assert named is not None
    _put(summary, named, value)


def _pi(scene: Scene, runs: BatchResponse) -> dict[str, float]:
    """Π-terms seen from the first body, and Π_um of every body."""
    terms = pi_terms(scene)
    for i, body in enumerate(scene.bodies if runs.scales else ()):
        if (named := find(scene, f"pi_um.{body.name}")) is not None:
            terms["um" if i == 0 else f"um.{body.name}"] = float(named.of(runs)[0])
    return terms


@checked
def write(
    response: Response,
    directory: str | os.PathLike[str],
    case: Case | None = None,
    *,
    error_estimate: Mapping[str, object] | None = None,
    started: datetime | None = None,
) -> None:
    """Write history.csv, events.csv, summary.json and manifest.json, all or none.

    For a sequence of records shocks.csv, too, and spring_events.csv where `events` asks for it.
    Those of an earlier run are removed.

    A run that ended before its time is written too: ``success`` of the summary
    and ``complete`` of the manifest are then false.

    Parameters
    ----------
    response : Response
        What the run returned.
    directory : path
        Where the files go; made where it is missing.
    case : Case, optional
        The case the run came from, for the manifest.
    error_estimate : mapping, optional
        Errors of peaks and final values, as `eventpound.accuracy.estimate` finds them, in
        place of those of the response.
    started : datetime, optional
        When the run began, for the manifest.

    Raises
    ------
    InputError
        Where the directory cannot be written to.
    """
    history = history_columns(response.scene, response.recording)
    rows = zip(*(column.tolist() for column in history.values()), strict=True)
    contents = {
        HISTORY: rows_csv([history, *rows]),
        EVENTS: rows_csv([EVENT_COLUMNS, *event_rows(response.scene, response.recording)]),
        SUMMARY: to_json(summarise(response, error_estimate)),
    }
    if response.success and response.shock_rows:
        contents[SHOCKS] = table_csv(response.shocks)
    if words := response.stated.events:
        listed = spring_events(response.scene, response.recording, words)
        contents[SPRING_EVENTS] = rows_csv([SpringEvent._fields, *listed])
    hashes = {name: sha256(content) for name, content in contents.items()}
    contents[MANIFEST] = to_json(describe_run(response, case, started) | {"files": hashes})
    write_together(directory, contents, {SHOCKS, SPRING_EVENTS} - contents.keys())


HISTORY, EVENTS, SHOCKS = "history.csv", "events.csv", "shocks.csv"
SPRING_EVENTS = "spring_events.csv"
MANIFEST = "manifest.json"
_WORDS, _COUNTS = ("kind", "contact"), ("group", "count")


@dataclass(frozen=True)
class StoredResults:
    """What the four files of a run hold.

    Parameters
    ----------
    summary, manifest : dict
        Content of ``summary.json`` and ``manifest.json``.
    history_columns : mapping of str to ndarray, shape (n,)
        Columns of ``history.csv``.
    event_columns : mapping of str to list of str or ndarray, shape (E,)
        Columns of ``events.csv``.
    """

    summary: dict[str, Any]
    history_columns: Mapping[str, Floats]
    event_columns: Mapping[str, Any]
    manifest: dict[str, Any]

    # As tables only where they are asked for: figures do without what makes them.
    @property
    def history(self) -> pd.DataFrame:
        """Content of ``history.csv``."""
        import pandas as pd

        return pd.DataFrame(self.history_columns)

    @property
    def events(self) -> pd.DataFrame:
        """Content of ``events.csv``."""
        import pandas as pd

        return pd.DataFrame(self.event_columns)


def gather(response: Response, case: Case | None = None) -> StoredResults:
    """Results of a response as they would be stored, without a file."""
    rows = event_rows(response.scene, response.recording)
    columns = {name: [row[i] for row in rows] for i, name in enumerate(EVENT_COLUMNS)}
    return StoredResults(
        summary=summarise(response),
        history_columns=history_columns(response.scene, response.recording),
        event_columns={name: _typed(name, cells) for name, cells in columns.items()},
        manifest=describe_run(response, case),
    )


def read(directory: str | os.PathLike[str]) -> StoredResults:
    """Results of a run from its directory.

    Parameters
    ----------
    directory : path
        Where `eventpound.results.write` wrote them.

    Raises
    ------
    InputError
        Where a file is missing, unreadable, of another form, or not of the
        same run as the manifest.
    """
    folder = Path(directory)
    if not folder.is_dir():
        raise InputError(f"{folder}: no such directory; run the case first")
    missing = [n for n in (SUMMARY, HISTORY, EVENTS, MANIFEST) if not (folder / n).is_file()]
    if missing:
        raise InputError(
            f"{folder}: holds no complete results: {', '.join(missing)} missing; run the case first"
        )
    manifest = read_manifest(folder / MANIFEST, FORMAT, (SUMMARY, HISTORY, EVENTS))
    return StoredResults(
        summary=read_json(folder / SUMMARY),
        history_columns=read_history(folder / HISTORY),
        event_columns=read_events(folder / EVENTS),
        manifest=manifest,
    )


def _typed(name: str, cells: Any) -> Any:
    """A column of events as it is kept."""
    return cells if name in _WORDS else np.array(cells, int if name in _COUNTS else float)


def read_history(path: Path) -> dict[str, Floats]:
    """Columns of a motion from a CSV file, ours or another program's of the same form.

    Parameters
    ----------
    path : Path
        The file; it needs a column ``t`` and numbers in every cell.

    Raises
    ------
    InputError
        Where the file is missing or not of this form.
    """
    columns = read_columns(path)
    if "t" not in columns:
        raise InputError(f"{path}: has no column 't'; its columns begin with {list(columns)[:6]}")
    return {name: to_numbers(path, name, cells) for name, cells in columns.items()}


def read_events(path: Path) -> dict[str, Any]:
    """Columns of events from a CSV file.

    Parameters
    ----------
    path : Path
        The file.

    Raises
    ------
    InputError
        Where the file is missing or not of this form.
    """
    columns = read_columns(path)
    if missing := [name for name in EVENT_COLUMNS if name not in columns]:
        raise InputError(f"{path}: has no column {', '.join(missing)}")
    return {
        name: _typed(
            name, columns[name] if name in _WORDS else to_numbers(path, name, columns[name])
        )
        for name in EVENT_COLUMNS
    }


def read_manifest(path: Path, form: str, files: Sequence[str]) -> dict[str, Any]:
    """The manifest of files beside it, which are those that it tells of.

    Parameters
    ----------
    path : Path
        The manifest.
    form : str
        Name and number of the form that it has to have.
    files : sequence of str
        What has to lie beside it.

    Raises
    ------
    InputError
        Where it cannot be read, is of another form, or files are not of its run, as an
        interruption or an edit leaves them.
    """
    manifest = read_json(path)
    if (found := manifest.get("format")) != form:
        raise InputError(f"{path}: format is {found!r}, this reads {form!r}")
    hashes = manifest.get("files")
    known = hashes if isinstance(hashes, Mapping) else {}
    changed = [n for n in files if known.get(n) != sha256(_read_bytes(path.parent / n))]
    if changed:
        raise InputError(
            f"{path.parent}: {', '.join(changed)} not as the run of {path.name} wrote it "
            "(interrupted or edited since); run the case again"
        )
    return manifest


def _read_bytes(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror or error}") from error
