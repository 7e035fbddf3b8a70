"""``python -m tests.fuzz.guided cases|records SECONDS``: damage guided by coverage, with atheris.

Atheris is installed beside the project's packages, ``pip install atheris``; see its
pages for which Pythons it has wheels. It stops at the first defect.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import atheris

with atheris.instrument_imports(include=["eventpound.case", "eventpound.motion", "tomllib"]):
    from tests.fuzz.targets import seeds_of_cases, try_case, try_record, written_records


def main(kind: str, seconds: str) -> None:
    """Damage the sound files of the repository for so long."""
    folder = Path(tempfile.mkdtemp(prefix="guided-"))
    corpus = folder / "corpus"
    corpus.mkdir()
    records = written_records()
    if kind == "cases":
        seeds = [text.encode() for text in seeds_of_cases()]
    else:
        seeds = [written.text.encode() for _, written in records]
    for number, seed in enumerate(seeds):
        (corpus / str(number)).write_bytes(seed)

    def attempt(content: bytes) -> None:
        if kind == "cases":
            try_case(content, folder)
        else:
            try_record(content, records[0][1], folder, named=False)

    options = [f"-max_total_time={seconds}", "-max_len=20000", f"-artifact_prefix={folder}/"]
    atheris.Setup([sys.argv[0], *options, str(corpus)], attempt)
    atheris.Fuzz()


if __name__ == "__main__":
    main(*sys.argv[1:])
