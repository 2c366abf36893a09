"""The checks that a scenario states, made by `seatsim check --run`."""

import json

import pytest


@pytest.mark.parametrize(("bound", "status"), [(9.0, 0), (0.1, 1)])
def test_a_check_that_fails_is_named_with_its_figure(seat_file, seatsim_command, bound, status):
    seat_file.write_text(seat_file.read_text() + f"checks: {{seat_factor: {{max: {bound}}}}}\n")
    assert seatsim_command("check", seat_file)[0] == 0
    code, out, err = seatsim_command("check", seat_file, "--run")
    assert code == status
    assert ("FAILED: seat, seat_factor: seat_factor is " in err) == (status == 1)
    code, out, _ = seatsim_command("check", seat_file, "--run", "--json")
    (row,) = json.loads(out)["checks"]
    assert (code, row["check"], row["max"], row["pass"]) == (status, "seat_factor", bound, status == 0)


def test_a_scenario_without_checks_is_an_error(seat_file, seatsim_command):
    code, _, err = seatsim_command("check", seat_file, "--run")
    assert code == 2
    assert "states nothing under 'checks'" in err
