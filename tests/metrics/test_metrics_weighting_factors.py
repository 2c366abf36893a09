"""The nine weightings against the printed factors of ISO 8041-1:2017, Annex B, every third one-third octave.

The factors are those that the tests of phonometry 3.3 state as transcribed from the standard.
"""

import pytest

from seatsim.metrics.weighting import WEIGHTINGS, frequency_response

from ..text import parse

LOWEST = {"Wf": -17, "Wh": -1}
"""Band of the first factor; band n has the centre 10^(n/10) Hz; -10 where none is listed."""
FACTORS = parse("""
    Wb: [0.02494, 0.09645, 0.28, 0.3808, 0.3916, 0.6653, 1.054, 0.9042, 0.5973, 0.3118, 0.1154, 0.01999, 0.002591]
    Wc: [0.06238, 0.2415, 0.7042, 0.9716, 1.006, 1.023, 0.9739, 0.6425, 0.3236, 0.1557, 0.05665, 0.009772, 0.001266]
    Wd: [0.06242, 0.242, 0.7097, 0.9914, 0.9707, 0.6398, 0.3226, 0.1597, 0.07958, 0.03872, 0.01414, 0.002442, 0.0003164]
    We: [0.06252, 0.2435, 0.7198, 0.9423, 0.6372, 0.3218, 0.1594, 0.07954, 0.03975, 0.01935, 0.007071, 0.001221,
        0.0001582]
    Wf: [0.02407, 0.09619, 0.4537, 1.004, 0.6149, 0.1157, 0.009705]
    Wh: [0.01586, 0.06314, 0.2461, 0.7272, 0.9576, 0.6471, 0.3244, 0.1602, 0.07988, 0.0398, 0.01862, 0.005359,
        0.0007878]
    Wj: [0.03099, 0.1199, 0.3489, 0.4776, 0.4832, 0.5246, 0.947, 1.026, 1.006, 0.972, 0.7075, 0.2437, 0.06297]
    Wk: [0.03121, 0.1207, 0.3504, 0.4767, 0.4935, 0.8071, 1.054, 0.8989, 0.5103, 0.2451, 0.08873, 0.01528, 0.001978]
    Wm: [0.01584, 0.06293, 0.243, 0.7003, 0.9342, 0.8721, 0.6692, 0.4114, 0.2203, 0.1093, 0.04013, 0.006937, 0.000899]
""")


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
