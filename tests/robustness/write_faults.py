"""A full disk at every moment: each call that writes fails once, and nothing may be half-written.

    python tests/robustness/write_faults.py

Each command runs once as it is, which counts its calls of open, write, fsync, mkdir, link and rename below the folder
of its results. Then it runs as often again, and the n-th of these calls fails as on a full disk. Afterwards it must
have ended with one error or have succeeded, and the folder must hold all of its new files or all that it held before,
and nothing else.

A shared library, compiled with `cc` and preloaded, fails the calls, since Python, pyarrow and matplotlib write in
different ways. Linux alone.
"""

import contextlib
import ctypes
import io
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
RECORDING = HERE.parents[1] / "scenarios" / "data" / "recording"
ROOT, LIBRARY = "FAULT_ROOT", "FAULT_LIBRARY"
COMMANDS = {
    "gap": ("gap", RECORDING / "nominal.yaml", RECORDING, "--out", "{out}"),
    "new recording": ("new", "recording", "{out}/rig"),
}
REPLACING = ("gap",)
"""Commands that write over the results of an earlier one."""


def start_again(place):
    """Compile the library, run this file in a process that has it, and return its exit status."""
    library = place / "write_faults.so"
    subprocess.run(["cc", "-O1", "-shared", "-fPIC", "-o", library, HERE / "write_faults.c", "-ldl"], check=True)
    environment = os.environ | {ROOT: str(place / "results"), LIBRARY: str(library), "LD_PRELOAD": str(library)}
    return subprocess.run([sys.executable, __file__], env=environment, check=False).returncode


def try_command(name, before, root, faults):
    """Return what is wrong after each call of a command has failed once, over the files of an earlier one."""
    reset(root, before)
    if (said := call(name, root, faults, 0)) is not None:
        return [f"fails without a fault: {said}"]
    calls, whole = int(faults.fault_count()), set(contents(root))
    problems = []
    for number in range(1, calls + 1):
        reset(root, before)
        if problem := judge(call(name, root, faults, number), contents(root), before, whole):
            problems.append(f"call {number} of {calls}: {problem}")
    print(f"{name}: {calls} calls failed, {len(problems)} problems", flush=True)
    return problems


def judge(said, found, before, whole):
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


def call(name, root, faults, failing):
    """Run a command whose call of the number `failing` fails; return the error it ends with."""
    from seatsim.cli.app import app
    from seatsim.schema.errors import SeatsimError

    arguments = [str(word).format(out=root / "out") for word in COMMANDS[name]]
    faults.fault_arm(failing)
    try:
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
            app(arguments, prog_name="seatsim", standalone_mode=False)
    except SeatsimError as error:
        return str(error)
    except Exception as error:
        return f"RAISED {type(error).__name__}: {error}"
    return None


def reset(root, before):
    """Let the folder hold these files and no others."""
    shutil.rmtree(root, ignore_errors=True)
    root.mkdir()
    for file, content in before.items():
        (root / file).parent.mkdir(parents=True, exist_ok=True)
        (root / file).write_bytes(content)


def contents(root):
    """Return the files below a folder; locks do not count."""
    files = (path for path in root.rglob("*") if path.is_file() and not path.name.startswith(".lock"))
    return {str(path.relative_to(root)): path.read_bytes() for path in files}


def main():
    """Start this file again with the library preloaded, or, where it is, fail the calls of each command."""
    if ROOT not in os.environ:
        with tempfile.TemporaryDirectory() as place:
            return start_again(Path(place))
    root, faults = Path(os.environ[ROOT]), ctypes.CDLL(os.environ[LIBRARY])
    faults.fault_arm.argtypes, faults.fault_count.restype = [ctypes.c_long], ctypes.c_long
    broken = []
    for name in COMMANDS:
        broken += try_command(name, {}, root, faults)
        if name in REPLACING:
            reset(root, {})
            call(name, root, faults, 0)
            broken += try_command(name, dict.fromkeys(contents(root), b"of an earlier command"), root, faults)
    print("\n".join(broken) or "nothing was half-written", flush=True)
    return bool(broken)


if __name__ == "__main__":
    raise SystemExit(main())
