"""Comfort of tables and recordings: units, gravity, blocks, runs, and what is refused."""

import json
import math

import numpy as np
import pandas as pd
import pytest

from seatsim import comfort
from seatsim.schema.errors import InputError

RATE = 500.0
TIME = np.arange(int(120 * RATE)) / RATE
WK_AT_5_HZ = 1.039  # ISO 2631-1:1997, Table 3


def write(folder, name="ride.csv", **columns):
    path, (first, *_) = folder / name, columns.values()
    pd.DataFrame({"time_s": TIME[: len(first)]} | columns).to_csv(path, index=False)
    return path


def tone(a_w=1.0, frequency=5.0, mean=0.0):
    return mean + a_w * math.sqrt(2) / WK_AT_5_HZ * np.sin(2 * np.pi * frequency * TIME)


@pytest.fixture(scope="module")
def ride(tmp_path_factory):
    """A file of a tone of 1 m/s^2 on the seat, which no test edits."""
    return write(tmp_path_factory.mktemp("ride"), acc_z=tone())


def test_a_tone_has_the_published_factor_whatever_its_unit_and_mean(tmp_path, conform):
    path = write(tmp_path, acc_z_g=tone(mean=9.80665) / 9.80665)
    found = comfort(path)
    rms = found.axes["z"].dose.rms
    claim = "a_w of a tone of 5 Hz in a file in g, upon gravity, m/s^2"
    conform(claim, "ISO 2631-1:1997, table 3: 1.039", rms, 1.0, tolerance=5e-3)
    assert found.axes["z"].method == "basic"
    assert any("gravity" in note for note in found.notes)
    plain = comfort(write(tmp_path, "plain.csv", a=tone()), {"Z": "a"})
    assert plain.axes["z"].dose.rms == pytest.approx(found.axes["z"].dose.rms, rel=1e-9)
    assert any("no unit is stated" in note for note in plain.notes)


def test_a_mean_of_one_without_a_unit_is_doubted(tmp_path):
    found = comfort(write(tmp_path, acc_z=tone(0.1) / 9.80665 + 1.0))
    assert any("--unit g" in note for note in found.notes)
    in_g = comfort(write(tmp_path, acc_z=tone(0.1) / 9.80665 + 1.0), unit="g")
    assert in_g.axes["z"].dose.rms == pytest.approx(0.1, rel=5e-3)


def test_totals_add_axes_and_points_with_their_factors(tmp_path):
    names = {"x": "a", "y": "a", "z": "a", "back.x": "a", "feet.z": "a"}
    found = comfort(write(tmp_path, a=tone()), names)
    squares = {axis: (each.direction.comfort * each.dose.rms) ** 2 for axis, each in found.axes.items()}
    assert found.totals["seat"] == pytest.approx(math.sqrt(squares["x"] + squares["y"] + squares["z"]))
    assert found.totals["overall"] == pytest.approx(math.sqrt(sum(squares.values())))
    assert list(found.totals) == ["seat", "back", "feet", "overall"]
    assert found.exposure.a8_axis == "z"


def test_seat_factors_come_from_pairs_of_axes():
    found = comfort("scenarios/data/recording")
    assert found.seat["z"].rms < 1.0 and len(found.seat["z"].runs) == 2
    assert found.runs == ("run-1", "run-2")
    one = comfort("scenarios/data/recording", runs=["run-2"])
    assert one.seat["z"].rms == pytest.approx(found.seat["z"].runs[1])


@pytest.mark.parametrize(
    ("channels", "message"),
    [
        ({"z": "acc_zz"}, r"no column 'acc_zz' \(did you mean 'acc_z'\?\)"),
        ({"zz": "acc_z"}, r"no axis is called 'zz'.*permitted: x, y, z"),
        ({"floor.z": "acc_z"}, "no axis of the person"),
    ],
)
def test_a_wrong_channel_is_named(ride, channels, message):
    with pytest.raises(InputError, match=message):
        comfort(ride, channels)


def test_wrong_files_are_one_error_each(ride, tmp_path):
    short = tone()[:5000]
    with pytest.raises(InputError, match=r"no such file.*did you mean 'ride\.csv'"):
        comfort(ride.with_name("rode.csv"))
    with pytest.raises(InputError, match="no column has a usual name"):
        comfort(write(tmp_path, "odd.csv", a=short))
    broken = np.where(np.arange(5000) == 100, math.nan, short)
    with pytest.raises(InputError, match="row 101, acc_z: not a finite number"):
        comfort(write(tmp_path, "hole.csv", acc_z=broken))
    for wrong in ({"rate": 0.0}, {"hours": 25.0}, {"hours": math.nan}):
        with pytest.raises(InputError, match="above 0"):
            comfort(ride, **wrong)
    with pytest.raises(InputError, match=r"ride\.csv, acc_z: .*needs 200 Hz or more"):
        comfort(ride, rate=100.0)
    with pytest.raises(InputError, match="does not rise in even steps"):
        comfort(write(tmp_path, "jump.csv", time_s=TIME[:5000] + 0.5 * (TIME[:5000] > 6), acc_z=short))


@pytest.mark.parametrize(
    ("column", "factor"),
    [("acc_z_m_s2", 1.0), ("a_Sitz [g]", 1 / 9.80665), ("Fahrer (mm/s^2)", 1e3), ("z_mg", 1e3 / 9.80665)],
)
def test_units_end_the_names_of_columns(tmp_path, column, factor):
    found = comfort(write(tmp_path, **{column: factor * tone()}))
    assert found.axes["z"].dose.rms == pytest.approx(1.0, rel=5e-3)
    assert not any("no unit" in note for note in found.notes)


def test_a_unit_of_something_else_is_refused(tmp_path):
    with pytest.raises(InputError, match=r"acc_z_g: 'g' is no unit of a value in rad/s\^2"):
        comfort(write(tmp_path, acc_z_g=tone()), {"rz": "acc_z_g"})
    turning = comfort(write(tmp_path, spin_deg_s2=np.rad2deg(tone())), {"rz": "spin_deg_s2"})
    assert turning.axes["rz"].removed == pytest.approx(0.0, abs=1e-9) and turning.axes["rz"].dose.rms > 0.1


def test_the_command_prints_one_object_and_writes_only_where_asked(ride, tmp_path, seatsim_command):
    status, printed, _ = seatsim_command("comfort", ride, "--json", "--hours", "4")
    found = json.loads(printed)
    assert status == 0 and found["hours"] == 4.0
    status, _, said = seatsim_command("comfort", ride, "--hours", "much")
    assert status == 2 and "--hours" in said
    assert {"weighting", "rms", "vdv", "mtvv", "crest_factor", "method"} <= set(found["axes"]["z"])
    assert found["a8"] == pytest.approx(math.sqrt(0.5), rel=5e-3)
    assert found["action_value"]["exceeded_by_a8"] and not found["limit_value"]["exceeded_by_a8"]
    status, printed, _ = seatsim_command("comfort", ride, "--channel", "z=acc_z", "--out", tmp_path / "out")
    assert status == 0 and "A(8) 1.0" in printed
    assert json.loads((tmp_path / "out" / "comfort.json").read_text())["axes"]["z"] == found["axes"]["z"]
