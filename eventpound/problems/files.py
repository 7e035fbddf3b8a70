"""The files of a problem that need no eventpound, and the archive of a set.

``problem.md`` (the equations with all numbers), ``problem.json`` (the same for programs),
``problem.txt`` (the same as bare numbers, for programs that read no JSON),
``motion.csv`` (the ground acceleration in samples), ``answer.json``; beside them the case as
eventpound takes it. Problems in plan have more in each (`eventpound.problems.plan`). The archive
holds them for every problem, with ``score.py`` and the index, in one order, with one date,
uncompressed: the same bytes each time.
"""

from __future__ import annotations

import ast
import io
import zipfile
from collections import defaultdict
from collections.abc import Mapping
from importlib.resources import files
from typing import Any

import numpy as np

from eventpound.errors import InputError
from eventpound.motion.base import Family, GroundMotion, Piece
from eventpound.numerics.arrays import Floats
from eventpound.problems.collection import (
    ANSWER,
    EARLIER,
    FROZEN,
    INDEX,
    Collection,
    ProblemFolder,
    moments_of,
)
from eventpound.problems.page import problem_page, set_page
from eventpound.problems.plan import plan_conventions, plan_numbers, plan_rows
from eventpound.results.export import arrays_of, refuse_other_laws, sampled_signals
from eventpound.results.jsontext import canonical
from eventpound.scene.elastic_laws import reduced
from eventpound.scene.scene import Scene
from eventpound.scene.spring import BoucWen, Hysteretic, Spring

MODULES = (
    *("levels", "pairing", "difference", "problem", "answer", "found", "card", "drawing", "page"),
    "__main__",
)
"""Of `eventpound.score`, each behind those that it stands on."""


def score_file() -> str:
    """The text of ``score.py``: Python and NumPy are all that it needs."""
    plain: set[str] = set()
    named: defaultdict[str, set[str]] = defaultdict(set)
    bodies, usage = [], ""
    for name in MODULES:
        text = (files("eventpound.score") / f"{name}.py").read_text(encoding="utf-8")
        tree = ast.parse(text)
        usage = ast.get_docstring(tree, clean=False) or ""
        imports = [node for node in tree.body if isinstance(node, ast.Import | ast.ImportFrom)]
        for node in imports:
            if isinstance(node, ast.Import):
                plain.add(ast.unparse(node))
            elif node.module and node.module.partition(".")[0] not in ("eventpound", "__future__"):
                named[node.module].update(alias.name for alias in node.names)
        body = "".join(text.splitlines(keepends=True)[imports[-1].end_lineno :]).strip("\n")
        bodies.append(f"# {'-' * 60} {name.strip('_')}\n\n\n{body}\n")
    lines = [f"from {module} import {', '.join(sorted(named[module]))}" for module in sorted(named)]
    imported = "\n".join((*sorted(plain), *lines))
    head = f'"""{usage}"""\n\nfrom __future__ import annotations\n\n{imported}\n'
    return "\n\n".join((head, *bodies))


DATE = (1980, 1, 1, 0, 0, 0)
"""Of every file in the archive: the first that the format knows."""
_RIGID = 1e-12
"""Part of the largest squared frequency below which a motion is rigid."""
LAW = (
    "compression", "extension", "offset", "strength", "yield_displacement", "n", "beta", "gamma",
    "z0",
)  # fmt: skip
"""Numbers of a spring, a kinked line and a hysteretic part."""
CONVENTIONS = {
    "units": "SI: m, kg, s, N",
    "coordinates": "u is relative to the ground, positive to the right; a_g likewise",
    "equation": "M u'' + C u' + sum_s B[:,s] F_s - W lambda = -M 1 a_g(t); M: a vector of masses",
    "matrices": "lists of rows; a row a body, a column a spring (B) or a contact (W)",
    "spring": (
        "x = B^T u, F = k (x - offset) + strength z, k = compression for x < offset, else extension"
    ),
    "z": (
        "z' = (x' - gamma |x'| z |z|^(n-1) - beta x' |z|^n) / yield_displacement;"
        " no z where strength = 0"
    ),
    "contact": "gap g = gaps + W^T u >= 0, complementary to its force lambda >= 0",
    "impact": (
        "M (v+ - v-) = W L, 0 <= W^T v+ + restitution W^T v- complementary to L >= 0, over all"
        " closed contacts that do not separate; again in the same instant while one approaches"
    ),
    "frequencies": (
        "lowest and highest (rad/s) without damping and contacts, springs at initial stiffness"
    ),
    "motion": (
        "pieces in time; sinusoids: a_g = sum A cos(w (t - origin) + p) over rows (A, w, p);"
        " gaussian: numbers q, c0, c1, c2, c3: a_g = (c0 + c1 s + c2 s^2 + c3 s^3) exp(-q s^2),"
        " s = t - origin; samples: a_g linear between samples, dt apart from origin on;"
        " zero where there is no piece"
    ),
    "answer": (
        "CSV, first line '# problem NAME', then names t, u.<body>, v.<body>, z.<spring>, then rows"
    ),
}


def problem_files(collection: Collection, problem: ProblemFolder) -> dict[str, bytes]:
    """Every file of a problem by its name.

    Parameters
    ----------
    collection : Collection
        The set.
    problem : ProblemFolder
        One of it, with its answer.

    Raises
    ------
    InputError
        Where it has no answer, or a scene that the files cannot hold.
    """
    content = problem_json(collection, problem)
    own = {path.name: path.read_bytes() for path in problem.folder.iterdir() if path.is_file()}
    if ANSWER not in own:
        raise InputError(f"{problem.folder}: has no {ANSWER}; --certify makes it")
    made = {
        "problem.md": problem_page(problem, content, problem.answer()).encode(),
        "problem.json": to_json_lines(content),
        "problem.txt": bare_numbers(content),
        "motion.csv": _motion_csv(problem),
    }
    return made | own


def to_json_lines(content: dict[str, object]) -> bytes:
    """JSON with a line for each key: short, and readable side by side."""
    lines = ",\n".join(f'"{key}": {canonical(value).decode()}' for key, value in content.items())
    return f"{{\n{lines}\n}}\n".encode()


def problem_json(collection: Collection, problem: ProblemFolder) -> dict[str, object]:
    """A problem in numbers, its springs of one law."""
    case = problem.case()
    scene, run = case.scene, case.run
    if scene.supports or scene.forces or any(contact.law for contact in scene.contacts):
        raise InputError(
            f"{problem.folder}: has supports, forces or contacts with a law, for which the files "
            "of a problem have no place; `eventpound run CASE --export DIR` writes such a case"
        )
    refuse_other_laws(scene, str(problem.folder))
    start, end = run.start_time, run.start_time + run.duration
    return {
        "set": f"{collection.name} {collection.version}",
        "problem": problem.name,
        "title": case.title,
        "tests": problem.tests,
        "tags": problem.tags,
        "conventions": CONVENTIONS | plan_conventions(scene),
        "start": start,
        "end": end,
        "moments": moments_of(run),
        "bodies": [body.name for body in scene.bodies],
        "contacts": [contact.name for contact in scene.contacts],
        **arrays_of(scene),
        "springs": {
            "names": [spring.name for spring in scene.springs],
            **{key: [_law(spring)[key] for spring in scene.springs] for key in LAW},
        },
        "frequencies": _frequencies(scene),
        **plan_numbers(scene),
        "motion": _pieces(scene.motion, start, end),
        **({"motion_across": _pieces(scene.across, start, end)} if scene.in_plan else {}),
    }


def bare_numbers(content: Mapping[str, Any]) -> bytes:
    """A problem as the two first lines of its answer, and then its numbers in this order.

    Bodies, springs, contacts, start, end; a line a body (M, u, v, its row of C), a spring (its
    law, its column of B) and a contact (gap, restitution, its column of W). In plan `plan_rows`
    follow.
    """
    springs, initial = content["springs"], content["initial"]
    names, law = springs["names"], [springs[key] for key in LAW]
    bodies = content["bodies"]
    columns = ["t", *(f"u.{body}" for body in bodies), *(f"v.{body}" for body in bodies)]
    columns += [f"z.{n}" for n, q in zip(names, springs["strength"], strict=True) if q != 0.0]
    b, w = (np.asarray(content[key]).reshape(len(bodies), -1).T for key in ("B", "W"))
    run = [len(bodies), len(names), len(content["contacts"]), content["start"], content["end"]]
    body_rows = zip(content["M"], initial["u"], initial["v"], content["C"], strict=True)
    rows = [run, *([m, u, v, *c] for m, u, v, c in body_rows)]
    rows += [[*numbers, *column] for *numbers, column in zip(*law, b, strict=True)]
    contacts = zip(content["gaps"], content["restitutions"], w, strict=True)
    rows += [[gap, restitution, *column] for gap, restitution, column in contacts]
    lines = [f"# problem {content['problem']}", ",".join(columns)]
    for row in (*rows, *plan_rows(content)):
        lines.append(row if isinstance(row, str) else " ".join(f"{x:.17g}" for x in row))
    return ("\n".join(lines) + "\n").encode()


def _frequencies(scene: Scene) -> list[float]:
    """Lowest and highest frequency (rad/s), rigid motions left out, to four digits.

    Without damping and contacts, every spring at its larger initial stiffness; none where there
    is no spring.
    """
    arrays = arrays_of(scene)
    mass, directions = np.asarray(arrays["M"]), np.asarray(arrays["B"])
    laws = [_law(spring) for spring in scene.springs]
    stiffness = [
        max(law["compression"], law["extension"]) + law["strength"] / law["yield_displacement"]
        for law in laws
    ]
    scaled = directions / np.sqrt(mass)[:, None]
    squares = np.linalg.eigvalsh((scaled * stiffness) @ scaled.T)
    moving = squares[squares > _RIGID * np.max(squares, initial=0.0)]
    return [float(f"{np.sqrt(x):.4g}") for x in (moving.min(), moving.max())] if moving.size else []


def _law(spring: Spring) -> dict[str, float]:
    """A spring as a kinked line and a hysteretic part."""
    law = spring.acting
    if isinstance(law, Hysteretic) and law.beyond_bouc_wen:
        raise InputError(f"spring {spring.name}: its law is {law.word.value}; accepted: any other")
    if isinstance(law, BoucWen):
        memory = law.strength, law.yield_displacement, law.exponent, law.beta, law.gamma
        numbers = law.stiffness, law.stiffness, 0.0, *memory, law.initial_z
    else:
        curve = reduced(law)
        numbers = curve.compression, curve.extension, curve.offset, 0.0, 1.0, 1.0, 0.5, 0.5, 0.0
    return dict(zip(LAW, numbers, strict=True))


def _pieces(motion: GroundMotion, start: float, end: float) -> list[dict[str, object]]:
    """The smooth pieces of a motion that a run meets, those without motion left out."""
    return [
        {"start": max(piece.start, start), "end": min(piece.end, end), **_formula(piece)}
        for piece in motion.pieces()
        if piece.family is not Family.ZERO and piece.start < end and piece.end > start
    ]


def _formula(piece: Piece) -> dict[str, object]:
    numbers = piece.coefficients
    match piece.family:
        case Family.SINUSOIDS:
            return {"origin": numbers[0], "sinusoids": numbers[1:].reshape(-1, 3)}
        case Family.GAUSSIAN:
            return {"origin": numbers[0], "gaussian": numbers[1:]}
        case _:
            return {"origin": numbers[0], "dt": numbers[1], "samples": piece.samples}


def _motion_csv(problem: ProblemFolder) -> bytes:
    """Samples of the motion, those of a formula to nine digits.

    They are within 5e-6 of the amplitude of a formula anyway (a thousand a period), and the
    last digits of a sine are not the same on every processor.
    """
    case = problem.case()
    scene, start = case.scene, case.run.start_time
    motions = [scene.motion, scene.across] if scene.in_plan else [scene.motion]
    t, values = sampled_signals(motions, start, start + case.run.duration)
    sampled = any(p.family is Family.SAMPLES for motion in motions for p in motion.pieces())
    digits = (repr, repr) if sampled else ("{:.15g}".format, "{:.9g}".format)
    columns = [map(digits[0], t.tolist()), *(map(digits[1], _whole(a).tolist()) for a in values)]
    rows = map(",".join, zip(*columns, strict=True))
    return "\n".join(["t,a_g,a_across" if scene.in_plan else "t,a_g", *rows, ""]).encode()


def _whole(a_g: Floats) -> Floats:
    """Zeros in the place of what is the rounding of a sine at a multiple of pi."""
    return np.where(np.abs(a_g) < 1e-12 * np.max(np.abs(a_g), initial=0.0), 0.0, a_g)


def archive(collection: Collection) -> bytes:
    """The set as a zip file, byte for byte the same each time."""
    head = f"{collection.name} {collection.version}".replace(" ", "-")
    contents = {
        "README.md": set_page(collection).encode(),
        "score.py": score_file().encode(),
        **{name: (collection.folder / name).read_bytes() for name in (INDEX, FROZEN)},
    }
    for path in sorted(collection.folder.glob(EARLIER.format("*"))):
        contents[path.name] = path.read_bytes()
    for path in sorted((collection.folder / "entrants").glob("*")):
        contents[f"entrants/{path.name}"] = path.read_bytes()
    for problem in collection.problems:
        for name, content in sorted(problem_files(collection, problem).items()):
            contents[f"{problem.name}/{name}"] = content
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_STORED) as whole:
        for name, content in contents.items():
            entry = zipfile.ZipInfo(f"{head}/{name}", DATE)
            entry.create_system, entry.external_attr = 3, 0o644 << 16
            whole.writestr(entry, content)
    return buffer.getvalue()
