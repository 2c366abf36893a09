"""What the command line does on terminals that close, know ASCII alone, or where something unforeseen happens."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from seatsim.cli import app

ROOT = Path(__file__).resolve().parents[2]
START = [sys.executable, "-m", "seatsim"]


def started(*arguments, encoding="utf-8", **options):
    environment = os.environ | {"PYTHONPATH": str(ROOT), "PYTHONIOENCODING": encoding}
    return subprocess.Popen([*START, *arguments], env=environment, stderr=subprocess.PIPE, **options)


def test_a_reader_that_goes_away_is_no_error():
    """As `seatsim describe | head -1`, where nothing at all is read."""
    reading, writing = os.pipe()
    os.close(reading)
    process = started("describe", stdout=writing)
    os.close(writing)
    _, said = process.communicate()
    assert b"Traceback" not in said and b"Broken" not in said
    assert process.returncode in (0, 1)


def test_a_terminal_that_knows_ascii_alone_is_no_error():
    process = started("describe", "road", stdout=subprocess.PIPE, encoding="ascii")
    shown, said = process.communicate()
    assert process.returncode == 0, said
    assert shown.decode("ascii").startswith("road (excitation)")


@pytest.mark.parametrize(
    ("error", "expected", "status"),
    [
        (ZeroDivisionError("by zero"), "failed at what it does not foresee: ZeroDivisionError: by zero", 1),
        (MemoryError("Unable to allocate 447. GiB"), "the memory is exhausted (Unable to allocate 447. GiB)", 1),
        (KeyboardInterrupt(), "interrupted", 130),
    ],
)
def test_no_traceback_reaches_the_user(monkeypatch, capsys, error, expected, status):
    def fail(**_):
        raise error

    monkeypatch.setattr(app, "app", fail)
    with pytest.raises(SystemExit) as stopped:
        app.main()
    assert stopped.value.code == status
    assert expected in capsys.readouterr().err
    monkeypatch.setenv(app.TRACEBACK, "1")
    if isinstance(error, ZeroDivisionError):
        with pytest.raises(ZeroDivisionError):
            app.main()


@pytest.mark.filterwarnings("default")
def test_a_warning_of_own_code_is_one_line(tmp_path, seatsim_command, forget_own_code):
    (tmp_path / "noisy_one.py").write_text("import warnings\nwarnings.warn('it is odd')\n")
    assert seatsim_command("describe", "road", "--with", tmp_path / "noisy_one.py")[2] == "warning: it is odd\n"


def test_names_in_files_lead_nowhere_else(seat_file, tmp_path, here, seatsim_command):
    for name in ("../../escaped", "/tmp/escaped", "a\\b", "", "..", "x" * 200, "\0", " a", "a\n"):
        text = "\n".join(line for line in seat_file.read_text().splitlines() if not line.startswith("name"))
        seat_file.write_text(f"name: {json.dumps(name)}\n{text}\n")
        status, _, said = seatsim_command("run", seat_file)
        assert status == 2 and ", line 1" in said
        assert [path.name for path in tmp_path.iterdir()] == [seat_file.name]


LONG = 5_000 * "a"


@pytest.mark.parametrize("words", [
    f"run {LONG}.yaml", f"run a/{LONG}", f"gap quickstart {LONG}", f"comfort {LONG}.csv", f"check {LONG}",
    f"export quickstart --to c --what damper --out {LONG}.c",
], ids=lambda words: words.split()[0])  # fmt: skip
def test_a_name_that_no_file_can_have_is_bad_input_in_a_few_words(words, seatsim_command):
    status, _, said = seatsim_command(*words.split())
    assert status == 2 and "error: " in said and len(said) < 2_000
