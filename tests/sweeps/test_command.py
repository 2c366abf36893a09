"""The commands: what they print and write, engines that are not there, scripts for clusters."""

import json
import os
import re
import shlex
import subprocess
import sys

import pytest

import seatsim
from seatsim.sweeps import parts

from ..answers import check_answer
from .conftest import MASSES, bytes_of


def test_a_sweep_and_its_report(write_sweep, tmp_path, seatsim_command):
    stiffness = {"plant.suspension_stiffness": {"uniform": [4000, 5000]}}
    vary = {**MASSES, **stiffness, "excitation.spectral_class": ["EM1", "EM5"]}
    path, out = write_sweep(vary=vary, runs=12, limits={"driver_acceleration_weighted": 0.1}), tmp_path / "out"
    status, text, _ = seatsim_command("check", path)
    assert status == 0 and "sweep, no errors; 24 runs over plant.driver_mass" in text
    status, text, _ = seatsim_command("sweep", path, "--jobs", "1", "--out", out, "--json")
    found = check_answer("sweep", text)
    assert status == 0 and found["counts"]["done"] == 24 and found["failed"] == []
    assert json.loads((out / "manifest.json").read_text()).items() <= found.items()
    status, text, _ = seatsim_command("sweep-report", out, "--json")
    content = check_answer("sweep-report", text)
    assert status == 0 and re.search("Of 2 varied keys plant.* matters most to the driver Wk RMS", content["sentence"])
    assert {row["group"]["excitation.spectral_class"] for row in content["exceeded"]} == {"EM1", "EM5"}
    page = (out / "report.html").read_text()
    links = re.findall('(?:href|src)="([^"]*)"', page)
    assert len(page) < 600_000 and all(link.startswith(("#", "data:image/svg+xml,")) for link in links)
    table = (out / "table.csv").read_text().splitlines()
    assert table[0].startswith("excitation.spectral_class,metric,unit,runs,mean") and len(table) > 20
    assert (out / "sensitivity.csv").read_text().startswith("metric,key,first,first_low")


def test_what_is_wrong_is_one_sentence(write_sweep, tmp_path, seatsim_command, monkeypatch):
    path, out = write_sweep(runs=2), tmp_path / "out"
    wrong = {"--address tcp://here:1": "add --engine dask", "--part 3/2": "write K/N with K from 1 to N"}
    for option, sentence in wrong.items():
        status, _, err = seatsim_command("sweep", path, "--out", out, *option.split())
        assert status == 2 and sentence in err and not out.exists()
    monkeypatch.setitem(sys.modules, "distributed", None)
    status, _, err = seatsim_command("sweep", path, "--out", out, "--engine", "dask")
    assert status == 2 and 'pip install "seatsim[cluster]"' in err and not out.exists()
    status, _, err = seatsim_command("sweep-report", tmp_path)
    assert status == 2 and "holds no sweep" in err
    status, _, err = seatsim_command("run", path)
    assert status == 2 and f"seatsim sweep {path}" in err
    monkeypatch.setitem(sys.modules, "fcntl", None)
    status, _, err = seatsim_command("sweep", path, "--out", out)
    assert status == 2 and "flock, which this system has not" in err


def test_failed_runs_end_with_status_1(write_sweep, tmp_path, seatsim_command):
    path = write_sweep(vary={"controller.sample_time": [0.005, 0.0052]}, runs=None)
    status, out, err = seatsim_command("sweep", path, "--out", tmp_path / "out")
    assert status == 1 and "1 done, 1 failed" in out and "failed: run 1: " in err and "choose 0.005 s" in err


def test_names_in_a_script_for_slurm_are_quoted_or_refused(write_sweep, tmp_path, seatsim_command):
    folder, mark = tmp_path / "my $(touch mark) 'rows' 5%a", tmp_path / "mark"
    path = write_sweep().rename(tmp_path / "a sweep --wrap=x.yaml")
    status, _, _ = seatsim_command("sweep", path, "--out", folder, "--slurm", tmp_path / "array 1.sh")
    lines = (tmp_path / "array 1.sh").read_text().splitlines()
    options = [shlex.split(line.removeprefix("#SBATCH ")) for line in lines if line.startswith("#SBATCH")]
    assert status == 0 and all(len(option) == 1 for option in options)
    assert options[0] == ["--job-name=seatsim-a sweep --wrap=x"]
    assert options[-1] == [f"--output={str(folder).replace('%', '%%')}/slurm-%a.log"]
    assert shlex.split(lines[-1])[3:6] == [str(path), "--out", str(folder)] and not mark.exists()


@pytest.mark.parametrize("bad", ["file", "out", "script"])
def test_a_line_break_in_a_name_is_refused_for_slurm(bad, write_sweep, tmp_path, seatsim_command):
    line = "x\ntouch mark"
    path = write_sweep()
    path = path.rename(tmp_path / f"{line}.yaml") if bad == "file" else path
    out = tmp_path / (line if bad == "out" else "out")
    script = tmp_path / (line if bad == "script" else "array.sh")
    before = sorted(tmp_path.iterdir())
    status, _, err = seatsim_command("sweep", path, "--out", out, "--slurm", script)
    assert status == 2 and "line break" in err and sorted(tmp_path.iterdir()) == before


PROGRAM = """\
#!/bin/sh
exec "{python}" -c 'from seatsim.sweeps import parts; parts.RUNS_OF_PART = 4
from seatsim.cli.begin import begin; begin()' "$@"
"""
"""A command `seatsim` that makes small parts."""


def test_the_tasks_of_a_script_make_the_sweep(write_sweep, tmp_path, seatsim_command, monkeypatch):
    monkeypatch.setattr(parts, "RUNS_OF_PART", 4)
    path, script = write_sweep(runs=7), tmp_path / "array.sh"
    status, _, _ = seatsim_command("sweep", path, "--out", tmp_path / "array", "--slurm", script)
    assert status == 0 and "#SBATCH --array=1-2\n" in script.read_text()
    command = tmp_path / "bin" / "seatsim"
    command.parent.mkdir()
    command.write_text(PROGRAM.format(python=sys.executable))
    command.chmod(0o755)
    environment = {**os.environ, "SLURM_ARRAY_TASK_ID": "2", "PATH": f"{command.parent}:{os.environ['PATH']}"}
    subprocess.run(["bash", script], env=environment, check=True)
    assert seatsim_command("sweep", path, "--out", tmp_path / "array", "--part", "1/2", "--resume")[0] == 0
    assert seatsim_command("sweep", path, "--jobs", "1", "--out", tmp_path / "alone")[0] == 0
    assert bytes_of(tmp_path / "array") == bytes_of(tmp_path / "alone")
    assert json.loads((tmp_path / "array" / "manifest.json").read_text())["counts"]["done"] == 7
    assert len(seatsim.read_sweep(tmp_path / "array")) == 7


def test_an_engine_that_cannot_be_reached_leaves_nothing(write_sweep, tmp_path, seatsim_command, monkeypatch):
    pytest.importorskip("distributed")
    from seatsim.sweeps import cluster

    monkeypatch.setattr(cluster, "LONGEST_SEARCH", 0.3)
    options = ["--engine", "dask", "--address", "tcp://127.0.0.1:9"]
    status, _, err = seatsim_command("sweep", write_sweep(), "--out", tmp_path / "out", *options)
    assert status == 2 and "no dask scheduler answers there" in err and not (tmp_path / "out").exists()
