"""Pack a set of problems into one archive that programs in any language can use.

For each problem its equations, its numbers, the ground motion, and the certified answer. The
archive is made of what was frozen, and is the same byte for byte each time. How a problem
is added and what a version is: the page "problems" of the documentation.

Examples
--------
  eventpound problems pack cases/problems --out problems.zip
  eventpound problems pack mine --certify
  eventpound problems pack mine --certify 03 07-pair
  eventpound problems pack mine --freeze
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from eventpound.cli.arguments import Commands, Options, add_command, seconds
from eventpound.cli.talk import complain

if TYPE_CHECKING:
    from eventpound.problems.collection import Collection


def add_pack(commands: Commands) -> None:
    """Add the command to the parser."""
    pack = add_command(commands, "problems pack", _pack_or_certify, __doc__)
    pack.add_argument("folder", metavar="SET", type=Path, help="directory with a set.toml")
    pack.option("--out FILE", "the archive (NAME-VERSION.zip, here)", Path)
    certify = "compute answer.json of these problems (of those that have none)"
    pack.option("--certify NAME", certify, nargs="*")
    pack.option("--patience SECONDS", "given to a run of --certify (600)", seconds, default=600.0)
    pack.option("--freeze", "write the hashes of the set as it is: its version")


def _pack_or_certify(options: Options) -> int:
    from eventpound.problems.collection import read_collection

    if options.certify is not None:
        accepted, why = "--certify --patience", "is not for --certify"
    elif options.freeze:
        accepted, why = "--freeze", "is not for --freeze"
    else:
        accepted, why = "--out", "is for --certify"
    options.refuse_others(accepted, why)
    collection = read_collection(options.folder)
    if options.certify is not None:
        return _certify(collection, options.certify, options.patience)
    if options.freeze:
        print(f"frozen    {collection.name} {collection.version}, sha256 {collection.freeze()}")
        return 0
    return _pack(collection, options.out)


def _certify(collection: Collection, names: list[str], patience: float) -> int:
    """Write answers; 1 where a certificate is refused."""
    from eventpound.problems.collection import ANSWER, answer_of
    from eventpound.problems.files import to_json_lines
    from eventpound.results import write_together

    chosen = collection.some(names)
    if not names:
        chosen = tuple(p for p in chosen if not (p.folder / ANSWER).is_file())
    refused = 0
    for problem in chosen:
        answer, certificate = answer_of(collection, problem, patience=patience)
        write_together(problem.folder, {ANSWER: to_json_lines(answer)})
        said = "certified" if certificate.certified else "in part"
        print(f"{problem.name:<28} {said}", flush=True)
        refused += not certificate.certified
    if refused:
        complain(f"{refused} certificates are refused")
    return int(refused > 0)


def _pack(collection: Collection, out: Path | None) -> int:
    from eventpound.problems.files import archive
    from eventpound.results import write_together
    from eventpound.results.manifest import sha256

    collection.check_frozen()
    name = f"{collection.name}-{collection.version}.zip".replace(" ", "-")
    path = out or Path(name)
    content = archive(collection)
    write_together(path.parent, {path.name: content})
    print(
        f"wrote {path}: {len(collection.problems)} problems, {len(content) / 1e6:.1f} MB, "
        f"sha256 {sha256(content)}"
    )
    return 0
