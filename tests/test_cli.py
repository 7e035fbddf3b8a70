"""The command line: exit codes, what it prints, what it does not import."""

import re
import subprocess
import sys
import threading
from pathlib import Path

import pytest

import eventpound.cli.arguments
from eventpound import cli
from eventpound.cli import main


def test_new_then_check(tmp_path, capsys):
    directory = tmp_path / "pulse"
    assert main(["new", str(directory)]) == 0
    assert "case.toml" in capsys.readouterr().out
    assert main(["check", str(directory)]) == 0
    out, err = capsys.readouterr()
    assert "contact  between" in out
    assert "cosine" in out
    assert err == ""
    assert [path.name for path in directory.iterdir()] == ["case.toml"]


def test_warnings_go_to_stderr(tmp_path, capsys):
    main(["new", str(tmp_path)])
    file = tmp_path / "case.toml"
    file.write_text(file.read_text().replace("hardening = 0.05", "hardening = 0.05\ngamma = 0.4"))
    capsys.readouterr()
    assert main(["check", str(tmp_path)]) == 0
    assert "gamma = 0.4" in capsys.readouterr().err


@pytest.mark.parametrize(
    "words",
    [
        ["fly"],
        ["run"],
        ["run", ".", "--rtol", "2"],
        ["run", ".", "--rtol", "x"],
        ["floor-spectrum", ".", "deck", "--periods", "2,1"],
    ],
)
def test_wrong_words(words, capsys):
    with pytest.raises(SystemExit) as caught:
        main(words)
    assert caught.value.code == 2
    assert "usage" in capsys.readouterr().err


def test_interruption(monkeypatch, capsys):
    def interrupted(_: Path) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(eventpound.cli.arguments, "loaded_case", interrupted)
    assert main(["run", ".", "--export", "out"]) == 130
    assert "interrupted" in capsys.readouterr().err


def test_interruption_that_others_complain_of(monkeypatch):
    def overlooked(_: Path) -> None:
        raise SystemError("returned a result with an exception set") from KeyboardInterrupt()

    def not_taken(_: Path) -> None:
        lock = threading.Lock()
        try:
            raise KeyboardInterrupt
        finally:
            lock.release()

    def broken(_: Path) -> None:
        raise SystemError("broken")

    for complain in (overlooked, not_taken):
        monkeypatch.setattr(eventpound.cli.arguments, "loaded_case", complain)
        assert main(["run", ".", "--export", "out"]) == 130
    monkeypatch.setattr(eventpound.cli.arguments, "loaded_case", broken)
    with pytest.raises(SystemError, match="broken"):
        main(["run", ".", "--export", "out"])


def modules_after(*commands: list[str]) -> set[str]:
    """Modules a new process has imported after some commands."""
    code = "import sys\nfrom eventpound.cli import main\n"
    for words in commands:
        code += f"try:\n    main({words!r})\nexcept SystemExit:\n    pass\n"
    code += "print('\\n'.join(sys.modules))"
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return set(found.stdout.split())


def test_help_imports_nothing_heavy():
    heavy = {"numpy", "scipy", "pandas", "matplotlib", "sksundae", "numba", "pint"}
    assert not heavy & modules_after(["--help"])


def test_check_imports_what_it_needs(tmp_path):
    main(["new", str(tmp_path)])
    modules = modules_after(["check", str(tmp_path)])
    assert "eventpound.scene.check" in modules
    assert not {"pandas", "matplotlib", "sksundae", "numba", "pint"} & modules


def test_a_run_of_kept_kernels_imports_no_compiler_and_no_tables(tmp_path):
    main(["new", str(tmp_path)])
    start = ["run", str(tmp_path), "--no-figures", "--solver"]
    commands = [[*start, solver] for solver in ("cvode", "fast", "ida")]
    for words in commands:
        main(words)
    # Of SciPy Numba asks for the version; what it compiles with is below `numba.np.linalg`.
    heavy = {"pandas", "matplotlib", "sksundae", "scipy.linalg", "scipy.sparse", "numba.np.linalg"}
    assert not heavy & modules_after(*commands)


def test_a_run_imports_its_own_solver_and_its_figures_no_tables(tmp_path):
    main(["new", str(tmp_path)])
    words = ["run", str(tmp_path), "--solver", "fast"]
    main([*words, "--no-figures"])
    modules = modules_after(words, ["plot", str(tmp_path)])
    assert {"eventpound.solvers.fast.solver", "matplotlib"} <= modules
    others = {f"eventpound.solvers.{name}" for name in ("cvode", "ida", "moreau", "penalty")}
    assert not {"pandas", "scipy.linalg", "pint", *others} & modules


def test_commands_stand_by_their_tasks(capsys):
    with pytest.raises(SystemExit) as caught:
        main(["--help"])
    assert caught.value.code == 0
    out = capsys.readouterr().out
    tasks = ["one case:", "many runs:", "records and motions:", "how sure, how fast:"]
    assert [out.index(task) for task in tasks] == sorted(out.index(task) for task in tasks)
    assert out.index("many runs:") < out.index("\n  study ") < out.index("records and motions:")
    # Every command stands there once, with its line of help; those of two words below their first.
    names = cli._parser()._subparsers._group_actions[0].choices
    commands = [name for name in names if " " not in name]
    assert len(commands) == 12
    for command in commands:
        assert out.count(f"\n  {command} ") == 1, command


@pytest.mark.parametrize(
    "words",
    [
        "run . --export out --rtol 1e-3",
        "run . --export out --no-figures",
        "check . --quantities --json",
        "plot . --model --xlim 1,2",
        "solvers --processes 2",
        "problems pack set --patience 3",
        "problems pack set --freeze --out a.zip",
        "problems score set answer.csv --limit 3",
        "records a.AT2 --target b.csv",
        "records a.AT2 --pulse-to acceleration",
        "records a.AT2 --list b.csv",
    ],
)
def test_an_option_that_does_not_apply_is_refused(words, capsys):
    assert main(words.split()) == 2
    assert re.match(r"eventpound: --.*(is |needs )", capsys.readouterr().err)


def test_messages_name_pages_and_where_the_site_is_known_their_addresses(monkeypatch, capsys):
    def said() -> str:
        with pytest.raises(SystemExit):
            main(["verify", "--help"])
        return capsys.readouterr().out

    assert 'the page "accuracy" of the documentation' in said()
    monkeypatch.setenv("EVENTPOUND_DOCS", "https://example.org/docs/")
    assert "https://example.org/docs/accuracy.html" in said()


@pytest.mark.parametrize("words", [["-q", "solvers"], ["solvers", "-q"], ["solvers", "--quiet"]])
def test_quiet(words, capsys):
    assert main(words) == 0
    assert capsys.readouterr() == ("", "")


def test_quiet_says_errors(tmp_path, capsys):
    assert main(["run", "-q", str(tmp_path / "nowhere")]) == 2
    assert "nowhere" in capsys.readouterr().err


def test_verbose_says_steps(tmp_path, capsys):
    main(["new", str(tmp_path)])
    for words in (["-v", "check", str(tmp_path)], ["check", str(tmp_path), "-v"]):
        capsys.readouterr()
        assert main(words) == 0
        err = capsys.readouterr().err
        assert re.search(r"^ +\d+\.\d\d s  read .*: 1 bodies, 1 contacts$", err, re.MULTILINE)
        assert "ended with exit code 0" in err
    # What one command was told does not hold for the next.
    assert main(["check", str(tmp_path)]) == 0
    assert "read " not in capsys.readouterr().err


def test_new_says_what_its_record_does_not(tmp_path, capsys):
    record = tmp_path / "a.txt"
    record.write_text("0.1\n0.2\n-0.1\n")
    assert main(["new", str(tmp_path / "case"), "--bridge", "--record", str(record)]) == 0
    err = capsys.readouterr().err
    assert "to be filled in" in err
    assert "units" in err
    assert (tmp_path / "case" / "case.toml").is_file()
