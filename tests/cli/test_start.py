"""A signal ends a command within the time it has, whatever its main thread does, and leaves no temporary folder."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
STUCK = """
import _imp
import time
from seatsim.cli import start, terminal
from seatsim.schema.leftovers import temporary_folder
start.GRACE = 0.2
start.watch_signals()
with temporary_folder() as folder:
    (folder / "file").write_text("unpacked")
    while True:
        try:
            print("ready", flush=True)
            time.sleep(30)
        except KeyboardInterrupt:
            {answer}
"""


def stuck(answer, place):
    environment = os.environ | {"PYTHONPATH": str(ROOT), "TMPDIR": str(place)}
    process = subprocess.Popen(
        [sys.executable, "-c", STUCK.format(answer=answer)], env=environment, stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )  # fmt: skip
    assert process.stdout.readline() == b"ready\n"
    return process


# An interrupt within an import may leave its lock held.
@pytest.mark.parametrize("answer", ["pass", "_imp.acquire_lock()"])
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_main_thread_that_does_not_answer_is_not_waited_for(number, answer, tmp_path):
    process = stuck(answer, tmp_path)
    process.send_signal(number)
    _, said = process.communicate(timeout=10)
    assert process.returncode == 128 + number and said == b"error: interrupted\n"
    assert list(tmp_path.iterdir()) == []


def test_a_command_that_answers_goes_on(tmp_path):
    process = stuck("start.go_on(); time.sleep(0.6); print('done', flush=True); break", tmp_path)
    process.send_signal(signal.SIGINT)
    shown, _ = process.communicate(timeout=10)
    assert process.returncode == 0 and shown.endswith(b"done\n")


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_command_says_that_it_was_interrupted(number, tmp_path):
    process = subprocess.Popen(
        [sys.executable, "-m", "seatsim", "run", "laws", "--set", "excitation.duration=3000", "--out", "out"],
        env=os.environ | {"PYTHONPATH": str(ROOT)}, cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
    )  # fmt: skip
    with pytest.raises(subprocess.TimeoutExpired):
        process.communicate(timeout=1.5)
    process.send_signal(number)
    try:
        _, said = process.communicate(timeout=30)
    finally:
        process.kill()
    assert process.returncode == 128 + number and said.endswith(b"error: interrupted\n")
    assert not any(path.name.endswith(".part") for path in tmp_path.rglob("*"))
