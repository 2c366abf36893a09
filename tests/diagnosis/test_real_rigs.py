"""Recordings of real rigs (benchmarks/real_rigs.py): what is known of the data is in them, not in the nominals."""

import numpy as np
import pytest

import seatsim


@pytest.fixture(scope="module")
def real_rigs(benchmark):
    return benchmark("real_rigs")


@pytest.fixture(scope="module")
def records(benchmark):
    return benchmark("rig_records")


@pytest.fixture
def data(shared):
    return shared / "data"


def test_no_record_stands_in_two_parts(records, data):
    for rig in records.list_rigs(data):
        parts = [set(rig.fit), set(rig.runs), set(rig.unseen)]
        assert len(set.union(*parts)) == sum(map(len, parts))
        tables = [table for part in (rig.fit, rig.runs, rig.unseen) for table in part.values()]
        assert all(np.isfinite(values).all() for table in tables for values in table.values())
        first = next(iter(tables[0]))
        assert len({tuple(table[first][300:400]) for table in tables}) == len(tables)


def test_the_force_of_dyke_lags_the_voltage_by_what_the_standard_coil_lags(real_rigs, records, data, tmp_path):
    gaps = {}
    for rate in (130.0, 1000.0):
        rig = records.dyke(data, "dyke", rate)
        real_rigs.write_part(rig, rig.nominal, rig.unseen, tmp_path / f"{rate:g}", real_rigs.TOLERANCE)
        recording = real_rigs.quick(seatsim.load_recording(tmp_path / f"{rate:g}"))
        gaps[rate] = seatsim.gap(recording.nominal, recording).overall
    assert gaps[130.0] < 0.8 * gaps[1000.0]


def test_the_quarter_car_maps_onto_the_seat_with_its_resonance(real_rigs, records, data, tmp_path):
    rig = records.quanser(data, "quanser", ("driver_acceleration", "suspension_displacement"))
    real_rigs.write_part(rig, rig.nominal, rig.runs, tmp_path, real_rigs.TOLERANCE)
    recording = seatsim.load_recording(tmp_path)
    assert recording.runs["repeat-3"].repeat_of == "repeat-2"
    found = seatsim.gap(recording.nominal, recording)
    assert 5.0 * found.floor.overall < found.overall < 0.4


@pytest.mark.slow
@pytest.mark.parametrize(
    "name, known",
    [
        # The force follows the voltage faster one way than the other, by which the standard lag, too, is passed.
        ("dyke", [{"coil.asymmetric_lag"}, {"damper.gas_spring"}]),
        ("quanser-travel", [{"suspension.friction"}]),
    ],
)
def test_what_the_data_are_known_to_show_stands_beside_what_is_unexplained(
    real_rigs, records, data, tmp_path, name, known
):
    rig = next(rig for rig in records.list_rigs(data) if rig.name == name)
    found = seatsim.diagnose(real_rigs.write(rig, tmp_path), budget=1200.0)  # on a busy machine, too
    assert found.verdict == "unknown"
    groups = [
        {each, *(name for group in found.indistinguishable if each in group for name in group)}
        for each in found.selected
    ]
    assert len(groups) == len(known)
    assert all(any(effect <= group for group in groups) for effect in known)
    assert found.gap.shrink > 0.1
