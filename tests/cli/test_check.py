"""The checks that a scenario states, made by `seatsim check --run`."""

import json


def test_a_check_that_fails_is_named_with_its_figure(seat_file, seatsim_command):
    checks = "checks: {seat_factor: {max: 0.1}, driver_acceleration_rms: {max: 9.0}}\n"
    seat_file.write_text(seat_file.read_text() + checks)
    assert seatsim_command("check", seat_file)[0] == 0
    status, _, err = seatsim_command("check", seat_file, "--run")
    assert status == 1 and "FAILED: seat, seat_factor: seat_factor is " in err and err.count("FAILED") == 1
    status, out, _ = seatsim_command("check", seat_file, "--run", "--json")
    rows = [(row["check"], row["max"], row["pass"]) for row in json.loads(out)["checks"]]
    assert status == 1 and rows == [("seat_factor", 0.1, False), ("driver_acceleration_rms", 9.0, True)]
    seat_file.write_text(seat_file.read_text().replace("max: 0.1", "max: 9.0"))
    assert seatsim_command("check", seat_file, "--run")[0] == 0


def test_a_scenario_without_checks_is_an_error(seat_file, seatsim_command):
    code, _, err = seatsim_command("check", seat_file, "--run")
    assert code == 2
    assert "states nothing under 'checks'" in err
