"""An array script for Slurm, each of whose tasks runs a share of a sweep; it needs nothing but seatsim."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from pathlib import Path

from seatsim.schema.errors import InputError
from seatsim.schema.files import make_folder, write_text
from seatsim.sweeps.parts import part_of
from seatsim.sweeps.plan import Plan

_MOST_TASKS = 256
"""Tasks of an array, well below the 1001 that Slurm permits unless it is configured otherwise."""
SCRIPT = """\
#!/bin/bash
# {runs} runs of {file}, in {tasks} shares. Submit with: sbatch {script}
# A task that ends early goes on where it was when it is submitted again: sbatch --array=NUMBER {script}
#SBATCH --job-name={name}
#SBATCH --array=1-{tasks}
#SBATCH --cpus-per-task=1
#SBATCH --output={logs}
exec {command} --part "$SLURM_ARRAY_TASK_ID/{tasks}" --jobs "${{SLURM_CPUS_PER_TASK:-1}}" --resume
"""


def write_slurm(
    script: Path, file: Path, folder: Path, plan: Plan, keep_histories: bool, own_code: Sequence[Path]
) -> Path:
    """Write the script for a sweep `file` whose rows go to `folder`; paths in it are absolute, and quoted.

    Raises:
        InputError: the script or the folder cannot be written, or a path has a line break, which would end its line.
    """
    for path in (script, file, folder, *own_code):
        if not str(path.resolve()).isprintable():
            raise InputError(
                f"{str(path)!r}: a path in a script for Slurm has no line break or other control character; rename it"
            )
    make_folder(folder)
    words = ["seatsim", "sweep", str(file.resolve()), "--out", str(folder.resolve())]
    words += ["--keep", "histories"] if keep_histories else []
    words += [word for path in own_code for word in ("--with", str(path.resolve()))]
    logs = str(folder.resolve()).replace("%", "%%") + "/slurm-%a.log"  # a single % begins a pattern of Slurm
    names = {"file": file.name, "name": f"seatsim-{file.stem}", "script": str(script), "logs": logs}
    text = SCRIPT.format(
        runs=plan.runs,
        command=shlex.join(words),
        tasks=min(part_of(plan.runs - 1) + 1, _MOST_TASKS),
        **{key: shlex.quote(name) for key, name in names.items()},
    )
    return write_text(script, text)
