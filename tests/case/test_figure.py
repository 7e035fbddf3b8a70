"""What a figure of a case asks for."""

from eventpound import load_case
from eventpound.case.figure import FigureKind


def test_contours_need_no_bodies(tmp_path):
    (tmp_path / "case.toml").write_text(
        '[excitation]\nkind = "record"\nsynthetic = { count = 2 }\n'
        '[figure]\nkind = "similarity-contours"\ncontours = [0.1, 1]\n'
        'joint = [{ name = "in-deck", gap = ["0.6 cm", "1.3 cm"] }]\n'
        'isolator = [{ name = "sliding", yield_displacement = "0.02 cm" }]\n'
    )
    figure = load_case(tmp_path).figures[0]
    assert figure.kind is FigureKind.SIMILARITY_CONTOURS
    (joint,), (isolator,) = figure.joints, figure.isolators
    assert (joint.name, joint.low, joint.high) == ("in-deck", 0.006, 0.013)
    assert (isolator.low, isolator.high) == (0.0002, 0.0002)
    assert figure.contours == (0.1, 1.0)
