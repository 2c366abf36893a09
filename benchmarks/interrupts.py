"""Ctrl-C, and a kill, at random moments of commands: how long they take to end, with which status, and what stays.

    python benchmarks/interrupts.py [--moments 50] [--kill] [--seed 0]

An interrupted command ends within two seconds with status 130 (0 where it was done) and leaves no process behind. After
a kill (`--kill`) the same command runs again: then the folder of results holds what an undisturbed one holds, and
nothing else. Linux alone.
"""

from __future__ import annotations

import argparse
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

EXAMPLES = Path(__file__).resolve().parents[1] / "scenarios"
RECORDING = EXAMPLES / "data" / "recording"
WITHIN = 2.0
"""Seconds in which an interrupted command must end."""
INTERRUPTED = {
    "run": ["run", "laws", "--set", "excitation.duration=600"],
    "diagnose": ["diagnose", str(RECORDING)],
    "blind make": ["blind", "make", "--cases", "4", "--seed", "1", "--sealed", "{out}-sealed"],
}
KILLED = {
    "gap": ["gap", str(RECORDING / "nominal.yaml"), str(RECORDING)],
    "run": ["run", "quickstart", "--set", "excitation.duration=1"],
}


def main() -> None:
    """Print what is wrong after each moment, and fail where anything is."""
    options = argparse.ArgumentParser()
    options.add_argument("--moments", type=int, default=50)
    options.add_argument("--kill", action="store_true", help="kill commands, and run them again")
    options.add_argument("--only", nargs="*", help="commands")
    options.add_argument("--seed", type=int, default=0)
    asked = options.parse_args()
    generator, commands = random.Random(asked.seed), KILLED if asked.kill else INTERRUPTED
    names = asked.only or list(commands)
    problems = []
    for number in range(asked.moments):
        name = names[number % len(names)]
        with tempfile.TemporaryDirectory() as place:
            try_moment = kill if asked.kill else interrupt
            said = [f"{name}: {problem}" for problem in try_moment(commands[name], Path(place), generator)]
        print(f"{number + 1} of {asked.moments}, {name}: {'; '.join(said) or 'right'}", flush=True)
        problems += said
    print(f"{asked.moments} moments, {len(problems)} problems")
    raise SystemExit(bool(problems))


def start(arguments: list[str], out: Path) -> subprocess.Popen[bytes]:
    """Start a command in a session of its own, whose processes can be told from others."""
    words = [word.format(out=out) for word in arguments]
    command = [sys.executable, "-m", "seatsim", *words, "--out", str(out)]
    return subprocess.Popen(
        command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, start_new_session=True, cwd=out.parent
    )


def interrupt(arguments: list[str], place: Path, generator: random.Random) -> Iterator[str]:
    """Interrupt a command, and yield what is wrong with its end."""
    process = start(arguments, place / "out")
    time.sleep(generator.uniform(2.0, 15.0))
    process.send_signal(signal.SIGINT)
    since = time.monotonic()
    try:
        _, said = process.communicate(timeout=60.0)
    except subprocess.TimeoutExpired:
        yield "did not end within 60 s"
        os.killpg(process.pid, signal.SIGKILL)
        process.communicate()
        return
    took = time.monotonic() - since
    if process.returncode not in (130, 0):
        yield f"status {process.returncode}: {said.decode()[-200:]}"
    if took > WITHIN:
        yield f"took {took:.1f} s to end"
    if b"Traceback" in said:
        yield f"a traceback: {said.decode()[-300:]}"
    if orphans := find_processes(process.pid):
        yield f"left {len(orphans)} processes"
        os.killpg(process.pid, signal.SIGKILL)


def kill(arguments: list[str], place: Path, generator: random.Random) -> Iterator[str]:
    """Kill a command, run it again, and yield what differs from an undisturbed one."""
    process = start(arguments, place / "out")
    time.sleep(generator.uniform(0.5, 6.0))
    process.kill()
    process.communicate()
    time.sleep(1.0)
    if orphans := find_processes(process.pid):
        yield f"left {len(orphans)} processes"
        os.killpg(process.pid, signal.SIGKILL)
    for out in (place / "out", place / "whole"):
        if start(arguments, out).wait() != 0:
            yield "does not run again"
    found, whole = ({str(each.relative_to(out)) for each in out.rglob("*")} for out in (place / "out", place / "whole"))
    if found != whole or {each.name for each in place.iterdir()} != {"out", "whole"}:
        yield f"left {sorted(found ^ whole)} and {sorted(each.name for each in place.iterdir())}"


def find_processes(session: int) -> list[int]:
    """Return the processes of a session that are still running."""
    found = []
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            fields = (folder / "stat").read_text(encoding="utf-8").rpartition(")")[2].split()
        except OSError:
            continue
        if int(fields[3]) == session and fields[0] != "Z":
            found.append(int(folder.name))
    return found


if __name__ == "__main__":
    main()
