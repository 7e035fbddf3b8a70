"""The appendix of a run: the scene, inputs, motion, response, accuracy, origin."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from eventpound.accuracy.certificate import JSON, digits_words
from eventpound.accuracy.judge import error_words
from eventpound.case.case import Case
from eventpound.errors import InputError
from eventpound.motion.base import moves
from eventpound.motion.scaling import DAMPING
from eventpound.quantities.listed import LISTED
from eventpound.report import html
from eventpound.report.record_figure import spectrum_figure
from eventpound.report.run_figures import figures
from eventpound.results import StoredResults
from eventpound.results.jsontext import read_json
from eventpound.results.tables import Cells, cell_text, headed
from eventpound.scene.plan_point import TURN
from eventpound.scene.scene import Scene
from eventpound.study.response_spectrum import response_spectrum

_SAME = 1e-2
"""Part of its scale by which a peak of a run may differ from that of its certificate."""
_CAPTIONS = {
    "displacements.png": "Ground acceleration, displacements and gaps. Open circles are impacts, "
    "filled ones detachments, dashed lines barriers.",
    "loops.png": "Force against elongation of every nonlinear spring.",
    "plan.png": "The bridge from above when a joint is open the most.",
    "profiles.png": "Extremes of displacements and storey drifts over the height.",
}
_MOST_EVENTS = 200
_KINDS = (
    "peaks", "velocity", "acceleration", "decks", "corners", "springs", "contacts", "structures",
    "supports",
)  # fmt: skip
"""Tables of the summary that have a row a part of the scene."""
_MOST_OWNERS = 8
"""Bodies, springs or contacts beside one another in a table."""


def run_sections(
    case: Case, results: StoredResults, directory: Path, comparison: Path
) -> list[html.Section]:
    """What stands behind the report of a run.

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
    list of Section
        Empty ones have nothing to say.
    """
    drawn = figures(results, pi=case.pi is not None)
    certificate = _certificate(directory, results)
    return [
        ("Summary", [_summary(case.scene, results, certificate)]),
        ("Model", html.model_of(case)),
        ("Ground motion", _motion(case)),
        ("Response", [html.figure_of(figure, _CAPTIONS[name]) for name, figure in drawn.items()]),
        ("Contacts and events", _events(results)),
        ("Quantities", _quantities(case.scene, results.summary)),
        ("Accuracy", _accuracy(results, certificate, comparison / "work-precision.png")),
        ("Origin", [html.origin_of(results.manifest)]),
    ]


def _summary(scene: Scene, results: StoredResults, certificate: str) -> html.Part:
    """What an engineer wants first: how it ended, the largest numbers, how sure they are."""
    summary = results.summary
    moved = _moved(scene, summary["peaks"])
    body, peak = max(moved.items(), key=lambda item: item[1]["abs_max"])
    turns = summary.get("decks", {}).items()
    rotations = (f"{deck['abs_max_rotation']:.4g} rad of {name}" for name, deck in turns)
    estimate = summary["error_estimate"]
    drift = "{max_drift:.6g} m, {max_drift_ratio:.4g} of the height of a storey"
    lines = {
        "run": f"{summary['solver']}: {summary['message']}, t = {summary['t_final']:.6g} s",
        "largest": f"|u| = {peak['abs_max']:.6g} m of {body} at {peak['t_abs_max']:.5g} s",
        "rotation": ", ".join(rotations),
        "drift": drift.format_map(summary) if "max_drift" in summary else "",
        "impacts": str(summary["impacts"]) if summary["contacts"] else "",
        "certificate": certificate,
        "error": error_words(estimate) if estimate else "",
    }
    return html.list_of({word: text for word, text in lines.items() if text})


def _moved(scene: Scene, peaks: Mapping[str, Any]) -> dict[str, Any]:
    """Peaks of what moves along a line; the table of decks tells how far they turn."""
    turning = {body.name for body in scene.bodies if body.direction == TURN}
    return {name: peak for name, peak in peaks.items() if name not in turning}


def _motion(case: Case) -> Iterator[html.Part]:
    components = (case.scene.motion, ""), (case.scene.across, ", of the second component")
    for motion, which in components:
        if not moves(motion):
            continue
        try:
            spectrum = response_spectrum(motion, DAMPING)
        except InputError:
            # A motion without end has none.
            continue
        caption = f"Response spectrum of the ground motion{which}."
        yield html.figure_of(spectrum_figure(spectrum, DAMPING), caption)


def _events(results: StoredResults) -> Iterator[html.Part]:
    events = results.event_columns
    if not results.summary["contacts"]:
        return
    names, listed = tuple(events), len(events["t"])
    shown = zip(*(cells[:_MOST_EVENTS] for cells in events.values()), strict=True)
    rows = tuple(tuple(map(cell_text, row)) for row in shown)
    words = tuple(name in ("kind", "contact") for name in names)
    table = Cells(names, rows, words, max(0, listed - _MOST_EVENTS))
    yield html.folded(f"{listed} events", html.table_of(table))


def _quantities(scene: Scene, summary: Mapping[str, Any]) -> Iterator[html.Part]:
    """Every table of the summary that has a row a body, spring or contact, and single numbers."""
    for kind in _KINDS:
        if rows := summary.get(kind):
            rows = _moved(scene, rows) if kind == "peaks" else rows
            yield html.table_of(_by_owner(kind, rows))
    single = {"residual": summary["residual"], "base shear": summary.get("base_shear", {})}
    single["base shear across"] = summary.get("base_shear_across", {})
    single |= {key: summary[key] for key in ("amplification", "pi") if key in summary}
    if energy := dict(summary.get("energy") or {}):
        works = energy.pop("supports", {})
        single["energy"] = energy | {f"supports.{name}": work for name, work in works.items()}
    for kind, values in single.items():
        if values:
            lines = tuple((name, cell_text(value)) for name, value in values.items())
            yield html.table_of(Cells((kind, "value"), lines, (True, False)))
    yield html.text_part("SI units. `eventpound check --quantities` says what each is.")


def _by_owner(kind: str, rows: Mapping[str, Mapping[str, Any]]) -> Cells:
    """Quantities of one kind of parts: a line a quantity where there are few parts, else a part."""
    keys = list(dict.fromkeys(key for row in rows.values() for key in row))
    units = {
        q.path.rpartition(">.")[2]: q.dimension.unit
        for q in LISTED
        if q.path.startswith(f"{kind}.<")
    }
    names = [headed(key, units.get(key, "")) for key in keys]
    values = [[cell_text(row.get(key)) for key in keys] for row in rows.values()]
    heads, firsts = names, list(rows)
    if len(rows) <= _MOST_OWNERS:
        heads, firsts = firsts, heads
        values = [list(column) for column in zip(*values, strict=True)]
    lines = tuple((first, *line) for first, line in zip(firsts, values, strict=True))
    return Cells((kind, *heads), lines, (True, *(False for _ in heads)))


def _certificate(directory: Path, results: StoredResults) -> str:
    """One sentence on the certificate beside the results; empty without one of this run."""
    path = directory / JSON
    if not path.is_file():
        return ""
    quantities = read_json(path).get("quantities") or []
    if not all(_is_of(quantity, results.summary["peaks"]) for quantity in quantities):
        return "the certificate beside these results is of another case"
    return digits_words([q["digits"] for q in quantities if q["certified"]], len(quantities))


def _is_of(quantity: Mapping[str, Any], peaks: Mapping[str, Mapping[str, float]]) -> bool:
    """Whether a certified number may be one of a run, as far as that has it."""
    kind, _, rest = quantity["quantity"].partition(".")
    body, _, key = rest.rpartition(".")
    if kind != "peaks" or key not in ("max", "min"):
        return True
    found = peaks.get(body, {}).get(key)
    return found is not None and abs(found - quantity["value"]) <= _SAME * quantity["scale"]


def _accuracy(results: StoredResults, certificate: str, diagram: Path) -> Iterator[html.Part]:
    for warning in (results.summary["error_estimate"] or {}).get("warnings", ()):
        yield html.text_part(f"Warning: {warning}.")
    if certificate:
        yield html.text_part(f"{certificate} (certificate.txt).")
    if drift := results.summary["constraint_drift"]:
        yield html.text_part(f"Resting contacts left their constraints by {drift['gap']:.1e} of L.")
    if diagram.is_file():
        yield html.picture_of(diagram, "Speed against error of the solvers compared.")
