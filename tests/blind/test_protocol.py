"""Nothing of a case but its signals depends on its label: protocol, header, nominal, order, digits."""

import gzip
from collections.abc import Mapping
from functools import partial

import numpy as np
import pytest

from seatsim.blind.carrier.make import draw_changes
from seatsim.blind.carrier.recorded import encode_carrier, read_carrier
from seatsim.blind.make.cases import CaseSpecification, compose, draw_case
from seatsim.blind.make.make import nominal_scenario, recording_header
from seatsim.blind.sealed import EFFECTS
from seatsim.blind.truth.rig import EXCITATION_RATE

from .carriers import bench_carrier, seat_carrier, write_carrier


def told(experiment):
    """Return what the folder of a case tells beside its signals, and how each run starts and is driven."""
    runs = experiment.runs[:-1]
    starts = [(run.temperature, run.law[0], run.schedule[0]) for run in runs]
    sizes = [(run.schedule.size, float(np.std(run.floor))) for run in runs]
    return {
        "header": recording_header(experiment, runs),
        "nominal": nominal_scenario(experiment),
        "protocol": [starts, sizes],
        "heat": [experiment.true[name] for name in ("fluid_heat", "housing_heat", "thermometer_time")],
        "seconds": [run.floor.size / EXCITATION_RATE for run in runs],
    }


def numbers(value, key=""):
    """Return nested values as numbers by their place; a word is the place of a one."""
    if isinstance(value, Mapping):
        parts = [numbers(item, f"{key}.{name}") for name, item in value.items()]
    elif isinstance(value, list | tuple):
        parts = [{key: float(len(value))}, *(numbers(item, f"{key}[{k}]") for k, item in enumerate(value))]
    elif isinstance(value, str):
        return {f"{key}={value}": 1.0}
    else:
        return {key: float(value)}
    return {name: number for part in parts for name, number in part.items()}


def best_stump(features, hits):
    """Return the feature, limit and sign with the largest difference between the shares above the limit."""
    best = (-1.0, (0, 0.0, 1.0))
    for k in range(features.shape[1]):
        for limit in np.unique(np.quantile(features[:, k], np.linspace(0.02, 0.98, 25))):
            above = features[:, k] > limit
            difference = np.mean(above[hits]) - np.mean(above[~hits])
            best = max(best, (abs(difference), (k, float(limit), float(np.sign(difference)))))
    return best[1]


@pytest.mark.slow
@pytest.mark.parametrize(("kinds", "cases"), [("mixed", 2000), ("varied", 1200)])
def test_a_classifier_of_all_but_the_signals_stays_at_chance(kinds, cases, monkeypatch):
    monkeypatch.setattr("seatsim.blind.make.draw_experiment._add_background", lambda experiment, _: experiment)
    orders = compose(cases, kinds, np.random.default_rng(1))
    rows = [numbers(told(order.draw_rig(np.random.default_rng([1, k])))) for k, order in enumerate(orders)]
    names = sorted({name for row in rows for name in row})
    features = np.array([[row.get(name, 0.0) for name in names] for row in rows])
    half = np.arange(cases) < cases // 2
    for effect in [*EFFECTS, ""]:
        hits = np.array([effect in order.names if effect else not order.names for order in orders])
        k, limit, sign = best_stump(features[half], hits[half])
        above = sign * (features[~half, k] - limit) > 0.0
        share, others = np.mean(above[hits[~half]]), np.mean(above[~hits[~half]])
        chance = np.sqrt(0.25 / np.sum(hits[~half]))
        assert share - others < 4.0 * chance, f"{names[k]} tells {effect or 'a faultless rig'}"


def test_the_same_draw_gives_the_same_folder_whatever_the_effect():
    for seed, varied in ((0, False), (3, True)):
        found = []
        for effect in ("damper.thermal_fade", "damper.free_play"):
            case = draw_case(CaseSpecification("one", (effect,), varied=varied), np.random.default_rng(seed))
            found.append(told(case.experiment))
        assert found[0] == found[1]


def test_an_effect_that_the_damper_cannot_have_gives_way_to_another():
    order = CaseSpecification("one", ("damper.preyield_hysteresis",))
    cases = [draw_case(order, np.random.default_rng(seed)) for seed in range(4)]
    effects = {case.experiment.is_bingham: case.label()["effects"] for case in cases}
    assert effects[True] == ["damper.preyield_hysteresis"] and effects[False] != effects[True]


@pytest.mark.parametrize("make", [partial(bench_carrier, logged_coil=True), seat_carrier], ids=["bench", "seat"])
def test_a_change_of_a_carrier_alters_no_file_but_its_signals(make, tmp_path):
    carrier = make()
    tables = carrier.tables.items()
    rounded = {run: {name: np.round(values, 4) for name, values in table.items()} for run, table in tables}
    read = read_carrier(write_carrier(carrier._replace(tables=rounded), tmp_path / "carrier"))
    runs = tuple(read.tables)
    before = encode_carrier(read, runs)
    for change in draw_changes(read, np.random.default_rng(0)):
        after = encode_carrier(change.alter(0.3 * change.largest).carrier, runs)
        assert list(after) == list(before)
        for name, content in after.items():
            kept = bytes if name.endswith(".yaml") else digits
            assert kept(content) == kept(before[name]), change.form


def digits(table):
    """Return how many digits after the point each column of a table has, but its time."""
    rows = [line.split(",")[1:] for line in gzip.decompress(table).decode().splitlines()[1:]]
    return [{len(cell.partition(".")[2]) for cell in column} for column in zip(*rows, strict=True)]
