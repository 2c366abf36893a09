"""Options that several commands share: what is refused, where the error points, and before what."""

import subprocess
import sys

import pytest

import seatsim

HEAVY = {"numpy", "pandas", "scipy", "numba", "pydantic", "matplotlib", "pyarrow", "control", "cvxpy"}


def test_nothing_heavy_is_imported_at_the_start():
    code = "import sys, seatsim.cli.app; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, encoding="utf-8", check=True)
    assert not HEAVY & set(done.stdout.split())


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("plant.driver_mass=-5", "--set plant.driver_mass=-5, plant.driver_mass: -5 is not permitted"),
        ("plant.drivermass=5", "--set plant.drivermass=5, plant.drivermass: unknown key (did you mean 'driver_mass'?)"),
        ("excitation.kind=raod", "excitation.kind: no excitation is called 'raod' (did you mean 'road'?)"),
        ("excitation={kind: raod}", '--set excitation={"kind": "raod"}, excitation.kind: no excitation'),
        ("seed.x=3", "--set seed.x=3: 'seed.x' leads into 'seed', which has no keys"),
        ("variants={a: {plant.driver_mass: -5}}", "driver_mass\": -5}}, variant 'a', plant.driver_mass: -5 is not"),
    ],
)
def test_an_error_of_set_names_the_option_and_not_the_file(text, problem, seatsim_command, seat_file):
    status, _, err = seatsim_command("run", seat_file, "--set", "seed=1", "--set", text)
    assert status == 2
    assert problem in err and "--set " in err and "line" not in err


@pytest.mark.parametrize(
    ("text", "sweep"),
    [
        ("plant.driver_mass=[50, 60]", "'sweep: {plant.driver_mass: [50, 60]}'"),
        ("excitation.spectral_class=[EM1, EM5]", "'sweep: {excitation.spectral_class: [EM1, EM5]}'"),
        ("seed=[1, 2]", "'sweep: {seed: [1, 2]}'"),
        ("controller.sample_time=[0.001, 0.005]", "'sweep: {controller.sample_time: [0.001, 0.005]}'"),
    ],
)
def test_several_values_point_to_a_sweep(text, sweep, seatsim_command, seat_file):
    status, _, err = seatsim_command("run", seat_file, "--set", text)
    assert status == 2 and f"several values are a sweep, which stands in the file: {sweep}" in err


def test_a_list_that_a_key_takes_is_no_sweep(seat_file):
    (scenario,) = seatsim.load(seat_file, {"plant.travel": [-0.04, 0.04], "controller.gain": [1.0, 2.0]})
    assert scenario.plant.travel == (-0.04, 0.04)


def test_a_misspelt_scenario_has_a_nearest_name(seatsim_command, seat_file):
    assert "(did you mean 'quickstart'?)" in seatsim_command("run", "quikstart")[2]
    near = seat_file.with_name("saet.yaml")
    assert f"(did you mean '{seat_file}'?)" in seatsim_command("run", near)[2]


@pytest.mark.parametrize("inside", [False, True])
def test_a_folder_that_cannot_be_is_refused_before_anything_runs(inside, seatsim_command, seat_file, monkeypatch):
    monkeypatch.setattr("seatsim.simulation.runs.run_many", None)
    out = seat_file / "deeper" if inside else seat_file
    status, _, err = seatsim_command("run", seat_file, "--out", out)
    assert status == 2 and f"--out {out}: cannot be written: {seat_file} is a file" in err


@pytest.mark.parametrize(
    ("typed", "among", "meaning"),
    [
        ("run h-infinity --set controller.", "controller.sensors.displacement_noise=",
         "RMS noise of a displacement reading (m)"),
        ("run quick", "quickstart", ""),
        ("describe coil.", "coil.lag", ""),
    ],
)  # fmt: skip
def test_shells_complete_keys_and_names(typed, among, meaning, seatsim_command, monkeypatch):
    monkeypatch.setenv("_SEATSIM_COMPLETE", "complete_fish")
    monkeypatch.setenv("_TYPER_COMPLETE_FISH_ACTION", "get-args")
    monkeypatch.setenv("_TYPER_COMPLETE_ARGS", f"seatsim {typed}")
    found = dict((*line.split("\t"), "")[:2] for line in seatsim_command()[1].splitlines())
    assert all(name.startswith(typed.split(" ")[-1]) for name in found)
    assert meaning in found[among]
