"""Weighted signals have the gain and the phase of the analog filters, whose factors `weighting_factors` compares."""

import math
from functools import cache

import numpy as np
import pytest

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


def test_continues_smoothly_at_zero_frequency():
    assert frequency_response(0.0) == 0
    assert frequency_response(np.zeros((2, 3))).shape == (2, 3)


@pytest.mark.parametrize("rate", [100.0, 199.0, 0.0, -500.0, math.nan, math.inf])
def test_refuses_a_rate_it_cannot_serve(rate):
    with pytest.raises(InputError, match="sample_rate"):
        weight(np.ones(100), rate)


def test_names_the_weightings_it_has():
    with pytest.raises(InputError, match=r"did you mean 'Wk'.*permitted: Wk, Wd"):
        weight(np.ones(10), 500.0, "Wkk")
