"""A full disk at every moment: each call that writes fails once, and nothing may be half-written.

    python tests/robustness/write_faults.py [--only gap] [--every 1]

Each command runs once as it is, which counts its calls of open, write, fsync, mkdir, link and rename below the folder
of its results. Then it runs as often again, and the n-th of these calls fails as on a full disk: into a folder that is
not there yet, and into one that holds the files of an earlier command. Afterwards it must have ended with one error or
have succeeded, and the folder must hold all of its new files or all that it held before, and nothing else. A command
that keeps its finished parts goes on, and must then hold all of its files.

A shared library, compiled with `cc` and preloaded, fails the calls, since Python, pyarrow and matplotlib write in
different ways. Linux alone. The pictures of a command are drawn once, which takes most of its time, and written each
time.
"""

from __future__ import annotations

import argparse
import contextlib
import ctypes
import io
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parent
EXAMPLES = HERE.parents[1] / "scenarios"
RECORDING, BENCH = EXAMPLES / "data" / "recording", EXAMPLES / "data" / "bench"
ROOT, LIBRARY = "FAULT_ROOT", "FAULT_LIBRARY"
SWEEP = "scenario: quickstart\nvary: {plant.driver_mass: [60, 70], excitation.duration: [1]}\n"
OUT = "{out}"
COMMANDS: Mapping[str, Sequence[str]] = {
    "gap": ("gap", str(RECORDING / "nominal.yaml"), str(RECORDING), "--out", OUT),
    "new scenario": ("new", "scenario", f"{OUT}/rig"),
    "new recording": ("new", "recording", f"{OUT}/rig"),
    "new damper": ("new", "damper", f"{OUT}/own_damper"),
    "import": ("import", str(RECORDING / "run-1.csv.gz"), "--out", OUT),
    "comfort": ("comfort", str(RECORDING / "run-1.csv.gz"), "--channel", "z=driver_acceleration", "--out", OUT),
    "sweep": ("sweep", "{sweep}", "--jobs", "1", "--out", OUT),
    "run": ("run", "quickstart", "--set", "excitation.duration=1", "--out", OUT),
    "synthesise": ("synthesise", "h-infinity", "--out", OUT),
    "characterise": ("characterise", str(BENCH), "--out", OUT),
    "identify": ("identify", str(BENCH), "--model", "bingham", "--out", OUT),
    "seat-test": ("seat-test", "quickstart", "--class", "EM1", "--out", OUT),
    "diagnose": ("diagnose", str(RECORDING), "--budget", "5", "--out", OUT),
    "compare": ("compare", "quickstart", "--set", "excitation.duration=1", "--out", OUT),
    "sweep-report": ("sweep-report", "{made}/sweep", "--out", OUT),
    "reproduce": ("reproduce", "{made}/comfort", "--out", OUT),
    "export": ("export", "quickstart", "--to", "c", "--what", "controller", "--out", f"{OUT}/controller.c"),
    "export mat": ("export", "quickstart", "--to", "mat", "--what", "rig", "--out", f"{OUT}/rig.mat"),
    "export fmu": ("export", "quickstart", "--to", "fmu2", "--what", "damper", "--out", f"{OUT}/damper.fmu"),
    "describe": ("describe", "bouc_wen", "--picture", f"{OUT}/bouc_wen.png"),
    "blind make": ("blind", "make", "--cases", "1", "--seed", "1", "--sealed", f"{OUT}/sealed", "--out", f"{OUT}/set"),
}  # fmt: skip


MADE: Mapping[str, Sequence[str]] = {
    "sweep-report": ("sweep", "{sweep}", "--jobs", "1", "--out", "{made}/sweep"),
    "reproduce": ("comfort", str(RECORDING), "--hours", "6", "--out", "{made}/comfort"),
}
"""What makes the input of a command, once."""


def main() -> None:
    """Start this file again with the library preloaded, or, where it is, fail the calls of each command."""
    options = argparse.ArgumentParser()
    options.add_argument("--only", nargs="*", default=list(COMMANDS), help="commands to try")
    options.add_argument("--every", type=int, default=1, help="fail only every so-manieth call")
    asked = options.parse_args()
    if ROOT not in os.environ:
        with tempfile.TemporaryDirectory() as place:
            raise SystemExit(start_again(Path(place), sys.argv[1:]))
    faults = ctypes.CDLL(os.environ[LIBRARY])
    faults.fault_arm.argtypes, faults.fault_count.restype = [ctypes.c_long], ctypes.c_long
    keep_pictures()
    broken = [f"{name}: {problem}" for name in asked.only for problem in try_command(name, faults, asked.every)]
    print("\n".join(broken) or "nothing was half-written", flush=True)
    raise SystemExit(bool(broken))


def start_again(place: Path, arguments: Sequence[str]) -> int:
    """Compile the library, run this file in a process that has it, and return its exit status."""
    library = place / "write_faults.so"
    subprocess.run(["cc", "-O1", "-shared", "-fPIC", "-o", library, HERE / "write_faults.c", "-ldl"], check=True)
    environment = os.environ | {ROOT: str(place / "results"), LIBRARY: str(library), "LD_PRELOAD": str(library)}
    return subprocess.run([sys.executable, __file__, *arguments], env=environment, check=False).returncode


def keep_pictures() -> None:
    """Have each picture of a command drawn once: the k-th of a later run takes what the k-th of the first drew."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    plain: Callable[[Any], None] = FigureCanvasAgg.draw

    def draw(canvas: Any) -> None:
        place, size = PICTURES.number, (*canvas.figure.bbox.size, canvas.figure.dpi)
        PICTURES.number += 1
        if place < len(PICTURES.drawn) and PICTURES.drawn[place][0] == size:
            canvas.renderer = PICTURES.drawn[place][1]
            return
        plain(canvas)
        PICTURES.drawn[place:] = [(size, canvas.renderer)]

    FigureCanvasAgg.draw = draw  # type: ignore[method-assign]


@dataclass
class Pictures:
    """The pictures of the command that is tried, by their order, and how many of them a run has drawn so far."""

    drawn: list[tuple[Any, Any]]
    number: int = 0


PICTURES = Pictures([])


def try_command(name: str, faults: ctypes.CDLL, every: int = 1) -> list[str]:
    """Return what is wrong after each call of a command has failed once."""
    root = Path(os.environ[ROOT])
    problems = []
    PICTURES.drawn.clear()
    for is_replaced in (False, True):
        reset(root, {})
        if (said := run(name, root, faults, 0)) is not None:
            return [f"fails without a fault: {said}"]
        whole = contents(root)
        before = dict.fromkeys(whole, b"of an earlier command") if is_replaced and name in REPLACING else {}
        if is_replaced and not before:
            continue
        reset(root, before)
        run(name, root, faults, 0)
        calls = int(faults.fault_count())
        for number in range(1, calls + 1, every):
            reset(root, before)
            said = run(name, root, faults, number)
            if said is not None and not said.startswith("RAISED") and name in KEEPING:
                said = run(name, root, faults, 0, KEEPING[name])
            problem = judge(said, contents(root), before, set(whole))
            if problem:
                problems.append(f"call {number} of {calls}{' over old files' * is_replaced}: {problem}")
        tried = len(range(1, calls + 1, every))
        print(
            f"{name}{', over old files' * is_replaced}: {tried} of {calls} calls failed, {len(problems)} problems",
            flush=True,
        )
    return problems


REPLACING = (
    "gap",
    "comfort",
    "run",
    "compare",
    "sweep-report",
    "reproduce",
    "synthesise",
    "characterise",
    "seat-test",
    "diagnose",
    "import",
)
"""Commands that write over the results of an earlier one."""
KEEPING: Mapping[str, Sequence[str]] = {"sweep": ("--resume",), "identify": (), "blind make": ()}
"""Commands whose finished parts stay when they fail, and with which options they are gone on with."""


def judge(said: str | None, found: Mapping[str, bytes], before: Mapping[str, bytes], whole: set[str]) -> str | None:
    """Return what is wrong with a folder after a failure, None where nothing is."""
    old = {file for file, content in found.items() if before.get(file) == content}
    hidden = [file for file in found if any(part.endswith(".part") or ".part." in part for part in Path(file).parts)]
    if said is not None and said.startswith("RAISED"):
        return said
    if hidden:
        return f"left {hidden[0]}"
    if said is None:
        return None if set(found) == whole and not old else "succeeded without all of its files"
    return None if set(found) == set(before) == old else f"failed, and left {sorted(set(found) - old) or 'less'}"


def run(name: str, root: Path, faults: ctypes.CDLL, failing: int, more: Sequence[str] = ()) -> str | None:
    """Run a command whose call of the number `failing` fails, with `more` options; return the error it ends with."""
    made = root.parent / "made" / name
    if name in MADE and not made.exists():
        call(MADE[name], root, made, faults, 0)
    return call((*COMMANDS[name], *more), root, made, faults, failing)


def call(words: Sequence[str], root: Path, made: Path, faults: ctypes.CDLL, failing: int) -> str | None:
    """Run a command of these words."""
    from seatsim.cli.app import app
    from seatsim.schema.errors import SeatsimError

    sweep = root.parent / "sweep.yaml"
    sweep.write_text(SWEEP, encoding="utf-8")
    arguments = [word.format(out=root / "out", sweep=sweep, made=made) for word in words]
    said = io.StringIO()
    PICTURES.number = 0
    faults.fault_arm(failing)
    try:
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
            app(arguments, prog_name="seatsim", standalone_mode=False)
    except SeatsimError as error:
        return str(error)
    except Exception as error:
        return f"RAISED {type(error).__name__}: {error}"
    return None


def reset(root: Path, before: Mapping[str, bytes]) -> None:
    """Let the folder hold these files and no others."""
    shutil.rmtree(root, ignore_errors=True)
    root.mkdir()
    for file, content in before.items():
        (root / file).parent.mkdir(parents=True, exist_ok=True)
        (root / file).write_bytes(content)


def contents(root: Path) -> dict[str, bytes]:
    """Return the files below a folder; locks do not count."""
    files = (path for path in root.rglob("*") if path.is_file() and not path.name.startswith(".lock"))
    return {str(path.relative_to(root)): path.read_bytes() for path in files}


if __name__ == "__main__":
    main()
