"""What a scenario leaves, by channel and band: against signals whose bands are known."""

import numpy as np
import pytest

from seatsim.recordings.model_error import (
    BANDS,
    LARGEST_RATIO,
    band_edges,
    band_powers,
    band_widths,
    measure_model_error,
    read_model_error,
)
from seatsim.schema.content import to_content
from seatsim.schema.errors import InputError

RATE, N = 200.0, 4000
TIME = np.arange(N) / RATE


def tone(frequency, amplitude=1.0):
    return amplitude * np.sqrt(2.0) * np.sin(2.0 * np.pi * frequency * TIME)


def test_bands_are_octaves_and_their_powers_add_up_to_the_mean_square():
    edges = band_edges(64.0)
    assert edges[2:].tolist() == [1.0, 2.0, 4.0, 8.0, 16.0, 32.0] and len(edges) == BANDS + 1
    assert edges[0] == 0.0 < edges[1] < 1e-9
    for count in (N, N - 1):
        values = np.random.default_rng(1).standard_normal(count) + 3.0
        assert np.sum(band_powers(values, RATE, edges)) == pytest.approx(np.mean(values**2))
    assert band_powers(tone(3.0) + 0.5, RATE, edges) == pytest.approx([0.25, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0])
    assert np.sum(band_widths(RATE, edges)) == pytest.approx(1.0)
    assert band_widths(RATE, edges)[-1] == pytest.approx(0.68)


def test_the_error_is_what_is_left_over_what_was_measured_band_by_band():
    measured, simulated = tone(3.0, 2.0) + tone(10.0), tone(3.0, 1.8) + tone(10.0, 0.5)
    found = measure_model_error([("a", {"x": measured}, {"x": simulated})], {"x": 0.0}, RATE, 64.0)
    assert found.error["x"][0, [3, 5]] == pytest.approx([0.1, 0.5])
    assert found.pooled["x"][[3, 5]] == pytest.approx([0.1, 0.5])
    assert found.ratio["x"][[3, 5]] == pytest.approx([2.0 / 1.8, 2.0])
    assert found.predict_amplitude("x", simulated, RATE)[[3, 5]] == pytest.approx([4.0, 1.0])
    assert found.predict_remainder("x", simulated, RATE) == pytest.approx(np.full((2, 1), 0.04 + 0.25), rel=1e-6)
    # A band without a signal is taken to be as all are.
    assert found.error["x"][0, 7] == pytest.approx(np.sqrt((0.04 + 0.25) / 5.0))
    # Another excitation, twice as strong at 3 Hz and without 10 Hz, is missed in proportion, or by as much as before.
    assert found.predict_remainder("x", tone(2.5, 3.6), RATE)[:, 0] == pytest.approx([0.16, 0.04 + 0.25])


def test_a_missed_mean_counts_relative_to_the_whole_channel():
    measured, simulated = tone(3.0, 2.0) + 1.0, tone(3.0, 2.0)
    found = measure_model_error([("a", {"x": measured}, {"x": simulated})], {"x": 0.0}, RATE, 64.0)
    assert found.pooled["x"] == pytest.approx([0.5, *[0.0] * 7], abs=1e-6)
    assert found.predict_remainder("x", tone(0.5, 4.0), RATE)[:, 0] == pytest.approx([4.0, 1.0])
    assert found.predict_amplitude("x", tone(0.5, 4.0), RATE)[:2] == pytest.approx([16.0, 16.0])


def test_stated_noise_is_no_error_and_a_silent_band_has_none():
    noise = 0.1 * np.random.default_rng(2).standard_normal(N)
    measured = tone(3.0) + noise
    found = measure_model_error([("a", {"x": measured}, {"x": tone(3.0)})], {"x": 0.1}, RATE, 64.0)
    assert found.pooled["x"][3] < 0.02
    silent = measure_model_error([("a", {"x": np.zeros(N)}, {"x": tone(3.0)})], {"x": 0.1}, RATE, 64.0)
    assert np.all(silent.pooled["x"] == 0.0) and silent.ratio["x"][3] == 1.0 / LARGEST_RATIO


def test_it_is_read_as_it_was_written_and_refused_where_it_is_not_there():
    pairs = [(run, {"x": tone(3.0, 2.0)}, {"x": tone(3.0, size)}) for run, size in (("a", 1.5), ("b", 1.9))]
    found = measure_model_error(pairs, {"x": 0.01}, RATE, 64.0)
    again = read_model_error({"model_error": to_content(found)}, "diagnosis.json")
    assert again.runs == ("a", "b") and again.noise == {"x": 0.01}
    assert np.array_equal(again.edges, found.edges) and np.array_equal(again.error["x"], found.error["x"])
    assert np.array_equal(again.ratio["x"], found.ratio["x"]) and np.array_equal(again.pooled["x"], found.pooled["x"])
    for content in ({}, {"model_error": None}, {"model_error": {"bands": [[0.0, 1.0]]}}):
        with pytest.raises(InputError, match=r"diagnosis\.json: states no model_error"):
            read_model_error(content, "diagnosis.json")
