"""What a file is that holds no text, by the bytes it begins with, and what to do with it."""

from __future__ import annotations

import io
import zipfile
from codecs import BOM_UTF16_BE, BOM_UTF16_LE

_UNPACK = "unpack it and name the file in it"
_EXPORT = "write the accelerations as text, a column or times and accelerations"
_KINDS = (
    (b"\x1f\x8b", f"a gzip archive; {_UNPACK}"),
    (b"BZh", f"a bzip2 archive; {_UNPACK}"),
    (b"\xfd7zXZ", f"an xz archive; {_UNPACK}"),
    (b"7z\xbc\xaf", f"a 7z archive; {_UNPACK}"),
    (b"Rar!", f"a rar archive; {_UNPACK}"),
    (b"%PDF", f"a PDF file; {_EXPORT}"),
    (b"\xd0\xcf\x11\xe0", f"an Office file (such as .xls); {_EXPORT}"),
    (b"\x89HDF", f"an HDF5 file (such as ASDF, or .mat); {_EXPORT}"),
    (b"MATLAB 5.0", f"a MATLAB file; {_EXPORT}"),
    (b"\x93NUMPY", f"a NumPy file; {_EXPORT}"),
)
_TAR_AT, _TAR = 257, b"ustar"
_LOOKED_AT, _NAMED = 1024, 5


def binary_kind(content: bytes, *, may_have_zeros: bool) -> str | None:
    """What a file is and what to do with it; None where it may be text.

    Parameters
    ----------
    content : bytes
        The whole file.
    may_have_zeros : bool
        Whether bytes that are zero make no difference, as in text that tapes filled up.
    """
    if content.startswith(b"PK\x03\x04"):
        return _zip_kind(content)
    if content.startswith(_TAR, _TAR_AT):
        return f"a tar archive; {_UNPACK}"
    if content.startswith((BOM_UTF16_LE, BOM_UTF16_BE)):
        return None
    for begins, kind in _KINDS:
        if content.startswith(begins):
            return kind
    zeros = b"\0" in content[:_LOOKED_AT] and not may_have_zeros
    return f"a binary file; {_EXPORT}" if zeros else None


def _zip_kind(content: bytes) -> str:
    """A zip archive by the names of its files, which may be those of a spreadsheet."""
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            names = [name for name in archive.namelist() if not name.endswith("/")]
    except zipfile.BadZipFile:
        return "a zip archive that is damaged"
    if "[Content_Types].xml" in names:
        return f"an Office file (such as .xlsx); {_EXPORT}"
    more = ", ..." if len(names) > _NAMED else ""
    return f"a zip archive with {', '.join(names[:_NAMED])}{more}; {_UNPACK}"
