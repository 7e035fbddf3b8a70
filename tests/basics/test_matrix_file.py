"""Files of matrices in every form, and what is refused."""

import io
from typing import Any

import numpy as np
import pytest
from scipy.io import mmwrite
from scipy.sparse import csr_array

from eventpound import InputError
from eventpound.basics.matrix_file import read_matrix
from eventpound.cli import main
from tests.case.test_frame import FRAME, NAMED, PULSE, K, M, lines


def npy(values: np.ndarray) -> bytes:
    file = io.BytesIO()
    np.save(file, values)
    return file.getvalue()


def market(values: Any) -> bytes:
    file = io.BytesIO()
    mmwrite(file, values, precision=17)
    return file.getvalue()


WAYS: dict[str, tuple[str, bytes, tuple[str, ...]]] = {
    "csv": ("K.csv", lines(K).encode(), ()),
    "semicolons": ("K.csv", b"\xef\xbb\xbf# of ETABS\n" + lines(K, ";").encode(), ()),
    "columns": ("K.txt", b"% K\n\n" + lines(K, "  ").encode(), ()),
    "named": ("K.csv", NAMED.encode(), ("a", "b", "c")),
    "heads": ("K.csv", b"a, b, c\n" + lines(K).encode(), ("a", "b", "c")),
    "fortran": ("K.dat", lines(K).replace(".0", "D0").encode(), ()),
    "npy": ("K.npy", npy(K), ()),
    "integers": ("K.npy", npy(K.astype(np.int64)), ()),
    "market": ("K.mtx", market(K), ()),
    "sparse": ("K.mtx", market(csr_array(K)), ()),
}


@pytest.mark.parametrize("way", WAYS)
def test_a_file_is_read_in_every_form(way, tmp_path):
    name, content, names = WAYS[way]
    (tmp_path / name).write_bytes(content)
    found = read_matrix(tmp_path / name)
    assert found.values == pytest.approx(K, rel=1e-15)
    assert found.names == names


BROKEN: dict[str, tuple[str, bytes, str]] = {
    "pickle": ("K.npy", npy(np.array([{}], dtype=object)), "cannot be read: Object arrays"),
    "cut": ("K.npy", npy(K)[:90], "cannot be read"),
    "complex": ("K.npy", npy(K * 1j), "holds no matrix of real numbers"),
    "cube": ("K.npy", npy(np.zeros((2, 2, 2))), "holds no matrix"),
    "no market": ("K.mtx", b"hello", "cannot be read"),
    "huge": (
        "K.mtx",
        b"%%MatrixMarket matrix coordinate real general\n900000 900000 1\n1 1 1.0\n",
        "900000 rows and 900000 columns; accepted: up to",
    ),
    "empty": ("K.csv", b"# nothing\n", "has no rows of numbers"),
    "word": ("K.csv", b"1,2\n3,x\n", "line 2: 'x' is not a number"),
    "width": ("K.csv", b"1,2\n\n3\n", "line 3 has 1 numbers, those before 2"),
    "heads": ("K.csv", b"a,b,c\n1,2\n3,4\n", "names 3 columns and has 2"),
    "others": ("K.csv", b",a,b\nb,1,2\na,3,4\n", "its rows and columns have other names"),
    "binary": ("K.csv", b"\xff\xfe\x00", "cannot be read"),
}


@pytest.mark.parametrize("way", BROKEN)
def test_a_broken_file_is_refused(way, tmp_path):
    name, content, said = BROKEN[way]
    (tmp_path / name).write_bytes(content)
    with pytest.raises(InputError) as caught:
        read_matrix(tmp_path / name)
    assert str(caught.value).startswith(str(tmp_path / name))
    assert said in str(caught.value)
    (tmp_path / "M.csv").write_text(lines(M))
    (tmp_path / "case.toml").write_text(PULSE + FRAME.replace("K.csv", name))
    assert main(["check", str(tmp_path)]) == 2
