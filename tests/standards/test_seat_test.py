"""The seat test against the response of a linear seat, on recordings, and what it refuses."""

import json
import shutil

import numpy as np
import pytest

from seatsim import load, run, seat_test
from seatsim.excitations.iso7096 import Iso7096, acceleration_density
from seatsim.metrics.weighting import frequency_response
from seatsim.recordings.writer import save_recording
from seatsim.rig.plant import control_system
from seatsim.schema.errors import InputError, RunError
from seatsim.simulation.simulate import simulate
from seatsim.standards.seat_test import INERT_MASS, SEATED_SHARE, weighted_input

from ..answers import check_answer
from ..text import beside

DAMPING = 600.0
"""N s/m, of the damper in `linear_seat.yaml`."""
SEAT = beside(__file__, "linear_seat.yaml")


@pytest.fixture(scope="module")
def scenario(tmp_path_factory):
    path = tmp_path_factory.mktemp("seat") / "seat.yaml"
    path.write_text(SEAT)
    return path


@pytest.fixture(scope="module")
def tested(scenario):
    """The test of the seat in every class."""
    return seat_test(scenario)


@pytest.fixture(scope="module")
def recorded(scenario, tmp_path_factory):
    """Three runs of the seat with the heavy person in class EM5, which no test edits."""
    channels = ["floor_acceleration", "driver_acceleration", "suspension_displacement"]
    settings = {"plant.driver_mass": SEATED_SHARE * 98, "sweep": {"seed": [1, 2, 3]}, "solver": {"step": 0.004}}
    return save_recording(run(scenario, settings), tmp_path_factory.mktemp("recorded") / "heavy", channels)


def gain(scenario, mass, frequency):
    """Transmissibility of the linear seat, its damper as a part of the suspension's damping."""
    plant = load(scenario)[0].plant
    system = control_system(plant._replace(driver_mass=mass, suspension_damping=plant.suspension_damping + DAMPING))
    return np.abs(system(2j * np.pi * frequency)[3, 0])


def test_seat_factors_are_those_of_the_frequency_response(scenario, tested, conform):
    rows = [row for row in tested.rows if row.spectral_class == "EM5"]
    frequency = np.linspace(0.01, 20, 4000)
    power = acceleration_density(frequency, "EM5") * np.abs(frequency_response(frequency)) ** 2
    for row in rows:
        expected = np.sqrt(np.sum(power * gain(scenario, SEATED_SHARE * row.mass, frequency) ** 2) / np.sum(power))
        claim = f"seat test, EM5, {row.person} person: SEAT factor of a linear seat"
        conform(claim, "frequency response of the linear seat", row.seat, expected, tolerance=0.01 * expected)
        base = weighted_input("EM5")
        claim = f"seat test, EM5, {row.person} person: weighted RMS of the platform, m/s^2"
        conform(claim, "density of the class times Wk^2", row.platform, base, tolerance=0.02 * base)
        assert row.limit == 0.7 and row.passed == (row.seat <= 0.7) and "recalled" in row.clause
        assert row.within_spread and row.end_stop_hits == 0
        assert row.corrected == pytest.approx(row.seat * base)
    assert [row.person for row in rows] == ["light", "heavy"]


def test_damping_test_finds_the_resonance_under_the_inert_mass(scenario, tested, conform):
    [test] = tested.damping.values()
    analytic = gain(scenario, INERT_MASS, np.array(test.frequencies))
    for frequency, measured, expected in zip(test.frequencies, test.transmissibilities, analytic, strict=True):
        claim = f"damping test, transmissibility at {frequency:.3g} Hz"
        conform(claim, "frequency response of the linear seat", measured, expected, tolerance=5e-3 * expected)
    assert test.transmissibility == max(test.transmissibilities)
    assert test.stroke == pytest.approx(0.04)
    limits = {(limit, test.transmissibility <= limit) for limit in (1.5, 2.0)}
    assert {(row.limit, row.passed) for row in tested.damping_rows} == limits


def test_measured_runs_are_put_to_their_class(recorded, tested):
    [row] = seat_test(recorded).rows
    assert (row.spectral_class, row.person, row.within_spread) == ("EM5", "heavy", True)
    [simulated] = [each for each in tested.rows if (each.spectral_class, each.person) == ("EM5", "heavy")]
    assert row.seat == pytest.approx(simulated.seat, rel=0.02)
    with pytest.raises(InputError, match="no run is of a class"):
        seat_test(recorded, ["EM6"])


@pytest.mark.parametrize(
    ("settings", "message"),
    [({"controller": {"law": "replay"}}, "replays a recording"), ({"plant.travel": [0.05, -0.05]}, "travel")],
)
def test_what_cannot_be_tested_is_refused(scenario, settings, message):
    with pytest.raises(InputError, match=message):
        seat_test(scenario, ["EM5"], settings)


def test_a_travel_that_is_not_stated_is_said(scenario):
    found = seat_test(scenario, ["EM6"], {"plant.travel": [-10.0, 10.0]})
    assert found.rows[0].end_stop_hits is None
    assert any("no end stops are stated" in note and "state plant.travel" in note for note in found.notes)


def test_a_run_that_breaks_off_leaves_the_others_and_is_a_line_with_its_reason(
    scenario, tmp_path, monkeypatch, seatsim_command
):
    def broken(case):
        if isinstance(case.excitation, Iso7096) and case.seed == 1:
            raise RunError("a state ran away at 3 s")
        return simulate(case)

    monkeypatch.setattr("seatsim.standards.seat_test.simulate", broken)
    options = ("--class", "em5", "--out", tmp_path / "out", "--json")
    status, printed, said = seatsim_command("seat-test", scenario, *options)
    found, path = check_answer("seat-test", printed), tmp_path / "out" / "seat_test.json"
    assert {**found, "files": found["files"][:1]} == json.loads(path.read_text()) | {"files": [str(path)]}
    assert all({"class", "mass", "seat", "limit", "pass", "clause"} <= set(row) for row in found["classes"])
    assert status == 1 and "failed: seat, EM5, light: a state ran away" in said
    assert [(each["class"], each["person"]) for each in found["failed"]] == [("EM5", "light"), ("EM5", "heavy")]
    assert len(found["classes"]) == 2 and not any(row["pass"] for row in found["classes"]) and found["damping"]


def test_a_damaged_run_of_a_recording_leaves_the_others(recorded, tmp_path):
    folder = shutil.copytree(recorded, tmp_path / "damaged")
    (folder / "run-2.csv.gz").write_bytes(b"torn")
    found = seat_test(folder)
    assert len(found.rows) == 1 and [failure.run for failure in found.failures] == ["run-2"]
    assert "cannot be read" in found.failures[0].reason
