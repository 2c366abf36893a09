"""A signal ends a command within the time it has, whatever its main thread does, and leaves no temporary folder."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PATIENCE = 900.0
"""Seconds after which a process counts as stuck, on a machine that is busy too."""
STUCK = """
import _imp
import time
from seatsim.cli import begin
from seatsim.schema.guarded import temporary_folder
begin.GRACE = 0.2
begin.watch_signals()
with temporary_folder() as folder:
    (folder / "file").write_text("unpacked")
    while True:
        try:
            print("ready", flush=True)
            time.sleep(30)
        except KeyboardInterrupt:
            {answer}
"""


def start(arguments, **options):
    environment = os.environ | {"PYTHONPATH": str(ROOT)} | options.pop("env", {})
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    return subprocess.Popen([sys.executable, *arguments], env=environment, **pipes, **options)


def stuck(answer, place):
    process = start(["-c", STUCK.format(answer=answer)], env={"TMPDIR": str(place)})
    assert process.stdout.readline() == b"ready\n"
    return process


# An interrupt within an import may leave its lock held.
@pytest.mark.parametrize("answer", ["pass", "_imp.acquire_lock()"])
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_main_thread_that_does_not_answer_is_not_waited_for(number, answer, tmp_path):
    process = stuck(answer, tmp_path)
    process.send_signal(number)
    _, said = process.communicate(timeout=PATIENCE)
    assert process.returncode == 128 + number and said == b"error: interrupted\n"
    assert list(tmp_path.iterdir()) == []


SWEEP = "scenario: em5\nvary: {excitation.duration: [3000.0, 3001.0]}\n"


@pytest.mark.parametrize(
    ("number", "command"),
    [
        (signal.SIGINT, ("run", "laws", "--set", "excitation.duration=3000")),
        (signal.SIGTERM, ("run", "laws", "--set", "excitation.duration=3000")),
        (signal.SIGINT, ("sweep", "sweep.yaml")),
    ],
)
def test_a_command_says_that_it_was_interrupted(number, command, tmp_path):
    (tmp_path / "sweep.yaml").write_text(SWEEP)
    process = start(["-X", "importtime", "-m", "seatsim", *command, "--out", "out"], cwd=tmp_path)
    while b"seatsim.cli.app" not in process.stderr.readline():  # each module is told of once it is loaded
        assert process.poll() is None
    with pytest.raises(subprocess.TimeoutExpired):
        process.communicate(timeout=1.0)
    process.send_signal(number)
    try:
        _, said = process.communicate(timeout=PATIENCE)
    finally:
        process.kill()
    assert process.returncode == 128 + number and said.endswith(b"error: interrupted\n")
    assert not any(path.name.endswith(".part") for path in tmp_path.rglob("*"))
