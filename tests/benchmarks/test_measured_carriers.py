"""Cases on measured recordings: how they are counted, nominals that hold mechanisms, and the joint fit beside them."""

import pytest

from seatsim.blind.carrier.recorded import read_carrier
from seatsim.blind.sealed import Sealed, new_key, seal, unseal

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


def test_a_nominal_that_lacks_a_mechanism_of_its_rig_has_it_in_the_label(benchmark, tmp_path):
    carriers, key = benchmark("measured_carriers"), new_key()
    held = (
        ("damper.gas_spring", {"preload": 60.0}),
        ("damper.asymmetry", {"viscous": 1e-4}),
        ("sensor.lag", {"time": 0.1}),
    )
    effects = [{"effect": effect, "parameters": values} for effect, values in held]
    effects[2]["parameters"]["channel"] = "damper_force"
    rig = offset(bench_carrier(), 60.0)
    rig = rig._replace(nominal={**rig.nominal, "effects": effects})
    assert carriers.list_mechanisms(write_carrier(rig, tmp_path / "rig")) == ["damper.gas_spring"]
    folder, sealed = tmp_path / "cases", tmp_path / "cases.sealed"
    nominal = {case: write_carrier(rig, folder / case) / "nominal.yaml" for case in ("whole", "biased")}["whole"]
    labels = {
        "whole": {"kind": "untouched", "effects": [], "blocks": []},
        "biased": {"kind": "carried", "effects": ["sensor.bias"], "blocks": ["sensor"]},
    }
    seal(sealed, folder, key, Sealed(labels, {"whole": {"nominal.yaml": nominal.read_bytes()}}, {}))
    carriers.take_out(["damper.gas_spring"], folder, sealed, key)
    found = unseal(sealed, key, folder)
    assert [entry["effect"] for entry in read_carrier(folder / "biased").nominal["effects"]] == [
        "damper.asymmetry", "sensor.lag"
    ]  # fmt: skip
    assert found.unseen["whole"]["nominal.yaml"] == nominal.read_bytes()
    assert found.labels == {
        "whole": {"kind": "carried", "effects": ["damper.gas_spring"], "blocks": ["damper"]},
        "biased": {"kind": "carried", "effects": ["damper.gas_spring", "sensor.bias"], "blocks": ["damper", "sensor"]},
    }
