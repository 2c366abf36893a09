"""Makes a set of cases: recording folders with nothing in them that reveals the label, and the labels sealed.

Every case has its own generator, spawned from the seed, so a set is the same in any order and with any number of
processes. While it is unfinished, seed, key, labels and unseen runs lie in `SEALED.partial`, readable by the owner
alone, so that a call that was broken off goes on; that folder is deleted when the file is sealed.
"""

import hashlib
import io
import json
import os
import secrets
import shutil
import struct
import zlib
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.random import Generator

from seatsim.blind.make.cases import CaseSpecification, compose, draw_case
from seatsim.blind.sealed import SEAL, Label, Sealed, key_of, new_key, seal
from seatsim.blind.truth.excitation import colour_noise
from seatsim.blind.truth.experiment import CHANNELS, Experiment, Readings, RunPlan
from seatsim.schema.errors import InputError
from seatsim.schema.fields import read_packaged
from seatsim.schema.files import make_folder, write_bytes, write_text, write_together
from seatsim.schema.processes import Progress, run_jobs
from seatsim.schema.yaml_text import dump

_EPOCH = 1_600_000_000
"""Time stamp of every file, s: the true time would reveal how long its case took to draw."""
_GZIP = b"\x1f\x8b\x08" + bytes(6) + b"\xff"
"""Head of a gzip file without time and system."""
_BLOCK = 0xFFFF
"""Most bytes of a stored block."""
_SYMBOLS = read_packaged(Path(__file__).with_name("nominal.yaml"), dict[str, dict[str, str]])
"""Symbols of the true rig by the names of the nominal's plant, and of those of each damper's parameters."""


def nominal_scenario(experiment: Experiment) -> dict[str, object]:
    """Return the nominal scenario, which the owner assumes, under the contract's keys."""
    n, model = experiment.nominal, "bingham" if experiment.is_bingham else "bouc_wen"
    parameters = {name: n[symbol] for name, symbol in _SYMBOLS[model].items()}
    return {
        "plant": {name: n[symbol] for name, symbol in _SYMBOLS["plant"].items() if symbol in n},
        "damper": {"model": model, "parameters": parameters | ({} if experiment.is_bingham else {"n": int(n["n"])})},
        "actuator": {"rate": n["rate"], "max_current": n["i_max"]},
        "temperature": 20.0,
        "controller": {"law": "replay"},
        "excitation": {"kind": "recording"},
    }


def recording_header(experiment: Experiment, runs: Sequence[RunPlan]) -> dict[str, object]:
    """Return the content of `recording.yaml`."""
    noise = {name: {"noise_rms": rms} for name, rms in experiment.noise.items()}
    recorded = [name for name in CHANNELS if name in experiment.channels]
    repeats = {run.name: {"repeat_of": run.repeat_of} for run in runs if run.repeat_of}
    entries = [{"name": run.name, "file": f"{run.name}.csv.gz"} | repeats.get(run.name, {}) for run in runs]
    return {
        "rig": "seat",
        "sample_rate": experiment.sample_rate,
        "parameter_tolerance": experiment.tolerance,
        "nominal": "nominal.yaml",
        "runs": entries,
        "channels": {name: {"unit": CHANNELS[name].unit} | noise.get(name, {}) for name in recorded},
    }


def add_noise(experiment: Experiment, readings: Readings, rng: Generator) -> Readings:
    """Return the recorded channels with noise of the stated rms, white or of the channel's colour.

    Channels that are not recorded take their numbers of the generator too, so that the others' noise is the same.
    """
    noisy = {}
    for name in CHANNELS:
        noise = rng.standard_normal(readings[name].size)
        if name in experiment.channels:
            colour = experiment.colours.get(name)
            unit = noise if colour is None else colour_noise(noise, colour, experiment.sample_rate)
            noisy[name] = readings[name] + experiment.noise.get(name, 0.0) * unit
    return noisy


def encode_table(columns: Readings, formats: Sequence[str]) -> bytes:
    """Return a run as a gzipped CSV whose bytes depend on nothing but the numbers; a format for each column."""
    text = io.StringIO()
    np.savetxt(text, np.column_stack(list(columns.values())), list(formats), ",", header=",".join(columns), comments="")
    return _store(text.getvalue().encode())


def _store(content: bytes) -> bytes:
    """Return a gzip file (RFC 1952) of stored blocks: what is compressed depends on the library that does it."""
    starts = range(0, len(content), _BLOCK)
    blocks = [content[start : start + _BLOCK] for start in starts]
    packed = [
        struct.pack("<BHH", start + _BLOCK >= len(content), len(block), len(block) ^ _BLOCK) + block
        for start, block in zip(starts, blocks, strict=True)
    ]
    return b"".join([_GZIP, *packed, struct.pack("<II", zlib.crc32(content), len(content))])


def encode_yaml(value: Mapping[str, object]) -> bytes:
    """Return a mapping as YAML."""
    return dump(value, line_each=True).encode()


def encode_recording(
    experiment: Experiment, readings: Sequence[Readings], rng: Generator, runs: Sequence[int]
) -> dict[str, bytes]:
    """Return the files of a recording folder that holds these runs, by name; the noise is drawn run by run."""
    plans = [experiment.runs[k] for k in runs]
    files = {"recording.yaml": encode_yaml(recording_header(experiment, plans))}
    files |= {"nominal.yaml": encode_yaml(nominal_scenario(experiment))}
    rate = experiment.sample_rate
    for k, plan in zip(runs, plans, strict=True):
        noisy = add_noise(experiment, readings[k], rng)
        time = np.arange(next(iter(noisy.values())).size) / rate
        formats = ["%.3f" if 1000.0 % rate == 0.0 else "%.9f", *(f"%.{CHANNELS[name].digits}f" for name in noisy)]
        files[f"{plan.name}.csv.gz"] = encode_table({"time": time, **noisy}, formats)
    return files


def write_folder(folder: Path, files: Mapping[str, bytes]) -> None:
    """Write a folder, whole or not at all; its time stamps do not reveal how long a draw took.

    Raises:
        InputError: it cannot be written. OutputError: the disk is full.
    """

    def fill(part: Path) -> list[Path]:
        for name, content in files.items():
            (part / name).write_bytes(content)
            os.utime(part / name, (_EPOCH, _EPOCH))
        os.utime(part, (_EPOCH, _EPOCH))
        return [part / name for name in files]

    write_together(folder, fill)


Wanted = TypeVar("Wanted")
PUBLIC_CASES, _PUBLIC_KINDS = 60, "varied"
"""Cases of a public set, and what they are."""
_LABEL_DIGITS = 9
"""Significant digits of the numbers of a label; the later ones differ between processors."""


class CaseFiles(NamedTuple):
    """A case as it is written: files of its recording and of the unseen one, by name, and its label."""

    recording: dict[str, bytes]
    unseen: dict[str, bytes]
    label: Label


_Draw = Callable[[Wanted, Generator], CaseFiles]
"""Draws a case of what is wanted; it must be picklable, for other processes."""


class _Plan(NamedTuple):
    """What was asked for, and what makes the set; the content of `state.json`."""

    cases: int
    kinds: str | list[str]
    seed: int
    key: str
    given: bool
    """Whether the seed was given; otherwise it was drawn."""


def make(
    cases: int,
    seed: int | None,
    out: str | Path,
    sealed: str | Path,
    progress: Progress | None = None,
    kinds: str | list[str] = "mixed",
    processes: int = 2,
    name: str | None = None,
) -> str:
    """Write a set on simulated rigs; return the key.

    `kinds` is a preset (`mixed`, `varied`) or a kind (none, one, two, outside), or kinds that are gone through in turn.
    With a `name` it is a public set, or its first `cases`, and the name fixes everything, the key too: 60 cases of the
    kinds `varied`, whose bytes are the same everywhere. Whoever makes it can read its labels, so that it compares
    programs and proves nothing of one that was fitted to it. The rest is that of `make_set`.

    Raises:
        InputError: fewer than one case, more than a public set has, an unknown preset, a folder or file that is another
            set's.
    """
    drawn, key = cases, None
    if name is not None:
        drawn, kinds, key = PUBLIC_CASES, _PUBLIC_KINDS, key_of(name)
        seed = int.from_bytes(hashlib.sha256(name.encode()).digest())
        if cases > PUBLIC_CASES:
            raise InputError(f"--cases {cases}: a public set has {PUBLIC_CASES} cases; give another name for others")

    def order(seed: int) -> Sequence[CaseSpecification]:
        return compose(drawn, kinds, np.random.default_rng(np.random.SeedSequence(seed).spawn(1)[0]))

    return make_set(cases, seed, kinds, Path(out), Path(sealed), order, draw_files, progress, processes, key)


def make_set(
    cases: int,
    seed: int | None,
    kinds: str | list[str],
    folder: Path,
    target: Path,
    order: Callable[[int], Sequence[Wanted]],
    draw: _Draw[Wanted],
    progress: Progress | None,
    processes: int,
    key: str | None = None,
) -> str:
    """Write `folder`/case-0001/... and the sealed file `target`; return the key, which is stored nowhere.

    Without `key` one is made; without `seed` one is drawn and sealed. `order` returns what each case is to be, by seed.
    A call broken off goes on where it stopped. `progress` is called with the cases done and all cases.

    Raises:
        InputError: fewer than one case, a folder or file that is another set's, or what `order` and `draw` raise.
    """
    partial = target.with_name(f"{target.name}.partial")
    if target.resolve().is_relative_to(folder.resolve()):
        raise InputError(f"{target}: lies inside {folder}; the labels must lie elsewhere than the recordings")
    plan = _begin_or_resume(cases, seed, kinds, folder, target, partial, key)
    wanted = order(plan.seed)
    names = {k: case_name(k) for k in range(cases)}
    todo = [k for k, name in names.items() if not ((folder / name).is_dir() and (partial / f"{name}.json").is_file())]
    done_before = cases - len(todo)
    if progress:
        progress(done_before, cases)
    jobs = [(draw, k, wanted[k], plan.seed, folder, partial) for k in todo]
    run_jobs(make_case, jobs, processes, progress and (lambda done, _: progress(done_before + done, cases)))
    seal(target, folder, plan.key, _gather(plan, partial))
    shutil.rmtree(partial)
    return plan.key


def case_name(k: int) -> str:
    """Return the name of the case with index k."""
    return f"case-{k + 1:04d}"


def _begin_or_resume(
    cases: int, seed: int | None, kinds: str | list[str], folder: Path, target: Path, partial: Path, key: str | None
) -> _Plan:
    """Return the plan of an unfinished set, or begin one."""
    if cases < 1:
        raise InputError(f"--cases {cases}: at least 1")
    note = partial / "state.json"
    if note.is_file():
        plan = _Plan(**json.loads(note.read_text(encoding="utf-8")))
        if (plan.cases, plan.kinds) != (cases, kinds) or seed not in (None, plan.seed):
            raise InputError(f"{partial}: holds an unfinished set made otherwise; delete it, or give another --sealed")
        return plan
    if target.exists() or (folder / SEAL).exists() or any(folder.glob("case-*")):
        raise InputError(f"{folder}: {target} or a set of cases is there already; give another --out and --sealed")
    plan = _Plan(cases, kinds, secrets.randbits(62) if seed is None else seed, key or new_key(), seed is not None)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        partial.mkdir(parents=True, mode=0o700)  # its owner alone can read it, since the key opens the labels
    except OSError as error:
        raise InputError(f"{partial}: cannot be written: {error.strerror}; give another --sealed") from error
    write_text(note, json.dumps(plan._asdict()))
    return plan


def make_case(draw: _Draw[Wanted], k: int, wanted: Wanted, seed: int, folder: Path, partial: Path) -> None:
    """Draw the case with index k of a set and write its recording, its unseen run and, last, its label.

    The label marks the case as finished.
    """
    name = case_name(k)
    case = draw(wanted, np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(1, k))))
    make_folder(partial / name)
    for file, content in case.unseen.items():
        write_bytes(partial / name / file, content)
    if (folder / name).is_dir():
        shutil.rmtree(folder / name)
    write_folder(folder / name, case.recording)
    label = json.loads(json.dumps(case.label), parse_float=lambda text: float(f"{float(text):.{_LABEL_DIGITS}g}"))
    write_text(partial / f"{name}.json", json.dumps(label))


def _gather(plan: _Plan, partial: Path) -> Sealed:
    """Return what is to be sealed of a set whose cases are all finished."""
    names = [case_name(k) for k in range(plan.cases)]
    labels = {name: json.loads((partial / f"{name}.json").read_text(encoding="utf-8")) for name in names}
    unseen = {name: {file.name: file.read_bytes() for file in sorted((partial / name).iterdir())} for name in names}
    made: dict[str, object] = {"seed": plan.seed, "seed_given": plan.given, "cases": plan.cases, "kinds": plan.kinds}
    return Sealed(labels, unseen, made)


def draw_files(specification: CaseSpecification, rng: Generator) -> CaseFiles:
    """Draw a case on a simulated rig, whose last run is the unseen one."""
    case = draw_case(specification, rng)
    last = len(case.experiment.runs) - 1
    recording = encode_recording(case.experiment, case.readings, rng, range(last))
    return CaseFiles(recording, encode_recording(case.experiment, case.readings, rng, [last]), case.label())
