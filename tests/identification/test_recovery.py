"""What is put in comes out: dampers, coils and temperatures of simulated benches; what data cannot tell is told."""

from pathlib import Path

import numpy as np
import pytest
from ruamel.yaml import YAML

import seatsim
from seatsim.identification.assessment import assess_fit
from seatsim.identification.identify import identify
from seatsim.identification.problem import BenchModel
from seatsim.identification.settings import IdentificationSettings as Settings
from seatsim.identification.settings import split_records
from seatsim.recordings.bench_tables import load_bench
from seatsim.rig.temperature import TemperatureFactors
from seatsim.schema.errors import InputError
from seatsim.schema.registry import find

from .benches import BINGHAM, BOUC_WEN, made, sines


def estimates(found):
    return {estimate.name: estimate for estimate in found.information.estimates}


@pytest.mark.parametrize("model, truth", [("bingham", BINGHAM), ("bouc_wen", BOUC_WEN)])
def test_a_damper_comes_back_within_5_percent(model, truth, conform):
    found = identify(sines(truth), model)
    known = estimates(found)
    assert set(known) == set(truth._fields) - {"v_ref", "A", "x0"} and found.notes == []
    for name, estimate in known.items():
        value = getattr(truth, name)
        claim = f"identified {model} with 2 % noise: {name}"
        conform(claim, "the damper that made the records", estimate.value, value, tolerance=0.05 * abs(value))
        assert estimate.identified and abs(estimate.value - value) < 4.0 * estimate.std, name
    assert found.train.fit_percent == pytest.approx(98.0, abs=0.1), "2 % noise"
    assert found.test is None and not found.warm and not found.commanded


def test_the_rates_of_a_coil_come_back_from_a_square_wave(conform):
    record = made(current=lambda t: np.where(t % 0.5 < 0.25, 0.0, 1.0), coil=(200.0, 60.0), noise=0.02, seconds=4.0)
    found = identify([record], "bingham", Settings(test_fraction=0.25))
    known = estimates(found)
    assert found.commanded
    for name, value in (("actuator.rate", 200.0), ("actuator.rate_fall", 60.0)):
        claim = f"identified coil with 2 % noise: {name}, 1/s"
        conform(claim, "the coil that made the record", known[name].value, value, tolerance=0.05 * value)
    assert found.test.fit_percent > 97.5


def test_temperature_factors_come_back_and_may_be_ignored():
    truth = TemperatureFactors(-0.004, 0.0, -0.008, 50.0)
    records = [
        made(current=i, temperature=warm, factors=truth, warming=0.5, noise=0.02, name=f"{warm:g}C_{i:g}A", seed=k)
        for k, (warm, i) in enumerate(((20.0, 0.0), (20.0, 1.0), (50.0, 1.0), (80.0, 0.0), (80.0, 1.0)))
    ]
    found = identify(records, "bingham")
    assert found.warm and found.bench.factors.reference == pytest.approx(50.0)
    assert found.bench.factors.viscous == pytest.approx(-0.004, rel=0.1)
    assert found.bench.factors.yield_force == pytest.approx(-0.008, rel=0.05)
    assert found.bench.offset_per_kelvin == pytest.approx(0.5, rel=0.05)
    assert found.bench.factors.stiffness == 0.0, "this damper has none: what has no influence keeps its default"
    assert found.notes == ["the data do not identify temperature_factors.stiffness"]
    cold = identify(records, "bingham", Settings(ignore_temperature=True))
    assert not cold.warm and cold.train.fit_percent < 90.0


def test_one_current_leaves_its_influence_unknown_and_the_rest_known():
    found = identify([made(current=0.5, noise=0.02)], "bingham")
    unknown = {name for name, estimate in estimates(found).items() if not estimate.identified}
    assert unknown == {"c_a", "c_b", "fc_a", "fc_b"}
    assert estimates(found)["f0"].identified


def test_the_example_was_made_with_the_damper_that_it_states():
    folder = Path(__file__).resolve().parents[2] / "scenarios" / "data" / "bench"
    truth = YAML(typ="safe").load((folder / "sine_10mm_2Hz.yaml").read_text())["made_with"]
    damper = BenchModel(find("damper", truth["model"])(**truth["parameters"]), TemperatureFactors())
    found = assess_fit(damper, split_records(load_bench(folder), Settings()), 0.0)
    assert len(found) == 9
    assert [each.agreement.fit_percent for each in found] == pytest.approx([99.0] * 9, abs=0.2)


def test_a_gas_force_of_many_standard_deviations_is_found():
    slow = BINGHAM._replace(f0=4000.0, c_a=200.0, fc_a=20.0)
    records = [made(slow, 0.01, 0.2, noise=0.02, seconds=8.0), made(slow, 0.005, 0.5, noise=0.02, seconds=8.0, seed=2)]
    assert all(np.mean(record.force) > 100.0 * np.std(record.force) for record in records)
    found = identify(records, "bingham")
    assert found.train.fit_percent > 97.0
    assert found.bench.damper.f0 == pytest.approx(4000.0, rel=1e-3)


def test_a_parameter_that_ends_at_a_bound_is_flagged():
    found = identify([record._replace(force=300.0 * record.force) for record in sines(BINGHAM)], "sigmoid")
    assert any(note.startswith("at the end of its range: ") for note in found.notes)


def test_bad_requests_are_refused(bench):
    with pytest.raises(InputError, match=r"no damper is called 'bignham' \(did you mean 'bingham'\?\)"):
        seatsim.identify(bench, "bignham")
    everything = {name: getattr(BINGHAM, name) for name in BINGHAM._fields}
    with pytest.raises(InputError, match="leaves no parameter of Bingham to fit"):
        seatsim.identify(bench, "bingham", Settings(fix=everything))
    still = [record._replace(velocity=0.0 * record.velocity) for record in sines(BINGHAM)]
    with pytest.raises(InputError, match="no motion or no force"):
        identify(still, "bingham")
