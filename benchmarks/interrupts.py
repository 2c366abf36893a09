"""Ctrl-C, and a kill, at random moments of commands: how long they take to end, with which status, and what stays.

    python benchmarks/interrupts.py [--moments 50] [--signal SIGTERM] [--cold] [--kill] [--seed 0]

An interrupted command ends within two seconds with status 130 (143 after SIGTERM, 0 where it was done) and leaves no
process and no temporary folder behind, also while it compiles (`--cold`: each finds an empty cache). After
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
from collections.abc import Iterator, Mapping
from pathlib import Path

HERE = Path(__file__).resolve().parents[1]
EXAMPLES = HERE / "scenarios"
RECORDING = EXAMPLES / "data" / "recording"
WITHIN = 2.0
"""Seconds in which an interrupted command must end."""
INTERRUPTED = {
    "run": ["run", "laws", "--set", "excitation.duration=600"],
    "compare": ["compare", "em5", "em6", "laws", "--set", "excitation.duration=300"],
    "sweep": ["sweep", str(HERE / "docs" / "sweeps" / "tolerances.yaml"), "--jobs", "2"],
    "diagnose": ["diagnose", str(RECORDING)],
    "blind make": ["blind", "make", "--cases", "4", "--seed", "1", "--sealed", "{out}-sealed"],
}
KILLED = {
    "gap": ["gap", str(RECORDING / "nominal.yaml"), str(RECORDING)],
    "run": ["run", "quickstart", "--set", "excitation.duration=1"],
    "import": ["import", str(RECORDING / "run-1.csv.gz")],
    "characterise": ["characterise", str(EXAMPLES / "data" / "bench")],
    "seat-test": ["seat-test", "quickstart", "--class", "EM1"],
}


def main() -> None:
    """Print what is wrong after each moment, and fail where anything is."""
    options = argparse.ArgumentParser()
    options.add_argument("--moments", type=int, default=50)
    options.add_argument("--kill", action="store_true", help="kill commands, and run them again")
    options.add_argument("--only", nargs="*", help="commands")
    options.add_argument("--signal", choices=("SIGINT", "SIGTERM"), default="SIGINT")
    options.add_argument("--cold", action="store_true", help="compile everything anew")
    options.add_argument("--seed", type=int, default=0)
    asked = options.parse_args()
    generator, commands = random.Random(asked.seed), KILLED if asked.kill else INTERRUPTED
    names = asked.only or list(commands)
    sent = signal.Signals[asked.signal]
    problems: list[str] = []
    times: list[float] = []
    for number in range(asked.moments):
        name = names[number % len(names)]
        with tempfile.TemporaryDirectory() as place:
            folder = Path(place)
            tried = (
                kill(commands[name], folder, generator)
                if asked.kill
                else interrupt(commands[name], folder, generator, sent, asked.cold, times)
            )
            said = [f"{name}: {problem}" for problem in tried]
        print(f"{number + 1} of {asked.moments}, {name}: {'; '.join(said) or 'right'}", flush=True)
        problems += said
    print(f"{asked.moments} moments, {len(problems)} problems")
    if times:
        print(f"the end took {max(times):.2f} s at most, {sorted(times)[len(times) // 2]:.2f} s in the middle")
    raise SystemExit(bool(problems))


def start(arguments: list[str], out: Path, more: Mapping[str, str] | None = None) -> subprocess.Popen[bytes]:
    """Start a command in a session of its own, whose processes can be told from others, with `more` environment."""
    words = [word.format(out=out) for word in arguments]
    command = [sys.executable, "-m", "seatsim", *words, "--out", str(out)]
    return subprocess.Popen(
        command,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        start_new_session=True,
        cwd=out.parent,
        env=os.environ | (more or {}),
    )


def interrupt(
    arguments: list[str], place: Path, generator: random.Random, sent: signal.Signals, cold: bool, times: list[float]
) -> Iterator[str]:
    """Interrupt a command, add the time that its end takes to `times`, and yield what is wrong with it."""
    temporary = place / "temporary"
    temporary.mkdir()
    cache = {"SEATSIM_CACHE_DIR": str(place / "cache")} if cold else {}
    process = start(arguments, place / "out", {"TMPDIR": str(temporary), **cache})
    time.sleep(generator.uniform(0.2, 15.0))
    process.send_signal(sent)
    since = time.monotonic()
    try:
        _, said = process.communicate(timeout=60.0)
    except subprocess.TimeoutExpired:
        yield "did not end within 60 s"
        os.killpg(process.pid, signal.SIGKILL)
        process.communicate()
        return
    took = time.monotonic() - since
    times.append(took)
    if process.returncode not in (128 + sent, 0):
        yield f"status {process.returncode}: {said.decode()[-200:]}"
    if took > WITHIN:
        yield f"took {took:.1f} s to end"
    if b"Traceback" in said:
        yield f"a traceback: {said.decode()[-300:]}"
    if orphans := find_processes(process.pid):
        yield f"left {len(orphans)} processes"
        os.killpg(process.pid, signal.SIGKILL)
    if left := [each.name for each in (*temporary.iterdir(), *place.iterdir()) if _is_left(each)]:
        yield f"left {left}"


def _is_left(path: Path) -> bool:
    return path.parent.name == "temporary" or path.name.endswith(".part")


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
