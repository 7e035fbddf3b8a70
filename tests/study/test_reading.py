"""What a [study] may say, and what is made of it."""

import pytest

from eventpound.errors import InputError
from eventpound.study.reading import load_study
from tests.study.conftest import ELASTOPLASTIC

SINE = 'kind = "sine"\namplitude = "0.4 g"\nperiod = "1 s"\n'
SHOCKS = 'kind = "record"\nfile = ["a.AT2", "b.AT2"]\npsa = ["1 g", "1 g"]\npsa_period = "T1"\n'
PAIR = f"""
body = [{{ name = "left", mass = "500 t" }}, {{ name = "right", mass = "500 t" }}]
contact = [{{ between = ["left", "right"], name = "joint", gap = "1 cm", restitution = 0.6 }}]
[excitation]
{SINE}[[spring]]
between = ["ground", "left"]
name = "l"
law = "bouc-wen"
post_yield_period = "2 s"
strength = "500 kN"
yield_displacement = "1 cm"
[[spring]]
between = ["ground", "right"]
name = "r"
law = "linear"
period = "0.8 s"
"""


@pytest.mark.parametrize(
    "driven",
    [
        '[[force]]\nbody = "left"\nfile = "beside.csv"',
        '[[support]]\nname = "pier"\n[support.excitation]\nkind = "record"\n'
        'file = "beside.csv"\nunits = "g"',
    ],
)
def test_a_file_that_a_case_names_decides_its_study(make_study, tmp_path, driven):
    digests = []
    for value in ("1", "2", "1"):
        (tmp_path / "case").mkdir(exist_ok=True)
        rows = "".join(f"{0.01 * i:.2f},{value}\n" for i in range(9))
        (tmp_path / "case" / "beside.csv").write_text(rows)
        axis = '[study]\nquantities = ["impacts"]\n[[study.axis]]\nkey = "contact.joint.gap"\n'
        digests.append(make_study(f"{PAIR}{driven}\n{axis}values = [0.01]\n").study.digest)
    assert digests[0] == digests[2] != digests[1]


def test_parts_have_tables_and_axes_of_their_own(make_study):
    text = """
[excitation]
kind = "sine"
[pi]
structure = "elastic"
delta = 0.5
epsilon = 0.6
[study]
quantities = ["pi_um"]
[[study.part]]
name = "elastic"
[[study.part.axis]]
key = "pi.omega_s"
values = [1, 2, 3]
[[study.part]]
name = "plastic"
pi = { structure = "elastoplastic", uy = 0.2 }
[[study.part.axis]]
key = "pi.Q"
values = [0.5, 1.0]
"""
    study = make_study(text).study
    assert study.columns == ("part", "pi.omega_s", "pi.Q")
    assert [base.labels for base in study.bases] == [{"part": "elastic"}, {"part": "plastic"}]
    assert [base.size for base in study.bases] == [3, 2]


def axis(lines: str) -> str:
    return ELASTOPLASTIC + "[[study.axis]]\n" + lines


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (axis('key = "pi.epsilon"\nvalues = [0.5, 1.5]'), ["pi.epsilon", "value 1.5", "0 to 1"]),
        (axis('key = "pi.Q"\nvalues = [1]'), ["'pi.Q' on two axes"]),
        (axis('key = "Q"\nvalues = [1]'), ["key: found 'Q'"]),
        (axis('key = "spring.0.strenght"\nvalues = [1]'), ["mean 'spring.0.strength'"]),
        (axis('key = "pi.uy.1"\nvalues = [1]'), ["uy.1"]),
        (axis('key = "pi.epsilon"\nvalues = []'), ["values: found []; accepted: a list with"]),
        (axis('key = "pi.epsilon"\nvalues = ["1 s"]'), ["values", "'1 s'"]),
        (axis('key = "pi.epsilon"\nfrom = 0\nto = 1\ncount = 1'), ["count: found 1"]),
        (axis('key = "pi.uy"\nfrom = 0\nto = 1\ncount = 0'), ["count: found 0"]),
        (axis('key = "pi.uy"\nfrom = 0\nto = 1\ncount = 9\nspacing = "logarithmic"'), ["from"]),
        (axis('key = "pi.epsilon"\nfrom = 0\nto = 1'), ["count: missing"]),
        (axis('key = "pi.epsilon"\nvalues = [1]\nform = 1'), ["form: unknown key"]),
        (axis('key = "run.duration"\nvalues = [1]\nzip = "a"'), ["zip"]),
        (axis('key = "pi.uy"\nvalues = [1]\nzip = "a"\n[[study.axis]]\nkey = "pi.epsilon"\n'
              'values = [0, 1]\nzip = "a"'), ["zip: found axes of [1, 2] values"]),
        (ELASTOPLASTIC.replace('"pi_um",', '"pi_umm",'), ["quantities: found 'pi_umm'", "'pi_um'"]),
        (ELASTOPLASTIC + '[figure]\nx = "pi.q"\ny = "pi_um"', ["[figure]: x: found 'pi.q'"]),
        (ELASTOPLASTIC + '[figure]\nx = "pi.Q"', ["[figure]: y: missing"]),
        (ELASTOPLASTIC + '[solver]\nname = "fats"', ["fats"]),
        (ELASTOPLASTIC + '[[study.part]]\nname = "a"\n' * 2, ["name: found 'a'"]),
        (axis('key = "deck.C.skew"\nvalues = [0.1]'), ["(deck.C.skew): found no [[deck]] of that"]),
        (PAIR.replace(SINE, SHOCKS) + '[study]\n[[study.axis]]\nkey = "spring.r.stiffness"\n'
              'values = [1e6]', ["[excitation]: psa_period: found a period of the scene"]),
        (PAIR, ["[study]: missing"]),
        (PAIR + "[study]", ["axis: missing"]),
    ],
)  # fmt: skip
def test_problems_are_named_before_anything_runs(make_study, text, words):
    with pytest.raises(InputError) as caught:
        make_study(text)
    for word in words:
        assert word in str(caught.value), str(caught.value)
    for problem in caught.value.problems:
        assert problem.split(": ")[0].endswith("case.toml"), problem


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("peak.left.abs_max", "found 'peak.left.abs_max', did you mean 'peaks.left.abs_max'?"),
        ("contacts.joint.resting", "did you mean 'contacts.joint.resting_time'?"),
        ("nothing of it", "; accepted: what `eventpound check CASE --quantities` lists, as peaks"),
        ("free.amplification", "found 'free.amplification'"),
    ],
)
def test_a_quantity_that_is_not_known(make_study, name, said):
    axis = (
        '[study]\nquantities = ["{}"]\n[[study.axis]]\nkey = "contact.joint.gap"\nvalues = [0.1]\n'
    )
    with pytest.raises(InputError) as caught:
        make_study(PAIR + axis.format(name))
    assert said in str(caught.value)
    assert len(str(caught.value).splitlines()) == 1


def test_quantities_by_path_are_those_of_every_part(make_study):
    axis = '[[study.part.axis]]\nkey = "body.left.mass"\nvalues = ["400 t"]\n'
    parts = f'[[study.part]]\nname = "a"\n{axis}[[study.part]]\nname = "b"\ncontact = []\n{axis}'
    paths = '["peaks.<body>.abs_max", "free.peaks.<body>.max", "contacts.<contact>.impacts"]'
    study = make_study(PAIR + f"[study]\nquantities = {paths}\n{parts}").study
    bodies = ("left", "right")
    peaks = [f"peaks.{b}.abs_max" for b in bodies] + [f"free.peaks.{b}.max" for b in bodies]
    assert study.quantities == (*peaks, "contacts.joint.impacts")


def test_digest_sees_what_decides_the_table_and_nothing_else(make_study):
    here = make_study().study.digest
    assert make_study(name="elsewhere").study.digest == here
    assert make_study(ELASTOPLASTIC + '[figure]\nx = "pi.Q"\ny = "pi_um"').study.digest == here
    for old, new in (("uy = 0.2", "uy = 0.3"), ("to = 1.6", "to = 1.7"), ("periods = 6", "")):
        assert make_study(ELASTOPLASTIC.replace(old, new)).study.digest != here


def test_a_directory_without_a_case(tmp_path):
    with pytest.raises(InputError, match=r"no case\.toml"):
        load_study(tmp_path)
