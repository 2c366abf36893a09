"""The first screen: README has the table of the quickstart, and what it says of control and passive dampers holds."""

import re
from pathlib import Path

import pytest

import seatsim

from ..text import parse

README = (Path(__file__).resolve().parents[2] / "README.md").read_text(encoding="utf-8")
COLUMNS = parse("""
    {driver_acceleration_rms: 1.0, driver_acceleration_weighted: 1.0, driver_vdv: 1.0, seat_factor: 1.0,
     suspension_displacement_rms: 1000.0, suspension_displacement_peak: 1000.0, end_stop_hits: 1.0,
     driver_jerk_rms: 1.0, current_rms: 1.0}
""")


@pytest.fixture(scope="module")
def rows():
    return seatsim.run("quickstart").table.set_index("variant")


def test_readme_shows_the_table_of_the_quickstart(rows):
    shown = re.findall(r"^ .*?((?:\s+\d+(?:\.\d+)?){9})$", README, re.MULTILINE)
    assert len(shown) == len(rows)
    for line, (_, row) in zip(shown, rows.iterrows(), strict=True):
        # Half a unit of the last digit, and what another processor may round differently on the way to it.
        figures = [scale * row[column] for column, scale in COLUMNS.items()]
        assert [float(text) for text in line.split()] == pytest.approx(figures, rel=0.01, abs=0.006)


def test_control_beats_the_best_passive_damper_at_equal_travel(rows):
    controlled, passive, stiff = (
        rows.loc[name] for name in ("hybrid skyhook", "passive, best", "passive, same travel")
    )
    assert controlled.seat_factor < 0.87 * stiff.seat_factor
    assert controlled.suspension_displacement_rms < stiff.suspension_displacement_rms
    assert controlled.suspension_displacement_peak < 1.02 * stiff.suspension_displacement_peak
    assert controlled.seat_factor < 0.91 * passive.seat_factor
    assert controlled.suspension_displacement_peak < passive.suspension_displacement_peak
    assert controlled.driver_jerk_rms == pytest.approx(1.5 * passive.driver_jerk_rms, rel=0.03)
    assert rows.end_stop_hits.to_dict() == parse("""
        {hybrid skyhook: 2, no current: 48, "passive, best": 5, "passive, same travel": 0}
    """)


def test_no_other_viscous_setting_is_better(rows):
    for damping, best in ((325.0, "passive, best"), (475.0, "passive, best"), (650.0, "passive, same travel")):
        settings = {"variants": {}, "controller": {"law": "constant", "current": 0.0}}
        viscous = {"c_a": damping, "c_b": 0.0, "alpha_a": 0.0, "alpha_b": 0.0}
        settings |= {f"damper.parameters.{key}": value for key, value in viscous.items()}
        assert seatsim.run("quickstart", settings).table.seat_factor[0] > rows.seat_factor[best]
