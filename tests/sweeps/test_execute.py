"""What a sweep promises: the same rows whatever happens to it, and nothing lost or mixed up in its folder."""

import json
import subprocess
import sys
import time

import pandas as pd
import pytest

import seatsim
from seatsim.metrics.table import METRICS
from seatsim.schema.errors import InputError
from seatsim.sweeps import parts
from seatsim.sweeps.engines import LocalEngine
from seatsim.sweeps.execute import Share
from seatsim.sweeps.folder import hold_folder

from ..text import parse
from .conftest import MASSES, bytes_of

MASS = "plant.driver_mass"


@pytest.fixture
def small_parts(monkeypatch):
    """Make parts of four runs, so that a short sweep has several."""
    monkeypatch.setattr(parts, "RUNS_OF_PART", 4)


def test_rows_hold_state_keys_metrics_and_units(write_sweep, carry_out, tmp_path):
    path = write_sweep(vary={**MASSES, "excitation.spectral_class": ["EM1", "EM5"]}, runs=2)
    result = carry_out(path, keep_histories=True)
    kept = sorted(file.name for file in (tmp_path / "out" / "histories").iterdir())
    assert kept == [f"run-000000{number}.parquet" for number in range(4)]
    frame = seatsim.read_sweep(tmp_path / "out")
    assert list(frame.columns) == ["run", "state", "reason", "seed", MASS, "excitation.spectral_class", *METRICS]
    assert list(frame.run) == [0, 1, 2, 3] and set(frame.state) == {"done"}
    assert frame.attrs["units"][MASS] == "kg" and frame.attrs["units"]["driver_vdv"] == "m/s^1.75"
    assert result.counts == {"runs": 4, "done": 4, "failed": 0, "unverified": 0, "pending": 0}
    manifest = json.loads((tmp_path / "out" / "manifest.json").read_text())
    assert set(manifest) >= {"identity", "versions", "seed", "counts"} and manifest["seed"] == 3


def test_damaged_parts_those_of_different_sweeps_and_foreign_tables_are_named(write_sweep, carry_out, tmp_path):
    carry_out(write_sweep(vary=MASSES, runs=2))
    (part,) = (tmp_path / "out" / "runs").iterdir()
    content, other = part.read_bytes(), pd.read_parquet(part)
    for damaged in (b"PAR1 and no rows", b""):
        part.write_bytes(damaged)
        with pytest.raises(InputError, match=r"part-000000\.parquet: is no part of a sweep"):
            seatsim.read_sweep(tmp_path / "out")
    for missing in ("state", "driver_vdv"):
        other.drop(columns=missing).to_parquet(part)
        with pytest.raises(InputError, match=f"is no part of a sweep: .*{missing}"):
            seatsim.read_sweep(tmp_path / "out")
    part.write_bytes(content)
    other.drop(columns=MASS).to_parquet(part.with_name("part-000001.parquet"))
    with pytest.raises(InputError, match="holds parts of different sweeps"):
        seatsim.read_sweep(tmp_path / "out")


def test_a_row_is_what_the_run_alone_gives(write_sweep, carry_out, tmp_path, seat_file):
    carry_out(write_sweep(vary={MASS: [55.0, 98.0]}, runs=None, replicates=2))
    frame = seatsim.read_sweep(tmp_path / "out")
    for row in frame.itertuples():
        mass, settings = frame.loc[row.run, MASS], {"excitation.duration": 0.5, "seed": row.seed}
        alone = seatsim.run(seat_file, {**settings, MASS: mass}).runs[0].metrics
        assert {name: frame.loc[row.run, name] for name in alone} == {name: m.value for name, m in alone.items()}


def test_jobs_shares_and_interruptions_give_the_same_bytes(write_sweep, carry_out, tmp_path, small_parts):
    path = write_sweep(runs=11)
    carry_out(path, "one", LocalEngine(1))
    carry_out(path, "two", LocalEngine(2, worth_a_process=1e-9))
    for number in (2, 1):
        carry_out(path, "shared", share=Share(number, 2), resume=True)

    def stop(done, runs):
        if done >= 6:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        carry_out(path, "stopped", progress=stop)
    before = seatsim.read_sweep(tmp_path / "stopped")
    assert 6 <= len(before) < 11
    assert json.loads((tmp_path / "stopped" / "manifest.json").read_text())["counts"]["pending"] == 11 - len(before)
    carry_out(path, "stopped", resume=True)
    expected = bytes_of(tmp_path / "one")
    assert len(expected) == 4
    assert all(bytes_of(tmp_path / name) == expected for name in ("two", "shared", "stopped"))


def test_a_failed_run_is_a_row_with_its_reason(write_sweep, carry_out, tmp_path):
    lost = parse("""
        {c_a: 0.0, c_b: 0.0, alpha_a: 0.0, alpha_b: 0.0, k0: -1000000000.0, x0: 0.0, f0: 0.0, A: 1.0, beta: 0.0,
         gamma: 0.0, n: 1.0}
    """)
    sound = {**lost, "c_a": 500.0, "k0": 0.0}
    result = carry_out(write_sweep(vary={"damper.parameters": [sound, lost]}, runs=None))
    frame = seatsim.read_sweep(tmp_path / "out")
    assert list(frame.state) == ["done", "failed"] and "no solution beyond" in frame.reason[1]
    assert frame.seed[0] == frame.seed[1]
    assert frame.loc[1, list(METRICS)].isna().all() and result.failures == [f"run 1: {frame.reason[1]}"]


def test_runs_that_nothing_confirms_are_unverified(write_sweep, carry_out, tmp_path):
    carry_out(write_sweep(vary={"start.velocity": [0.0, 3.0]}, runs=None))
    frame = seatsim.read_sweep(tmp_path / "out")
    assert list(frame.state) == ["done", "unverified"] and "beyond the data behind the model" in frame.reason[1]


CHANGES = [
    ({"seed": 4}, "seed was 3 and is 4"),
    ({"vary": {MASS: {"normal": [81, 12]}}}, "driver_mass.normal was [80, 12] and is [81, 12]"),
    ({"runs": 3}, "runs was 5 and is 3"),
    ({"design": "lhs"}, 'design was "cross" and is "lhs"'),
]


def test_a_change_of_the_sweep_is_refused_by_name(write_sweep, carry_out):
    path = write_sweep()
    carry_out(path)
    with pytest.raises(seatsim.InputError, match="holds a sweep already, 5 of 5 runs"):
        carry_out(path)
    for change, named in CHANGES:
        with pytest.raises(seatsim.InputError) as caught:
            carry_out(write_sweep(**change), resume=True)
        assert named in str(caught.value)
    text = write_sweep().read_text()
    path.write_text(text.replace("frame_mass: 20.0", "frame_mass: 21.0"))
    with pytest.raises(seatsim.InputError, match=r"scenario\.plant\.frame_mass was 20\.0 and is 21\.0"):
        carry_out(path, resume=True)


def test_the_lock_names_its_owner(write_sweep, carry_out, tmp_path):
    code = (
        "import sys, time; from pathlib import Path; from seatsim.sweeps.folder import hold_folder\n"
        "with hold_folder(Path(sys.argv[1])): print('held', flush=True); time.sleep(60)"
    )
    with subprocess.Popen([sys.executable, "-c", code, str(tmp_path / "out")], stdout=subprocess.PIPE) as other:
        other.stdout.readline()
        with pytest.raises(seatsim.InputError, match=f"process {other.pid} on .* works on this sweep"):
            carry_out(write_sweep())
        other.kill()
    assert carry_out(write_sweep(runs=2)).counts["done"] == 2


@pytest.mark.parametrize("name", [".lock", ".lock-manifest", ".lock-1-of-2", "runs", "histories", "manifest.json"])
def test_a_sweep_writes_through_no_link_in_its_folder(name, write_sweep, carry_out, tmp_path):
    victim = tmp_path / "victim"
    (tmp_path / "out").mkdir()
    if name in ("runs", "histories"):
        victim.mkdir()
    else:
        victim.write_text("precious")
    (tmp_path / "out" / name).symlink_to(victim)
    with pytest.raises(seatsim.InputError, match=rf"{name}: is a link, through which nothing is written"):
        carry_out(write_sweep(), share=Share(1, 2) if "of" in name else None)
    assert not list(victim.iterdir()) if victim.is_dir() else victim.read_text() == "precious"


def test_shares_hold_a_folder_together_but_none_twice(tmp_path):
    with hold_folder(tmp_path, "1-of-2"), hold_folder(tmp_path, "2-of-2"):
        for share in ("1-of-2", ""):
            with pytest.raises(seatsim.InputError, match="works on this sweep"), hold_folder(tmp_path, share):
                pass


@pytest.mark.slow
def test_a_sweep_that_is_killed_goes_on_as_if_nothing_had_happened(write_sweep, carry_out, tmp_path):
    path = write_sweep(runs=400)
    command = [sys.executable, "-m", "seatsim", "sweep", str(path), "--out", str(tmp_path / "killed"), "--jobs", "1"]
    with subprocess.Popen(command) as process:
        while process.poll() is None and not list(tmp_path.glob("killed/runs/part-*.parquet")):
            time.sleep(0.01)
        process.kill()
    before = seatsim.read_sweep(tmp_path / "killed")
    assert 0 < len(before) < 400
    assert carry_out(path, "killed", resume=True).counts["done"] == 400
    carry_out(path, "whole")
    assert bytes_of(tmp_path / "killed") == bytes_of(tmp_path / "whole")
