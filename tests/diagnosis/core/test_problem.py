"""A recording posed as a problem: what is compared, from which row, and how residuals come back."""

import dataclasses

import numpy as np
import pytest

from seatsim.diagnosis.problem import check_nominal, normalise_rms_errors, pose_problem
from seatsim.effects.sensor import Gain
from seatsim.recordings.recording import load_recording
from seatsim.scenario.scenario import Start
from seatsim.schema.errors import InputError, RunError

from ...text import beside
from ..builders import SerialExecutor
from .toy import Added, add_up, draw_signals, make_problem

HEADER = beside(__file__, "header.yaml")


@pytest.fixture
def folder(tmp_path, kept_seat_file):
    """Write a recording whose suspension's sensor drowns in noise; row k of a channel holds k times its own factor."""
    for name, rows in (("long", 520), ("short", 411)):
        row = np.arange(float(rows))
        columns = np.stack([np.sin(row), 0.1 * row, 0.2 * row, 1.0 + 0.001 * row, np.zeros(rows)], axis=1)
        names = "floor_acceleration,driver_acceleration,frame_acceleration,suspension_displacement,coil_current"
        np.savetxt(tmp_path / f"{name}.csv", columns, delimiter=",", header=names, comments="")
    (tmp_path / "recording.yaml").write_text(HEADER)
    text = kept_seat_file.read_text() + "start: {displacement: 0.01}\n"
    (tmp_path / "nominal.yaml").write_text(text)
    return tmp_path


@pytest.fixture
def posed(folder):
    return pose_problem(load_recording(folder), SerialExecutor())


def test_channels_above_their_noise_are_compared_in_the_order_of_the_outputs(posed):
    assert posed.channels == ("frame_acceleration", "driver_acceleration")
    np.testing.assert_array_equal(posed.noise, [0.1, 0.02])
    assert posed.runs == ("long", "short") and not posed.bench


def test_the_first_second_is_left_out_and_the_rest_cut_to_a_length_of_small_prime_factors(posed):
    assert posed.rate == 200.0 and posed.skip == 200
    # 320 rows are left of the long run; of the 211, a prime number, of the short run 200.
    assert posed.measured["long"].shape == (2, 320)
    assert posed.measured["short"].shape == (2, 200)
    np.testing.assert_allclose(posed.measured["short"][0, :2], [0.2 * 200, 0.2 * 201])
    np.testing.assert_allclose(posed.measured["long"][1, -1], 0.1 * 519)


def test_a_step_divides_a_row_and_is_at_most_two_milliseconds(posed):
    assert posed.scenario.solver.step == pytest.approx(0.005 / 3)
    assert posed.parts == 3
    assert posed.scenario.start == Start()
    floor = posed.inputs["short"].floor
    assert floor.step == pytest.approx(0.005 / 3) and posed.inputs["short"].interval == 0.005
    assert len(floor.acceleration) == 410 * 3 + 1


@pytest.mark.parametrize(
    ("stated", "expected"),
    [
        ("fitted", {"frame_mass": 10.0, "c_a": 125.0, "f0": 2.0}),
        ("{default: 0.1, damper.parameters.c_a: fitted}", {"frame_mass": 2.0, "c_a": 125.0, "f0": 10.0}),
        ("{default: fitted, plant.frame_mass: 0.01}", {"frame_mass": 0.2, "c_a": 125.0, "f0": 2.0}),
        ("{damper.parameters.f0: fitted}", {"frame_mass": 0.4, "c_a": 5.0, "f0": 50.0}),
    ],
)
def test_tolerances_are_numbers_or_fitted_for_all_or_by_key(folder, stated, expected):
    (folder / "recording.yaml").write_text(HEADER.replace("0.05", stated, 1))
    parameters = pose_problem(load_recording(folder), SerialExecutor()).parameters
    found = {each.name: each.tolerance for each in parameters}
    assert {name: found[name] for name in expected} == pytest.approx(expected)


def test_nothing_above_the_noise_is_nothing_to_diagnose(folder):
    (folder / "recording.yaml").write_text(HEADER.replace("0.02", "50.0").replace("0.1}", "50.0}"))
    with pytest.raises(InputError, match="nothing to diagnose"):
        pose_problem(load_recording(folder), SerialExecutor())


def test_effects_stand_beside_those_of_the_nominal_scenario_or_replace_one_at_the_same_place(posed):
    own = Added("own", 1.0), Gain("coil_current", 0.1)
    present = dataclasses.replace(posed, scenario=dataclasses.replace(posed.scenario, effects=own))
    rig = present.augmented(present.nominal, [Gain("driver_acceleration", 0.2)])
    assert rig.effects == (*own, Gain("driver_acceleration", 0.2))
    rig = present.augmented(present.nominal, [Gain("coil_current", 0.3)])
    assert rig.effects == (own[0], Gain("coil_current", 0.3))
    assert present.scenario.effects == own


@pytest.fixture
def linear():
    signals = draw_signals(["nominal", "nuisance 0", "a", "b"])
    return make_problem(signals, add_up(signals, {"a": 2.0}), nuisances=1)


def test_a_nominal_rig_that_cannot_be_simulated_is_an_error_that_names_the_run(linear):
    class Runaway(type(linear)):
        def simulated(self, run, deviations, effects, inputs=None):
            if run == "second":
                raise RunError("no solution beyond 0.3 s")
            return super().simulated(run, deviations, effects, inputs)

    check_nominal(linear)
    fields = {each.name: getattr(linear, each.name) for each in dataclasses.fields(linear)}
    with pytest.raises(
        RunError, match=r"toy, run second: the nominal .*nominal.yaml cannot .*: no solution beyond 0.3 s"
    ):
        check_nominal(Runaway(**fields))
    third = fields["signals"]["third"] | {"nominal": np.full((2, 200), np.nan)}
    endless = fields["signals"] | {"third": third}
    with pytest.raises(RunError, match=r"run third: .* its outputs are not finite"):
        check_nominal(type(linear)(**fields | {"signals": endless}))


def test_a_channel_that_is_constant_in_a_run_counts_nothing_there(linear):
    still = linear.measured["first"].copy()
    still[0] = 7.0
    part = dataclasses.replace(linear, measured={**linear.measured, "first": still}).on_runs(["first"])
    assert list(normalise_rms_errors(part, {"first": np.vstack([np.ones_like(still[0]), 0.0 * still[0]])})) == [0.0]


def test_a_part_of_the_runs_has_its_own_spread_and_the_same_rest(linear):
    part = linear.on_runs(["third", "first"])
    assert part.runs == ("third", "first")
    together = np.concatenate([linear.measured["third"], linear.measured["first"]], axis=1)
    np.testing.assert_allclose(part.spread, together.std(axis=1))
    assert part.measured is linear.measured
    assert list(part.residuals([(linear.nominal, [])])[0]) == ["third", "first"]
    assert linear.runs == ("first", "second", "third")


def test_an_error_is_counted_in_standard_deviations_by_run(linear):
    residuals = {"first": np.ones((2, 120)), "second": np.zeros((2, 160)), "third": np.full((2, 200), 3.0)}
    weight = np.sqrt(np.mean(linear.spread**-2.0))
    np.testing.assert_allclose(normalise_rms_errors(linear, residuals), [weight, 0.0, 3.0 * weight])
    uneven = residuals | {"first": np.stack([2.0 * np.ones(120), np.zeros(120)])}
    expected = 2.0 / linear.spread[0] / np.sqrt(2.0)
    assert normalise_rms_errors(linear.on_runs(["first"]), uneven)[0] != pytest.approx(expected)
    part = linear.on_runs(["first"])
    assert normalise_rms_errors(part, uneven)[0] == pytest.approx(2.0 / part.spread[0] / np.sqrt(2.0))
