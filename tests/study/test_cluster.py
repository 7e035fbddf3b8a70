"""A Dask scheduler and two workers on this machine, one of which is killed."""

import json
import os
import signal
import subprocess
import sys
import time

import pytest

from eventpound.cli import main
from tests.study.conftest import ELASTOPLASTIC, expected_table, table_by

pytest.importorskip("distributed", reason="Dask is not installed")


@pytest.fixture
def cluster(tmp_path):
    """Address of a scheduler, and its two workers."""
    address = tmp_path / "scheduler.json"
    scheduler = [sys.executable, "-m", "distributed.cli.dask_scheduler", "--no-dashboard"]
    worker = [sys.executable, "-m", "distributed.cli.dask_worker", "--no-nanny", "--no-dashboard"]
    file = ["--scheduler-file", str(address)]
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    host = ["--host", "127.0.0.1"]
    processes = [subprocess.Popen([*scheduler, *host, "--port", "0", *file], **quiet)]
    while not address.exists():
        assert processes[0].poll() is None
        time.sleep(0.05)
    workers = [
        subprocess.Popen([*worker, *host, "--nthreads", "1", *file], **quiet) for _ in range(2)
    ]
    yield json.loads(address.read_text())["address"], workers
    for process in [*workers, *processes]:
        process.kill()
        process.wait()


@pytest.mark.filterwarnings("default")
def test_two_workers_give_the_same_table_though_one_is_killed(make_study, cluster):
    from eventpound.study.engine import Cluster

    address, workers = cluster
    study = make_study(ELASTOPLASTIC.replace("count = 40", "count = 640")).study
    assert table_by(Cluster(address), study, 5, workers[0].kill) == expected_table(study)


@pytest.mark.filterwarnings("default")
def test_workers_of_its_own(make_study):
    case = make_study()
    assert main(["study", str(case.directory), "--workers", "2", "--no-figures"]) == 0
    table = (case.directory / "results" / "study.csv").read_bytes()
    assert table == expected_table(case.study)


@pytest.mark.filterwarnings("default")
def test_a_scheduler_that_does_not_answer(make_study, capsys, monkeypatch):
    case = make_study()
    assert main(["study", str(case.directory), "--scheduler", "tcp://127.0.0.1:1"]) == 2
    assert "does not answer" in capsys.readouterr().err


@pytest.mark.filterwarnings("default")
def test_the_only_worker_is_killed_and_comes_back(make_study):
    """What was sent to it once is sent again."""
    from distributed import Client

    from eventpound.study.engine import Cluster

    study = make_study(ELASTOPLASTIC.replace("count = 40", "count = 320")).study
    with Client(n_workers=1, threads_per_worker=1, dashboard_address=None) as client:

        def kill() -> None:
            (pid,) = client.run(os.getpid).values()
            os.kill(pid, signal.SIGKILL)

        table = table_by(Cluster(client.scheduler.address), study, 3, kill)
    assert table == expected_table(study)
