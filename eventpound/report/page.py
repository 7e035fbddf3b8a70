"""One self-contained HTML page of a run: the scene, inputs, motion, response, accuracy, origin.

Pictures are SVG within the page (a click makes one larger), nothing is loaded from elsewhere and
no script runs, so that the page can be kept and sent as it is.
"""

from __future__ import annotations

import base64
from collections.abc import Iterator, Mapping
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

from eventpound.case.case import Case
from eventpound.errors import InputError
from eventpound.quantities import LISTED
from eventpound.report.displacements import displacement_figure
from eventpound.report.loops import loop_figure, nonlinear_springs
from eventpound.report.model_figure import model_figure
from eventpound.report.spectrum_figure import spectrum_figure
from eventpound.report.style import svg
from eventpound.results import StoredResults
from eventpound.results.input_tables import Cells, input_lines, input_tables
from eventpound.results.inputs import inputs_of
from eventpound.results.jsontext import read_json
from eventpound.study.response_spectrum import response_spectrum

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PAGE = "report.html"
"""Name of the file."""
_DAMPING = 0.05
_SAME = 1e-2
"""Part of its scale by which a peak of a run may differ from that of its certificate."""
_MOST_EVENTS = 200
_MOST_OWNERS = 8
"""Bodies, springs or contacts beside one another in a table."""
_HEAD = """\
<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<title>{title}</title>
<style>
body {{ font: 15px/1.5 sans-serif; max-width: 62em; margin: 2em auto; padding: 0 1em; }}
h1 {{ font-size: 1.5em; }}
h2 {{ font-size: 1.2em; border-bottom: 1px solid #ccc; margin-top: 2em; }}
table {{ border-collapse: collapse; margin: 0.8em 0; font-size: 0.85em; }}
th, td {{ padding: 0.15em 0.6em; text-align: right; border-bottom: 1px solid #eee; }}
td {{ white-space: nowrap; }}
th {{ border-bottom: 1px solid #888; }}
.word {{ text-align: left; }}
.wide {{ overflow-x: auto; }}
nav a {{ margin-right: 1em; }}
dt {{ font-weight: bold; float: left; clear: left; width: 7em; }}
dd {{ margin-left: 7.5em; overflow-wrap: anywhere; }}
figure {{ margin: 1em 0; overflow: auto; }}
figure input {{ display: none; }}
figure svg {{ width: 100%; height: auto; cursor: zoom-in; }}
figure input:checked + svg {{ width: 250%; cursor: zoom-out; }}
figcaption {{ font-size: 0.85em; color: #555; }}
</style>
</head>
<body>
"""


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
        ("Model", _model(case)),
        ("Ground motion", _motion(case)),
        ("Response", _response(results)),
        ("Contacts and events", _events(results)),
        ("Quantities", _quantities(results)),
        ("Accuracy", _accuracy(results, directory, comparison)),
        ("Origin", _origin(results)),
    ]
    title = escape(case.title)
    parts = [_HEAD.format(title=title), f"<h1>{title}</h1>\n<nav>"]
    there = [(name, "".join(content)) for name, content in sections]
    there = [(name, content) for name, content in there if content]
    parts += [f'<a href="#{_anchor(name)}">{name}</a>' for name, _ in there]
    parts.append("</nav>\n")
    parts += [f'<h2 id="{_anchor(name)}">{name}</h2>\n{content}' for name, content in there]
    return ("".join(parts) + "</body>\n</html>\n").encode()


def _anchor(name: str) -> str:
    return name.lower().replace(" ", "-")


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
    estimate = summary["error_estimate"] or {}
    if "largest" in estimate:
        worst = estimate["largest"]
        lines["error"] = f"estimated {worst['part']:.1e} of its scale at most ({worst['quantity']})"
    yield _list(lines)


def _model(case: Case) -> Iterator[str]:
    yield _figure(model_figure(case.scene), "The scene; nothing is to scale.")
    inputs = inputs_of(case)
    for table in input_tables(inputs):
        yield _table(table)
    yield _list(dict(input_lines(inputs)))


def _motion(case: Case) -> Iterator[str]:
    motion = case.scene.motion
    if motion.scales() is None:
        return
    try:
        spectrum = response_spectrum(motion, _DAMPING)
    except InputError:
        # A motion without end has none.
        return
    caption = "Response spectrum of the ground motion."
    yield _figure(spectrum_figure(spectrum, _DAMPING), caption)


def _response(results: StoredResults) -> Iterator[str]:
    yield _figure(
        displacement_figure(results),
        "Ground acceleration, displacements and gaps. Open circles are impacts, filled ones "
        "detachments, dashed lines barriers.",
    )
    if nonlinear_springs(results):
        yield _figure(loop_figure(results), "Force against elongation of every nonlinear spring.")


def _events(results: StoredResults) -> Iterator[str]:
    events = results.events
    if not results.summary["contacts"]:
        return
    names = tuple(str(name) for name in events.columns)
    shown = events.head(_MOST_EVENTS).itertuples(index=False)
    rows = tuple(tuple(_text(value) for value in row) for row in shown)
    words = tuple(name in ("kind", "contact") for name in names)
    table = _table(Cells(names, rows, words, max(0, len(events) - _MOST_EVENTS)))
    yield f"<details><summary>{len(events)} events</summary>\n{table}</details>\n"


def _quantities(results: StoredResults) -> Iterator[str]:
    """Every table of the summary that has a row a body, spring or contact, and single numbers."""
    summary = results.summary
    for kind in ("peaks", "velocity", "acceleration", "springs", "contacts", "structures"):
        rows: Mapping[str, Any] = summary.get(kind) or {}
        if rows:
            yield _table(_by_owner(kind, rows))
    single = {"residual": summary["residual"], "base shear": summary["base_shear"]}
    single |= {key: summary[key] for key in ("amplification", "energy", "pi") if key in summary}
    for kind, values in single.items():
        rows_of = tuple((name, _text(value)) for name, value in values.items())
        if rows_of:
            yield _table(Cells((kind, "value"), rows_of, (True, False)))
    yield "<p>SI units. docs/quantities.md says what each is.</p>\n"


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
        lines = tuple((n, *(_text(row.get(key)) for key in keys)) for n, row in rows.items())
        return Cells((kind, *names), lines, (True, *(False for _ in keys)))
    lines = tuple(
        (name, *(_text(row.get(key)) for row in rows.values()))
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


def _origin(results: StoredResults) -> Iterator[str]:
    """What was run, by what, and the hashes that say so."""
    manifest = results.manifest
    lines = {"started": manifest["started"], "case": manifest["case_sha256"]}
    lines |= {name: version for name, version in manifest["versions"].items() if version}
    lines |= manifest["files"]
    record = manifest["record"]
    lines |= {key: record[key] for key in ("file", "file_sha256") if key in record}
    lines["machine"] = ", ".join(map(str, manifest["machine"].values()))
    yield _list({key: str(value) for key, value in lines.items() if value})


def _figure(figure: Figure, caption: str) -> str:
    """A picture that a click makes larger."""
    return (
        f'<figure><label><input type="checkbox">{svg(figure)}</label>'
        f"<figcaption>{escape(caption)}</figcaption></figure>\n"
    )


def _table(table: Cells) -> str:
    kinds = [' class="word"' if word else "" for word in table.words]

    def line(tag: str, cells: tuple[str, ...]) -> str:
        inner = "".join(
            f"<{tag}{kind}>{escape(text)}</{tag}>" for text, kind in zip(cells, kinds, strict=True)
        )
        return f"<tr>{inner}</tr>"

    rows = "\n".join([line("th", table.headings), *(line("td", row) for row in table.rows)])
    more = f"<p>and {table.more} more</p>\n" if table.more else ""
    return f'<div class="wide"><table>\n{rows}\n</table></div>\n{more}'


def _list(lines: Mapping[str, str]) -> str:
    inner = "".join(
        f"<dt>{escape(word)}</dt><dd>{escape(text)}</dd>\n" for word, text in lines.items()
    )
    return f"<dl>\n{inner}</dl>\n"


def _text(value: object) -> str:
    if value is None:
        return ""
    return f"{value:.6g}" if isinstance(value, float) else str(value)
