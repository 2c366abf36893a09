"""Measured floors and roads from tables."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from scipy.fft import irfft
from scipy.signal import welch

from seatsim.excitations.recording import Table
from seatsim.excitations.road import LONGEST, SHORTEST, Road, _road
from seatsim.schema.errors import InputError

ROOT = Path(__file__).parents[2]
MEASURED = ROOT.parent / "shared" / "data"
SHIPPED = ROOT / "scenarios" / "data" / "road-profile.csv"
needs_data = pytest.mark.skipif(not MEASURED.is_dir(), reason="measured data beside the repository are absent")


def tones(t):
    """Acceleration, velocity and displacement of two tones."""
    parts = [(1.2, 2 * np.pi * 1.5, 0.3), (0.7, 2 * np.pi * 6.0, 1.1)]
    a = sum(k * np.cos(w * t + p) for k, w, p in parts)
    v = sum(k / w * np.sin(w * t + p) for k, w, p in parts)
    d = sum(-k / w**2 * np.cos(w * t + p) for k, w, p in parts)
    return a, v, d


@pytest.fixture
def write(tmp_path):
    def file(name="t.csv", **columns):
        pd.DataFrame(columns).to_csv(tmp_path / name, index=False)
        return str(tmp_path / name)

    return file


def profile(road_class, length, spacing, seed):
    """Distance and elevation in m of a random road; samples hardly tell waves shorter than 2.5 spacings from others."""
    count = round(length / spacing) + 1
    size = max(count - 1, round(5 / LONGEST / spacing))
    spectrum = _road(road_class, size * spacing, min(SHORTEST, 0.4 / spacing), seed)
    return spacing * np.arange(count), np.resize(irfft(spectrum, n=size, norm="forward"), count)


def road_table(write, length, spacing, **keys):
    """A table of a road of class C, driven over at 10 m/s."""
    distance, elevation = profile("C", length, spacing, 4)
    path = write(distance_m=distance, elevation_m=elevation)
    return Table(path, "elevation_m", distance_column="distance_m", speed=10.0, **keys)


def test_measured_acceleration_is_resampled_and_integrated(write):
    t = np.arange(0, 60.0001, 0.004)
    path = write("t.csv.gz", time_s=t, az=9.81 + 0.3 + tones(t)[0])
    floor = Table(path, "az", time_column="time_s").floor(0.001, 0)
    assert len(floor.time) == 60001
    inner = slice(20000, 40000)
    for got, expected in zip((floor.acceleration, floor.velocity, floor.displacement), tones(floor.time), strict=True):
        assert np.abs(got - expected)[inner].max() < 0.005 * np.abs(expected).max()


def test_drift_and_frequencies_outside_the_band_are_removed(write):
    t = np.arange(0, 100, 0.002)
    slow, fast = 0.2 * np.sin(2 * np.pi * 0.01 * t), np.sin(2 * np.pi * 120 * t)
    floor = Table(write(time_s=t, az=slow + fast), "az", time_column="time_s").floor(0.001, 0)
    assert np.abs(floor.acceleration[5000:-5000]).max() < 0.02 * 0.2
    # Plain integration of the slow part would sway by 0.2/(2 pi 0.01)^2 = 51 m.
    assert np.abs(floor.displacement).max() < 0.05


def test_road_over_distance_agrees_with_the_random_road_it_came_from(write):
    floor = road_table(write, 600.0, 0.05).floor(0.002, 0)
    expected = Road("C", 10.0, 60.0).floor(0.002, 4)
    f, got = welch(floor.acceleration[1000:], 500, nperseg=4096)
    _, want = welch(expected.acceleration[1000:], 500, nperseg=4096)
    band = (f > 0.8) & (f < 15)
    assert got[band].sum() == pytest.approx(want[band].sum(), rel=0.03)
    error = (floor.acceleration - expected.acceleration)[3000:-3000]
    assert error.std() < 0.05 * expected.acceleration.std()


def test_coarse_profile_gives_no_content_that_it_cannot_hold(write):
    floor = road_table(write, 400.0, 0.25, through="direct").floor(0.001, 0)
    f, density = welch(floor.acceleration[1000:], 1000, nperseg=8192, window="blackmanharris")
    assert density[f > 1.05 * 1.6 * 10].max() < 1e-6 * density.max()


def test_mirror_plays_the_record_backwards(write):
    made = road_table(write, 100.0, 0.1, through="direct", duration=18.0)
    with pytest.raises(InputError, match="exceeds the record's 10 s; shorten it, or set repeat: mirror"):
        made.floor(0.001, 0)
    floor = made._replace(repeat="mirror").floor(0.001, 0)
    forth, back = floor.displacement[2000:10001], floor.displacement[18000:9999:-1]
    np.testing.assert_allclose(back, forth, atol=1e-12)


def test_start_leaves_out_the_beginning(write):
    t = np.arange(0, 30, 0.004)
    a = tones(t)[0]
    a[:100] += 50.0
    floor = Table(write(time_s=t, az=a), "az", time_column="time_s", start=2.0, duration=20.0).floor(0.001, 0)
    assert np.abs(floor.acceleration).max() < 2.5
    np.testing.assert_allclose(floor.acceleration[8000:9000], tones(2.0 + floor.time)[0][8000:9000], atol=0.05)


def test_shipped_profile_is_generated_by_seed_8608():
    """Regenerate with the lines below: class C, 300 m every 0.25 m, elevation to 0.01 mm."""
    distance, elevation = profile("C", 300.0, 0.25, 8608)
    rows = [f"{s:.2f},{z:.5f}" for s, z in zip(distance, elevation, strict=True)]
    assert SHIPPED.read_text() == "\n".join(["distance_m,elevation_m", *rows]) + "\n"


def bad_tables(write, tmp_path):
    t = np.arange(100) * 0.01
    gap = np.delete(t, 50)
    (tmp_path / "empty.csv").write_text("")
    (tmp_path / "binary.csv.gz").write_bytes(b"not gzip at all")
    (tmp_path / "words.csv").write_text("t,a\n" + "".join(f"{k},{'much' if k == 3 else 1}\n" for k in range(20)))
    nan = np.where(t == t[7], np.nan, 1.0)
    return {
        r"no such file.*did you mean 'empty.csv'": str(tmp_path / "emty.csv"),
        "the file is empty": str(tmp_path / "empty.csv"),
        "cannot be read as a table: its name ends in .gz": str(tmp_path / "binary.csv.gz"),
        r"no column 'a'.*columns: t, acc_z": write("column.csv", t=t, acc_z=t),
        r"line 5, a: 'much'": str(tmp_path / "words.csv"),
        r"line 9, a: 'nan' is not a finite number": write("nan.csv", t=t, a=nan),
        "10 rows are too few; permitted: at least 16": write("short.csv", t=t[:10], a=t[:10]),
        "line 12: column 't' does not grow": write("back.csv", t=np.where(t == t[10], 0.0, t), a=t),
        "even steps.*resample": write("gap.csv", t=gap, a=gap),
    }


def test_unusable_tables_are_refused_with_place_and_advice(write, tmp_path):
    for message, path in bad_tables(write, tmp_path).items():
        with pytest.raises(InputError, match=message):
            Table(path, "a", time_column="t").floor(0.001, 0)


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({}, "either time_column or distance"),
        ({"time_column": "t", "distance_column": "t"}, "either time_column or distance"),
        ({"distance_column": "t"}, "needs speed"),
        ({"time_column": "t", "speed": 3.0}, "speed belongs to distance_column"),
        ({"time_column": "t", "start": 2.9}, "leaves fewer than 16 rows"),
        ({"time_column": "t", "duration": 4.0}, "repeat: mirror"),
    ],
)
def test_keys_that_do_not_fit_are_refused(write, keys, message):
    t = np.arange(300) * 0.01
    with pytest.raises(InputError, match=message):
        Table(write(t=t, a=np.sin(9 * t)), "a", **keys).floor(0.001, 0)


def test_too_coarse_a_step_is_refused(write):
    t = np.arange(3000) * 0.002
    with pytest.raises(InputError, match=r"too coarse for its 80 Hz; permitted: at most 0.0025 s"):
        Table(write(t=t, a=np.sin(9 * t)), "a", time_column="t").floor(0.005, 0)


@needs_data
@pytest.mark.parametrize("through", ["vehicle", "direct"])
def test_measured_profile_at_a_quarter_metre(through):
    path = str(MEASURED / "roads" / "profile_1.csv.gz")
    made = Table(path, "elevation_m", distance_column="distance_m", speed=10.0, through=through)
    floor = made.floor(0.001, 0)
    assert len(floor.time) == 54401
    assert np.abs(floor.displacement).max() < 0.06
    # Raised markers stand at 1 m and 543 m; between them the road is smooth.
    rms = np.sqrt(np.mean(floor.acceleration[3000:-3000] ** 2))
    assert 0.2 < rms < 2.5


@needs_data
def test_bus_floor_loses_gravity_and_keeps_its_band():
    path = MEASURED / "bus_floor" / "L3_Pionierska_RacianskeMyto.csv.gz"
    floor = Table(str(path), "acc_z_m_s2", time_column="time_s", start=5.0).floor(0.001, 0)
    raw = pd.read_csv(path)["acc_z_m_s2"].to_numpy()[2500:]
    f, got = welch(floor.acceleration[1000:], 1000, nperseg=16384)
    g, want = welch(raw - raw.mean(), 500, nperseg=8192)
    got_band = got[(f > 1) & (f < 50)].sum() * f[1]
    assert got_band == pytest.approx(want[(g > 1) & (g < 50)].sum() * g[1], rel=0.02)
    assert abs(floor.acceleration.mean()) < 0.01
    assert np.abs(floor.displacement).max() < 0.1
