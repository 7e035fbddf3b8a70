"""The one file that judges answers where there is no eventpound: modules behind each other."""

from __future__ import annotations

import ast
from collections import defaultdict
from importlib.resources import files

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
