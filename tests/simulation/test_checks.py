"""What a scenario demands of its runs: read from the file, measured, and tested by pytest."""

import math

import numpy as np
import pytest

import seatsim
import seatsim.pytest_plugin
from seatsim.rig.control import prepare_law
from seatsim.rig.sampled_loop import build_sampled_loop
from seatsim.simulation.checks import check_run

LOOP = {"law": "static_output_feedback", "gain": [0.0, 1500.0], "sample_time": 0.005}
SHORT = {"excitation": {"kind": "road", "road_class": "C", "speed": 15.0, "duration": 5.0}}

PASSIVE = {"controller": {"law": "constant", "current": 0.0}}
NO_FORCE = {"model": "original_bingham", "parameters": {"c0": [0.0] * 4, "fc": [0.0] * 4, "f0": 0.0}}
UNDAMPED = PASSIVE | {"plant.suspension_damping": 0.0, "plant.cushion_damping": 0.0, "damper": NO_FORCE}


def figures(file, checks, **settings):
    runs = seatsim.run(file, {**SHORT, "controller": LOOP, **settings, "checks": checks}).runs
    return {checked.check: checked.figure for run in runs for checked in check_run(run)}


@pytest.mark.parametrize(
    ("change", "stable", "said"),
    [
        ({}, True, "after a release"),
        ({"actuator": {"rate": 130.0, "max_current": 1.0, "delay": 0.2}}, False, "spectral radius"),
        ({"controller": {**LOOP, "gain": [0.0, -9000.0]}}, False, "spectral radius"),
        ({"controller": {"law": "skyhook", "damping": 1500.0, "sample_time": 0.005}}, True, "after a release"),
        (PASSIVE, True, "after a release"),
        # A seat without any damping swings on.
        (UNDAMPED, False, "after a release"),
    ],
)
def test_stable_asks_the_sampled_loop_and_a_release(seat_file, change, stable, said):
    found = figures(seat_file, {"stable": True}, **change)["stable"]
    assert found.is_within == stable
    assert stable or said in found.name


def test_the_margins_are_those_of_the_sampled_loop_beyond_the_delay_of_the_coil(seat_file):
    checks, coil = {"delay_margin": {"min": 0.0}, "disk_margin": {"min": 0.0}}, {"rate": 130.0, "max_current": 1.0}
    undelayed = figures(seat_file, checks, actuator=coil)
    delayed = figures(seat_file, checks, actuator={**coil, "delay": 0.010})
    assert delayed["delay_margin"].value == pytest.approx(undelayed["delay_margin"].value - 0.010)
    scenario = seatsim.load(seat_file, {"controller": LOOP, "actuator": coil})[0]
    law = prepare_law(scenario.control.law, scenario.plant, scenario.coil, 0.005)
    loop = build_sampled_loop(law, (), scenario.plant, scenario.coil, 0.005)
    # A factor at the edge of the disk, at some phase, makes the loop unstable; within the disk none does.
    for scale, all_stable in ((0.98, True), (1.05, False)):
        a = scale * undelayed["disk_margin"].value
        around = np.exp(1j * np.linspace(0.0, 2 * math.pi, 400))
        factors = (1 + a / 2 * around) / (1 - a / 2 * around)
        largest = [np.abs(np.linalg.eigvals(loop.A + f * np.outer(loop.B, loop.C))).max() for f in factors]
        assert (max(largest) < 1) == all_stable


def test_a_check_may_be_made_of_some_variants(seat_file):
    variants = {"soft": PASSIVE, "controlled": {}}
    checks = {"delay_margin": {"min": 0.005, "per": ["controlled"]}, "seat_factor": {"max": 9.0}}
    runs = seatsim.run(seat_file, {**SHORT, "controller": LOOP, "variants": variants, "checks": checks}).runs
    found = [[checked.check for checked in check_run(run)] for run in runs]
    assert found == [["seat_factor"], ["delay_margin", "seat_factor"]]


@pytest.mark.parametrize(
    ("checks", "said"),
    [
        ({"seat_facto": {"max": 1.0}}, "did you mean 'seat_factor'"),
        ({"seat_factor": {}}, "states no range"),
        ({"seat_factor": {"min": 2.0, "max": 1.0}}, "min below max"),
        ({"seat_factor": {"max": "low"}}, "must be a finite number"),
        ({"seat_factor": {"maximum": 1.0}}, "unknown key"),
        ({"seat_factor": True}, "is not a mapping"),
        ({"stable": False}, "is not a mapping"),
        ({"stable": {"per": ["hot"]}}, "no variant 'hot'"),
        ({"stable": {"per": 3}}, "list of names of variants"),
    ],
)
def test_a_check_that_cannot_be_made_is_an_error_with_its_place(seat_file, checks, said):
    with pytest.raises(seatsim.InputError, match=r"checks\.(seat|stable)") as error:
        seatsim.load(seat_file, {"checks": checks})
    assert said in str(error.value)


def test_margins_of_a_law_without_a_linear_loop_are_refused_with_the_way_out(seat_file):
    with pytest.raises(seatsim.InputError, match=r"law constant wants a current.*per: \[VARIANT\]"):
        figures(seat_file, {"delay_margin": {"min": 0.01}}, **PASSIVE)


def test_pytest_collects_a_test_for_each_check_and_run(pytester, seat_file):
    text = seat_file.read_text()
    sweep = "sweep: {temperature: [20.0, 80.0]}\nexcitation: {kind: rest, duration: 1.0}\n"
    kept = "".join(line + "\n" for line in text.splitlines() if not line.startswith("excitation"))
    pytester.makeini("[pytest]")  # settings of a folder above do not count
    checks = "checks: {suspension_displacement_peak: {max: 1}, current_rms: {min: 5.0}}\n"
    pytester.makefile(".yaml", seat=kept + sweep + checks)
    pytester.makefile(".yaml", other=text, wrong=text + "checks: {seat_facto: {max: 1.0}}\n")
    options = ("-p", "no:seatsim", "--continue-on-collection-errors")
    result = pytester.runpytest_inprocess(*options, plugins=[seatsim.pytest_plugin])
    result.assert_outcomes(passed=2, failed=2, errors=1)
    result.stdout.fnmatch_lines(["*did you mean 'seat_factor'*", "*current_rms is 0*at least 5 A*"])
