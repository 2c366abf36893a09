"""The nine weightings against the printed factors of ISO 8041-1:2017, Annex B, every third one-third octave.

The factors are those that the tests of phonometry 3.3 state as transcribed from the standard.
"""

import pytest

from seatsim.metrics.weighting import WEIGHTINGS, frequency_response

from ..text import beside, parse

LOWEST = {"Wf": -17, "Wh": -1}
"""Band of the first factor; band n has the centre 10^(n/10) Hz; -10 where none is listed."""
FACTORS = parse(beside(__file__, "weighting_factors.yaml"))


def test_every_weighting_has_factors():
    assert set(FACTORS) == set(WEIGHTINGS)


@pytest.mark.parametrize("weighting", FACTORS)
def test_factors_are_the_published_ones(weighting, conform):
    for k, factor in enumerate(FACTORS[weighting]):
        band = LOWEST.get(weighting, -10) + 3 * k
        found = abs(frequency_response(10 ** (band / 10), weighting))
        # Four printed digits: half a unit of the last is 5e-4 of a factor that begins with 1.
        claim = f"{weighting}, factor at {10 ** (band / 10):.4g} Hz"
        conform(claim, "ISO 8041-1:2017, annex B, as phonometry 3.3 has it", found, factor, tolerance=7e-4 * factor)
