"""Frequency weightings against the standard's table, the analog response and an oversampled filter."""

import math
from functools import cache

import numpy as np
import pytest
from scipy import signal as sp

from seatsim.metrics.weighting import WEIGHTINGS, frequency_response, weight
from seatsim.schema.errors import InputError

from ..text import beside, parse

EXACT = 10 ** (np.arange(-3, 20) / 10)
NOMINAL, WK, WD = np.array(parse(beside(__file__, "weighting_table.yaml"))).T * [[1.0], [1e-3], [1e-3]]
RATES = (200.0, 500.0, 1000.0, 10000.0)


@cache
def sines(frequencies, sample_rate):
    """Sum of sines over 14 s; where the start is forgotten, at 200 Hz or more; and each sine and cosine there."""
    time = np.arange(int(14 * sample_rate)) / sample_rate
    phase = 2 * np.pi * np.outer(frequencies, time)
    middle = slice(int(8 * sample_rate), int(13 * sample_rate), max(1, int(sample_rate / 200)))
    return np.sin(phase).sum(axis=0), middle, np.vstack((np.sin(phase[:, middle]), np.cos(phase[:, middle]))).T


def measured_gains(frequencies, sample_rate, weighting, scale=1.0):
    """Complex gains of `weight` for sines, which are fitted to what it makes of their sum; all are over `scale`."""
    signal, middle, basis = sines(tuple(frequencies / scale), sample_rate / scale)
    in_phase, quadrature = np.split(np.linalg.lstsq(basis, weight(signal, sample_rate, weighting)[middle])[0], 2)
    return in_phase + 1j * quadrature


@pytest.mark.parametrize(("weighting", "table"), [("Wk", WK), ("Wd", WD)])
def test_formula_reproduces_the_table_at_its_nominal_frequencies(weighting, table, conform):
    for frequency, factor in zip(NOMINAL, table, strict=True):
        # The table's 212 at 10 Hz lies off the curve that its neighbours and the formula (202) follow.
        if (weighting, frequency) != ("Wd", 10):
            found = abs(frequency_response(frequency, weighting))
            claim = f"{weighting}, factor at the nominal {frequency:g} Hz"
            conform(claim, "ISO 2631-1:1997, table 3", found, factor, tolerance=4e-3 * factor)


@pytest.mark.parametrize("sample_rate", RATES)
def test_digital_weighting_meets_the_table(sample_rate, conform):
    gains = np.abs(measured_gains(NOMINAL, sample_rate, "Wk"))
    claim = f"Wk of signals at {sample_rate:g} Hz, greatest relative deviation of a factor"
    conform(claim, "ISO 2631-1:1997, table 3", np.max(np.abs(gains / WK - 1)), tolerance=5e-3)


@pytest.mark.parametrize("weighting", [name for name in WEIGHTINGS if name not in ("Wf", "Wh")])
@pytest.mark.parametrize("sample_rate", RATES)
def test_digital_gain_and_phase_are_the_analog_ones(sample_rate, weighting, conform):
    analog = frequency_response(EXACT, weighting)
    gains = measured_gains(EXACT, sample_rate, weighting)
    claim = f"{weighting} of signals at {sample_rate:g} Hz, greatest relative deviation of the complex gain"
    conform(claim, "the analog filter of the standard", np.max(np.abs(gains / analog - 1)), tolerance=1e-3)


@pytest.mark.parametrize(("weighting", "sample_rate", "bands"), [("Wf", 20.0, (-10, 0)), ("Wh", 2520.0, (9, 30))])
def test_weightings_of_other_bands_are_the_analog_ones_too(weighting, sample_rate, bands, conform):
    # Periods of the lowest tone: the slow poles of Wf are forgotten after a few.
    scale, frequencies = 10 ** (bands[0] / 10) / 2, 10 ** (np.arange(*bands) / 10)
    analog = frequency_response(frequencies, weighting)
    gains = measured_gains(frequencies, sample_rate, weighting, scale)
    claim = f"{weighting} of signals at {sample_rate:g} Hz, greatest relative deviation of the complex gain"
    conform(claim, "the analog filter of the standard", np.max(np.abs(gains / analog - 1)), tolerance=1e-3)


def analog_sections():
    """Wk once more, as second-order sections in Laplace form, written down independently."""
    w1, w2, w3, w5, w6 = (2 * math.pi * f for f in (0.4, 100.0, 12.5, 2.37, 3.35))
    root = math.sqrt(2)
    return (
        ([1, 0, 0], [1, root * w1, w1**2]),
        ([w2**2], [1, root * w2, w2**2]),
        ([w3, w3**2], [1, w3 / 0.63, w3**2]),
        ([1, w5 / 0.91, w5**2], [1, w6 / 0.91, w6**2]),
    )


def test_transient_agrees_with_an_oversampled_filter(conform):
    sample_rate, factor = 500.0, 64
    time = np.arange(0, 20, 1 / (factor * sample_rate))
    rng = np.random.default_rng(5)
    tones = zip(rng.uniform(0.3, 80, 40), rng.uniform(0, 2 * np.pi, 40), strict=True)
    fine = sum(np.sin(2 * np.pi * f * time + p) for f, p in tones) * np.clip(time, 0, 1)
    reference = fine
    for b, a in analog_sections():
        reference = sp.lfilter(*sp.bilinear(b, a, factor * sample_rate), reference)
    error = weight(fine[::factor], sample_rate) - reference[::factor]
    claim = "Wk of a transient at 500 Hz, RMS of the deviation over that of the signal"
    reference_of = "scipy.signal, bilinear sections at 64 times the rate"
    conform(claim, reference_of, np.sqrt(np.mean(error**2)) / reference.std(), tolerance=1e-3)


@pytest.mark.parametrize("rate", [100.0, 199.0, 0.0, -500.0, math.nan, math.inf])
def test_refuses_a_rate_it_cannot_serve(rate):
    with pytest.raises(InputError, match="sample_rate"):
        weight(np.ones(100), rate)


def test_names_the_weightings_it_has():
    with pytest.raises(InputError, match=r"did you mean 'Wk'.*permitted: Wk, Wd"):
        weight(np.ones(10), 500.0, "Wkk")
