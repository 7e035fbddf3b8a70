"""Processes: one table, though one of them is killed."""

import os
import signal
import time
from multiprocessing import active_children

import pytest

from eventpound.study.engine import Batch, Processes
from eventpound.study.running import Store, run_study
from tests.study.conftest import ELASTOPLASTIC, expected_table, table_by
from tests.study.test_running import MANY, Counting, start, wait_for_a_chunk


@pytest.mark.sweep
def test_processes_give_the_same_table_of_the_reference_solver(make_study):
    text = ELASTOPLASTIC.replace("count = 40", "count = 3") + '[solver]\nname = "cvode"\n'
    study = make_study(text.replace('"free.pi_um", "amplification", ', "")).study
    assert len(list(study.chunks())) == 4
    assert table_by(Processes(2), study) == expected_table(study)


def test_processes_give_the_same_table_though_one_is_killed(make_study):
    study = make_study(ELASTOPLASTIC.replace("count = 40", "count = 130")).study
    killed = table_by(
        Processes(2), study, 3, lambda: os.kill(active_children()[0].pid, signal.SIGKILL)
    )
    assert killed == expected_table(study)


def test_a_killed_study_gives_the_identical_table(make_study, tmp_path):
    """What is stored is never computed again."""
    case = make_study(MANY)
    out = case.directory / "results"
    store = Store(out, case.study)
    # At most the chunk in flight is lost: far less than the twentieth promised.
    assert case.study.chunk_size < 0.05 * case.study.size
    process = start(case.directory)
    wait_for_a_chunk(store, process)
    time.sleep(0.05)
    process.kill()
    process.wait()
    kept, rest = store.stored(), Counting()
    run_study(case.study, out, rest)
    assert not kept & set(rest.asked)
    run_study(case.study, tmp_path / "whole", Batch())
    whole = (tmp_path / "whole" / "study.csv").read_bytes()
    assert (out / "study.csv").read_bytes() == whole
    assert not list(out.rglob("*.partial"))
