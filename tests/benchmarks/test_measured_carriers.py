"""Cases on measured recordings: how they are counted, nominals that hold mechanisms, and the joint fit beside them."""

import pytest

from ..blind.carriers import bench_carrier, offset, write_carrier


def test_a_nominal_holds_the_mechanism_that_the_records_show(benchmark, tmp_path):
    nominals, records = benchmark("carrier_nominals"), benchmark("rig_records")
    carrier = offset(bench_carrier(), 60.0)
    header = {**carrier.header, "runs": carrier.header["runs"][:1]}
    one = carrier._replace(header=header, tables={"run-0": carrier.tables["run-0"]})
    recording = nominals.quick(nominals.load_recording(write_carrier(one, tmp_path / "rig")))
    trials = (records.SATURATION, ("damper.gas_spring", {}, {"preload": 50.0}))
    found, kept = nominals.identify(recording, carrier.nominal, ("damper.c_a",), trials)
    assert kept == ["damper.gas_spring"]
    assert found.nominal["effects"][0]["parameters"]["preload"] == pytest.approx(60.0, rel=0.01)
    assert found.nominal["damper"]["parameters"]["c_a"] == pytest.approx(400.0, rel=0.02)


def test_the_joint_fit_names_the_offset_that_moved_most(benchmark, tmp_path):
    diagnose = benchmark("joint_fit").diagnose_by_joint_fit
    said = diagnose(write_carrier(offset(bench_carrier(), 60.0), tmp_path / "rig"))
    assert said["selected"] == ["sensor.bias"]
    nothing = diagnose(write_carrier(bench_carrier(), tmp_path / "sound"))
    assert (nothing["verdict"], nothing["causes"]) == ("none", [])
