"""One self-contained HTML page of a run: the scene, inputs, motion, response, accuracy, origin.

As `eventpound.report.html` makes all pages.
"""

from __future__ import annotations

import base64
from collections.abc import Iterator, Mapping
from html import escape
from pathlib import Path
from typing import Any

from eventpound.accuracy.judge import error_words
from eventpound.case.case import Case
from eventpound.errors import InputError
from eventpound.motion.base import moves
from eventpound.motion.scaling import DAMPING
from eventpound.quantities import LISTED
from eventpound.report.html import (
    figure_of,
    list_of,
    model_section,
    origin_section,
    page,
    table_of,
    text_of,
)
from eventpound.report.plot import figures
from eventpound.report.spectrum_figure import spectrum_figure
from eventpound.results import StoredResults
from eventpound.results.input_tables import Cells
from eventpound.results.jsontext import read_json
from eventpound.study.response_spectrum import response_spectrum

_SAME = 1e-2
"""Part of its scale by which a peak of a run may differ from that of its certificate."""
_CAPTIONS = {
    "displacements.png": "Ground acceleration, displacements and gaps. Open circles are impacts, "
    "filled ones detachments, dashed lines barriers.",
    "loops.png": "Force against elongation of every nonlinear spring.",
    "profiles.png": "Extremes of displacements and storey drifts over the height.",
}
_MOST_EVENTS = 200
_KINDS = ("peaks", "velocity", "acceleration", "springs", "contacts", "structures", "supports")
"""Tables of the summary that have a row a part of the scene."""
_MOST_OWNERS = 8
"""Bodies, springs or contacts beside one another in a table."""


def report_page(case: Case, results: StoredResults, directory: Path, comparison: Path) -> bytes:
    """The page of a run.

    Parameters
    ----------
    case : Case
        The case as it was run.
    results : StoredResults
        What is stored of the run.
    directory : Path
        Where that is; a certificate of the case is looked for there.
    comparison : Path
        Where a comparison of the case may be.

    Returns
    -------
    bytes
        HTML, UTF-8.
    """
    sections = [
        ("Summary", _summary(results, directory)),
        ("Model", model_section(case)),
        ("Ground motion", _motion(case)),
        ("Response", _response(results, case.pi is not None)),
        ("Contacts and events", _events(results)),
        ("Quantities", _quantities(results)),
        ("Accuracy", _accuracy(results, directory, comparison)),
        ("Origin", origin_section(results.manifest)),
    ]
    return page(case.title, sections)


def _summary(results: StoredResults, directory: Path) -> Iterator[str]:
    """What an engineer wants first: how it ended, the largest numbers, how sure they are."""
    summary = results.summary
    lines = {"run": f"{summary['solver']}: {summary['message']}, t = {summary['t_final']:.6g} s"}
    body, peak = max(summary["peaks"].items(), key=lambda item: item[1]["abs_max"])
    lines["largest"] = f"|u| = {peak['abs_max']:.6g} m of {body} at {peak['t_abs_max']:.5g} s"
    if summary["contacts"]:
        lines["impacts"] = str(summary["impacts"])
    if certificate := _certificate(directory, results):
        lines["certificate"] = certificate
    if estimate := summary["error_estimate"]:
        lines["error"] = error_words(estimate)
    yield list_of(lines)


def _motion(case: Case) -> Iterator[str]:
    motion = case.scene.motion
    if not moves(motion):
        return
    try:
        spectrum = response_spectrum(motion, DAMPING)
    except InputError:
        # A motion without end has none.
        return
    caption = "Response spectrum of the ground motion."
    yield figure_of(spectrum_figure(spectrum, DAMPING), caption)


def _response(results: StoredResults, in_pi: bool) -> Iterator[str]:
    for name, figure in figures(results, pi=in_pi).items():
        yield figure_of(figure, _CAPTIONS[name])


def _events(results: StoredResults) -> Iterator[str]:
    events = results.events
    if not results.summary["contacts"]:
        return
    names = tuple(str(name) for name in events.columns)
    shown = events.head(_MOST_EVENTS).itertuples(index=False)
    rows = tuple(tuple(text_of(value) for value in row) for row in shown)
    words = tuple(name in ("kind", "contact") for name in names)
    table = table_of(Cells(names, rows, words, max(0, len(events) - _MOST_EVENTS)))
    yield f"<details><summary>{len(events)} events</summary>\n{table}</details>\n"


def _quantities(results: StoredResults) -> Iterator[str]:
    """Every table of the summary that has a row a body, spring or contact, and single numbers."""
    summary = results.summary
    for kind in _KINDS:
        rows: Mapping[str, Any] = summary.get(kind) or {}
        if rows:
            yield table_of(_by_owner(kind, rows))
    single = {"residual": summary["residual"], "base shear": summary["base_shear"]}
    single |= {key: summary[key] for key in ("amplification", "pi") if key in summary}
    if energy := dict(summary.get("energy") or {}):
        works = energy.pop("supports", {})
        single["energy"] = energy | {f"supports.{name}": work for name, work in works.items()}
    for kind, values in single.items():
        rows_of = tuple((name, text_of(value)) for name, value in values.items())
        if rows_of:
            yield table_of(Cells((kind, "value"), rows_of, (True, False)))
    yield "<p>SI units. The page “quantities” of the documentation says what each is.</p>\n"


def _by_owner(kind: str, rows: Mapping[str, Mapping[str, Any]]) -> Cells:
    """Quantities of one kind of parts: a line a quantity where there are few parts, else a part."""
    keys = list(dict.fromkeys(key for row in rows.values() for key in row))
    units = {
        q.path.rpartition(">.")[2]: q.dimension.unit
        for q in LISTED
        if q.path.startswith(f"{kind}.<")
    }
    names = [f"{key} ({units[key]})" if units.get(key) else key for key in keys]
    if len(rows) > _MOST_OWNERS:
        lines = tuple((n, *(text_of(row.get(key)) for key in keys)) for n, row in rows.items())
        return Cells((kind, *names), lines, (True, *(False for _ in keys)))
    lines = tuple(
        (name, *(text_of(row.get(key)) for row in rows.values()))
        for name, key in zip(names, keys, strict=True)
    )
    return Cells((kind, *rows), lines, (True, *(False for _ in rows)))


def _certificate(directory: Path, results: StoredResults) -> str:
    """One sentence on the certificate beside the results; empty without one of this run."""
    path = directory / "certificate.json"
    if not path.is_file():
        return ""
    quantities = read_json(path).get("quantities") or []
    if not all(_is_of(quantity, results.summary["peaks"]) for quantity in quantities):
        return "the certificate beside these results is of another case"
    held = [q["digits"] for q in quantities if q["certified"]]
    if not held:
        return "refused"
    return f"{len(held)} of {len(quantities)} numbers hold to {min(held):g} digits or more"


def _is_of(quantity: Mapping[str, Any], peaks: Mapping[str, Mapping[str, float]]) -> bool:
    """Whether a certified number may be one of a run, as far as that has it."""
    kind, _, rest = quantity["quantity"].partition(".")
    body, _, key = rest.rpartition(".")
    if kind != "peaks" or key not in ("max", "min"):
        return True
    found = peaks.get(body, {}).get(key)
    return found is not None and abs(found - quantity["value"]) <= _SAME * quantity["scale"]


def _accuracy(results: StoredResults, directory: Path, comparison: Path) -> Iterator[str]:
    for warning in (results.summary["error_estimate"] or {}).get("warnings", ()):
        yield f"<p>Warning: {escape(warning)}.</p>\n"
    if certificate := _certificate(directory, results):
        yield f"<p>{escape(certificate)} (<code>certificate.txt</code>).</p>\n"
    drift = results.summary["constraint_drift"]
    if drift:
        yield f"<p>Resting contacts left their constraints by {drift['gap']:.1e} of L.</p>\n"
    picture = comparison / "work-precision.png"
    if picture.is_file():
        data = base64.b64encode(picture.read_bytes()).decode()
        yield f'<figure><img style="max-width: 100%" alt="" src="data:image/png;base64,{data}">'
        yield "<figcaption>Speed against error of the solvers compared.</figcaption></figure>\n"
