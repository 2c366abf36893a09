"""Runs that differ on purpose: what `set` states is what the rig was in that run, wherever it is replayed."""

import dataclasses
import shutil

import pytest

import seatsim
from seatsim.recordings.gap import measure_gap
from seatsim.recordings.quality.examination import examine
from seatsim.recordings.recording import load_recording
from seatsim.recordings.writer import save_recording
from seatsim.scenario.loading import single
from seatsim.scenario.numbers import list_numbers, set_number
from seatsim.simulation.result import Result

from ..diagnosis.posed import pose
from ..faulty_recordings import edit
from ..text import words

CHANNELS = words("""
    floor_acceleration frame_acceleration driver_acceleration suspension_displacement current_command
""")


@pytest.fixture(scope="module")
def heavier(kept_seat_file, tmp_path_factory):
    """A recording whose second run has 15 kg more on the seat, and says so."""
    variants = {"as stated": {}, "heavier": {"plant.driver_mass": 95.0, "seed": 3}}
    result = seatsim.run(kept_seat_file, {"variants": variants, "solver": {"step": 0.005}})
    folder = tmp_path_factory.mktemp("heavier") / "recorded"
    return save_recording(result, folder, CHANNELS, {"default": 0.1, "plant.frame_mass": "fitted"}, model_error=0.03)


def edited(heavier, tmp_path, change):
    folder = shutil.copytree(heavier, tmp_path / "edited")
    edit(folder, change)
    return folder


def unset(header):
    del header["runs"][1]["set"]


def test_the_writer_states_what_differs_and_keeps_tolerances_and_model_error(heavier):
    recording = load_recording(heavier)
    assert recording.runs["run-2"].set == {"plant.driver_mass": 95.0} and not recording.runs["run-1"].set
    assert recording.header.default_tolerance == 0.1 and recording.header.model_error == 0.03
    assert recording.header.own_tolerances == {"plant.frame_mass": "fitted"}


def test_added_mass_that_is_stated_leaves_the_gap_where_it_was(heavier, tmp_path):
    assert seatsim.gap(heavier / "nominal.yaml", heavier).overall < 1e-3
    folder = edited(heavier, tmp_path, unset)
    assert measure_gap(folder / "nominal.yaml", folder).overall > 0.03
    assert not examine(load_recording(heavier)).errors


def test_what_was_set_is_as_far_off_as_what_was_refitted(heavier):
    recording, nominal = load_recording(heavier), single(heavier / "nominal.yaml")
    assert recording.scenario_of("run-1", nominal) is nominal
    assert recording.scenario_of("run-2", nominal).plant.driver_mass == 95.0
    refitted = set_number(set_number(nominal, "plant.driver_mass", 84.0), "plant.frame_mass", 21.0)
    plant = recording.scenario_of("run-2", refitted).plant
    assert plant.driver_mass == pytest.approx(95.0 * 1.05) and plant.frame_mass == 21.0


def test_zeros_move_by_as_much_and_conditions_are_what_was_set(heavier, tmp_path):
    changes = {"damper.parameters.f0": 30.0, "damper.parameters.c_a": 0.0, "temperature": 40.0, "actuator.rate": 65.0}
    folder = edited(heavier, tmp_path, lambda header: header["runs"][1].update(set=changes))
    recording, scenario = load_recording(folder), single(folder / "nominal.yaml")
    for key, value in {"damper.parameters.f0": 2.0, "damper.parameters.c_a": 260.0, "temperature": 25.0}.items():
        scenario = set_number(scenario, key, value)
    found = list_numbers(recording.scenario_of("run-2", scenario))
    assert [found[key] for key in changes] == [32.0, 0.0, 40.0, 65.0]


def test_a_scenario_without_what_a_run_sets_is_refused(heavier, tmp_path):
    folder = edited(heavier, tmp_path, lambda header: header["runs"][1].update(set={"damper.parameters.alpha_a": 50.0}))
    other = single(folder / "nominal.yaml", {"damper": {"model": "kwok_tanh"}})
    with pytest.raises(seatsim.InputError, match=r"run run-2: sets 'damper.parameters.alpha_a', which scenario"):
        measure_gap(other, folder, ["run-2"])


def test_a_fit_simulates_each_run_as_it_was_set(heavier):
    problem = pose(heavier)
    driver = next(k for k, each in enumerate(problem.parameters) if each.name == "driver_mass")
    deviations = problem.nominal
    deviations[driver] = 0.5
    masses = {run: problem.scenario_of(run, deviations, ()).plant.driver_mass for run in problem.runs}
    assert masses == pytest.approx({"run-1": 84.0, "run-2": 95.0 * 1.05})
    tolerances = {each.key: each.tolerance / each.nominal for each in problem.parameters if each.nominal}
    assert tolerances["plant.frame_mass"] == pytest.approx(problem.settings.selection.fitted_tolerance)
    assert tolerances["plant.driver_mass"] == pytest.approx(0.1)


def test_runs_of_different_dampers_are_no_recording(kept_seat_file, tmp_path):
    first = seatsim.run(kept_seat_file, {"solver": {"step": 0.005}}).runs[0]
    other = dataclasses.replace(first, scenario=single(kept_seat_file, {"damper": {"model": "kwok_tanh"}}))
    with pytest.raises(seatsim.InputError, match="has another damper model"):
        save_recording(Result((first, other)), tmp_path / "mixed", CHANNELS)
    assert not (tmp_path / "mixed").exists()


def test_a_warming_damper_starts_from_what_is_set(seat_file):
    seat_file.write_text(
        seat_file.read_text().replace("temperature: 20.0", "temperature: {start: 20.0, ambient: 15.0}")
    )
    warming = single(seat_file)
    assert list_numbers(warming)["temperature.start"] == 20.0 and "temperature" not in list_numbers(warming)
    moved = set_number(warming, "temperature.start", 50.0)
    assert moved.temperature.start == 50.0 and moved.temperature.ambient == 15.0
    assert dataclasses.replace(moved, temperature=warming.temperature) == warming
