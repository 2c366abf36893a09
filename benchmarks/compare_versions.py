"""Compare what two installed versions of seatsim write: `python benchmarks/compare_versions.py OLD_PYTHON NEW_PYTHON`.

Every recording below the folders of `--recordings` is diagnosed and every scenario below the folder of `--scenarios`
is run by both versions. Outputs lie in `OUT/{old,new}/diagnoses/RECORDING` and `OUT/{old,new}/runs/SCENARIO`; what is
there already is not computed again. In `diagnosis.json` verdict, selected, where and gap must agree to 1e-9;
`summary.json` and the values of `history.parquet` must agree in every bit. A command that fails in both versions with
the same message counts as agreement. Printed is a line for each input with its largest difference; the exit status is 1
where a value differs that must not.

`--time` takes the wall-clock time of commands in alternation instead: `--time "run quickstart" --pairs 5`.
"""

from __future__ import annotations

import argparse
import os
import statistics
import sys
import tempfile
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from pathlib import Path

from output_differences import Difference, differences
from rich.console import Console
from rich.table import Table
from version_outputs import Task, Version, compute, diagnosis_tasks, installed, run_tasks, seconds

Found = dict[str, list[Difference]]
"""Differences by the name of a task."""
WIDTH = 60
"""Characters of a value that are shown."""


def main() -> None:
    """Compare, or time, and print."""
    options = _options()
    old, new = (
        installed(python, options.out.absolute() / side)
        for python, side in ((options.old, "old"), (options.new, "new"))
    )
    if options.time:
        _show_times(old, new, options.time, options.pairs)
        return
    tasks = diagnosis_tasks(options.recordings) + (run_tasks(options.scenarios) if options.scenarios else [])
    _compute_missing((old, new), tasks, options.jobs)
    found = {task.name: differences(old.folder / task.name, new.folder / task.name) for task in tasks}
    _show(found)
    sys.exit(any(difference.required for several in found.values() for difference in several))


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument(
        "old", type=Path, metavar="OLD_PYTHON", help="interpreter that the old version is installed for"
    )
    parser.add_argument(
        "new", type=Path, metavar="NEW_PYTHON", help="interpreter that the new version is installed for"
    )
    parser.add_argument("--recordings", type=Path, nargs="+", default=[], metavar="DIR", help="folders with recordings")
    parser.add_argument("--scenarios", type=Path, metavar="DIR", help="folder with scenarios")
    parser.add_argument("--out", type=Path, default=Path("out/versions"), metavar="DIR", help="where outputs are kept")
    parser.add_argument("--jobs", type=int, default=1, help="commands that run at once")
    parser.add_argument(
        "--time", action="append", metavar="COMMAND", help="a command to time, such as 'run quickstart'"
    )
    parser.add_argument("--pairs", type=int, default=5, help="timed pairs of runs of each command")
    return parser.parse_args()


def _compute_missing(versions: Sequence[Version], tasks: Sequence[Task], jobs: int) -> None:
    """Let both versions write the outputs that are not there yet, `jobs` commands at once."""
    # Threads suffice: each waits for a process of its own.
    with ThreadPoolExecutor(jobs) as pool:
        missing = [(version, task) for task in tasks for version in versions if not task.is_done(version)]
        futures = [pool.submit(compute, version, task) for version, task in missing]
        for done, future in enumerate(as_completed(futures), 1):
            print(f"{done}/{len(futures)} {future.result()}", file=sys.stderr, flush=True)


def _show(found: Found) -> None:
    """Print a line for each input, then what else differs without counting as a failure."""
    _table("outputs of two versions", {name: [d for d in several if d.required] for name, several in found.items()})
    others = {name: [d for d in several if not d.required] for name, several in found.items()}
    _table("other keys of diagnosis.json that differ", {name: several for name, several in others.items() if several})


def _table(title: str, found: Found) -> None:
    """Print how many values of each input differ and the one that differs most; nothing for no inputs."""
    if not found:
        return
    table = Table("input", "differ", "largest", "where", "old", "new", title=title, title_justify="left")
    for name, several in found.items():
        if not several:
            table.add_row(name, "identical")
            continue
        largest = several[0]
        values = (largest.path, largest.old[:WIDTH], largest.new[:WIDTH])
        table.add_row(name, str(len(several)), f"{largest.relative:.1e}", *values)
    Console(width=None if sys.stdout.isatty() else 200, markup=False).print(table)


def _show_times(old: Version, new: Version, commands: Sequence[str], pairs: int) -> None:
    """Print the ratio new / old of the wall-clock times of commands, each timed in pairs after one that is not counted.

    The order within a pair alternates, so that what warms or slows the machine meets both versions alike.
    """
    with tempfile.TemporaryDirectory() as folder:
        for command in commands:
            times: dict[Version, list[float]] = {old: [], new: []}
            for pair in range(-1, pairs):
                for version in (old, new) if pair % 2 else (new, old):
                    time = seconds(version, command.split(), Path(folder) / "out")
                    # The first pair compiles.
                    times[version] += [time] * (pair >= 0)
            ratios = [b / a for a, b in zip(times[old], times[new], strict=True)]
            spread = f"{min(ratios):.3f} to {max(ratios):.3f}"
            print(
                f"{command}: old {statistics.median(times[old]):.2f} s, new {statistics.median(times[new]):.2f} s, ",
                end="",
            )
            print(f"new / old {statistics.median(ratios):.3f} (median of {pairs} pairs, {spread})", flush=True)


if __name__ == "__main__":
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    main()
