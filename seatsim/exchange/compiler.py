"""The C compiler of the system, which makes libraries of what is printed."""

from __future__ import annotations

import os
import shlex
import shutil
import subprocess
from pathlib import Path

from seatsim.schema.errors import InputError, RunError

FLAGS = ("-std=c99", "-O2", "-fPIC", "-shared", "-fvisibility=hidden", "-ffp-contract=off")
"""Without `-ffp-contract=off` a compiler may fuse products and sums, and results would differ between machines."""
_QUICK = ("-fno-math-errno", "-fno-trapping-math", "-fschedule-insns", "-fsched-pressure")
"""Nothing reads `errno` or the flags of floating-point exceptions, instructions may be moved: results stay the same."""
_PERMITTED = """
exp expm1 log pow sqrt sin cos tan atan atan2 tanh sinh cosh hypot fabs floor ceil fmod copysign
memcpy memset memmove malloc calloc free strcmp strcpy strlen snprintf __stack_chk_fail __snprintf_chk
_ITM_deregisterTMCloneTable _ITM_registerTMCloneTable __cxa_finalize __gmon_start__
"""
"""What a library may take from outside: functions of C's own library."""


def find_compiler() -> str:
    """Return the path of the C compiler: that of the variable CC, or cc, gcc or clang.

    Raises:
        InputError: there is none, or not the one that CC names.
    """
    chosen = _read_choice()[:1]
    for name in chosen or ("cc", "gcc", "clang"):
        found = shutil.which(name)
        if found:
            return found
    if chosen:
        raise InputError(
            f"the variable CC names '{chosen[0]}', and there is no such program; name a C compiler, or none"
        )
    raise InputError(
        "an FMU is compiled, and this machine has no C compiler: install gcc or clang (Debian: apt install gcc),"
        " or name one by CC; '--to c' needs none"
    )


def _read_choice() -> list[str]:
    """Return the words of the variable CC: a compiler, and flags that every use of it has."""
    stated = os.environ.get("CC", "")
    try:
        return shlex.split(stated)
    except ValueError as error:
        raise InputError(f"the variable CC is {stated!r}: {error}; state a compiler and its flags") from error


def compile_library(source: Path, library: Path) -> None:
    """Compile a C file into a shared library.

    Raises:
        InputError: there is no compiler.
        RunError: it refused the source, or the library would need more than C's own library.
    """
    command = [find_compiler(), *_read_choice()[1:], *FLAGS, *_QUICK, "-o", str(library), str(source), "-lm", "-s"]
    # Its own temporary files stand beside the library, whose folder is removed also where the export is interrupted.
    own = os.environ | dict.fromkeys(("TMPDIR", "TMP", "TEMP"), str(library.parent))
    done = subprocess.run(command, capture_output=True, text=True, check=False, env=own)
    if done.returncode:
        raise RunError(f"{command[0]} could not compile {source.name}: {done.stderr.strip()[:500]}")
    foreign = _undefined_symbols(library) - set(_PERMITTED.split())
    if foreign:
        raise RunError(f"{source.name} needs what C's own library has not: {', '.join(sorted(foreign))}")


def _undefined_symbols(library: Path) -> set[str]:
    """Return the functions that a library takes from outside; empty where the system has no `nm`."""
    if shutil.which("nm") is None:
        return set()
    done = subprocess.run(["nm", "-D", "-u", str(library)], capture_output=True, text=True, check=False)
    return {line.split()[-1].partition("@")[0] for line in done.stdout.splitlines() if line.split()}
