"""Units in the spellings of loggers."""

import pytest

from seatsim.schema.errors import InputError
from seatsim.schema.units import CONVERSIONS, STANDARD_GRAVITY, conversion


@pytest.mark.parametrize(
    ("unit", "wanted", "value", "expected"),
    [
        ("g", "m/s^2", 1.0, STANDARD_GRAVITY), ("G", "m/s^2", 2.0, 2 * STANDARD_GRAVITY), ("m/s²", "m/s^2", 3.0, 3.0),
        ("m/s2", "m/s^2", 3.0, 3.0), ("m_s2", "m/s^2", 3.0, 3.0), ("mm/s^2", "m/s^2", 3.0, 0.003),
        ("ft/s^2", "m/s^2", 1.0, 0.3048), ("mm", "m", 5.0, 0.005), ("in", "m", 1.0, 0.0254), ("kN", "N", 1.5, 1500.0),
        ("daN", "N", 2.0, 20.0), ("lbf", "N", 1.0, 4.4482216), ("kp", "N", 1.0, 9.80665), ("mA", "A", 250.0, 0.25),
        ("°C", "degC", 21.0, 21.0), ("C", "degC", 21.0, 21.0), ("K", "degC", 293.15, 20.0),
        ("degF", "degC", 68.0, 20.0), ("°F", "degC", 212.0, 100.0), ("ms", "s", 2.0, 0.002), ("µs", "s", 2.0, 2e-6),
        ("[min]", "s", 2.0, 120.0), ("km/h", "m/s", 36.0, 10.0), ("mV", "V", 5.0, 0.005),
    ],
)  # fmt: skip
def test_a_unit_is_understood_as_it_is_spelt(unit, wanted, value, expected):
    factor, zero = conversion(unit, wanted)
    assert factor * value + zero == pytest.approx(expected, rel=1e-7, abs=1e-9)


@pytest.mark.parametrize(
    ("unit", "wanted", "expected"),
    [
        ("g", "m", "'g' is no unit of a value in m"), ("kn", "m/s^2", "no unit"), ("kNN", "N", "did you mean 'kN'"),
        ("", "N", "no unit"), ("1/", "N", "no unit"), ("m/s^2", "m", "such are m, mm, cm"),
    ],
)  # fmt: skip
def test_what_is_no_unit_of_the_quantity_is_an_error_that_lists_some(unit, wanted, expected):
    with pytest.raises(InputError, match=expected):
        conversion(unit, wanted)


@pytest.mark.parametrize("wanted", CONVERSIONS)
def test_usual_units_are_those_of_pint(wanted):
    for unit, found in CONVERSIONS[wanted].items():
        # A spelling that only pint knows, since the name itself is found without it.
        assert conversion(f" {unit}", wanted) == pytest.approx(found, rel=1e-12)
