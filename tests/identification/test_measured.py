"""Measured benches, where they are beside the repository."""

import numpy as np
import pytest

from seatsim.identification.identify import identify
from seatsim.identification.settings import IdentificationSettings
from seatsim.recordings.bench_tables import load_bench

FOLDERS = {
    "utfsm_mr_sine_raw": (30, [0.0, 0.25, 0.5, 0.75, 1.0], False),
    "utfsm_mr_sine_preprocessed": (10, [0.0, 0.25, 0.5, 0.75, 1.0], False),
    "utfsm_mr_chirp": (3, [0.0, 0.5, 1.0], False),
    "utfsm_mr_earthquake": (5, [0.2, 0.4, 0.6, 0.8, 1.0], False),
    "dyke_nees_2012_1158": (1, [], True),
    "fsae_damper_temperature": (6, [0.0], False),
}


@pytest.mark.parametrize("folder", FOLDERS)
def test_every_bench_is_read(folder, shared):
    count, currents, commanded = FOLDERS[folder]
    records = load_bench(shared / "data" / folder)
    assert len(records) == count and len({record.name for record in records}) == count
    assert sorted({r.mean_current for r in records if np.ptp(r.current) == 0.0}) == currents
    assert all(record.commanded == commanded for record in records)
    assert all((record.temperature is not None) == folder.startswith("fsae") for record in records)
    for record in records:
        assert np.mean((record.force - np.mean(record.force)) * record.velocity) > 0.0, "a damper dissipates"
        assert np.max(np.abs(record.displacement)) < 0.06 and record.rate > 199.0


def test_a_bingham_damper_predicts_sines_that_were_held_out(shared):
    data = shared / "data"
    found = identify(data / "utfsm_mr_sine_raw", "bingham", IdentificationSettings(("*10mm_2Hz*", "*5mm_4Hz*")))
    assert 74.0 < found.train.fit_percent < 82.0 and 72.0 < found.test.fit_percent < 80.0
    assert 25.0 < found.bench.damper.f0 < 60.0, "the measured offset"
