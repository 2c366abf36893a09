"""The card of structural isolability against a published analysis, and its sentences.

The table is that of section 3.1 of the reference on diagnosis (faultdiagnosistoolbox 0.12.5); its `plant` is our
suspension, and the floor's unmeasured input enters the same force balance.
"""

import pytest

from seatsim.diagnosis.design.isolability import describe_missing_sensors, find_isolable_groups

from ..text import words

ALL = set(
    words("""
    floor_acceleration frame_acceleration driver_acceleration suspension_displacement damper_force coil_current
    current_command
""")
)
TABLE = [
    ((), []),
    (("damper_force",), [{"damper", "suspension"}]),
    (("coil_current",), [{"damper", "coil"}]),
    (("driver_acceleration",), [{"suspension", "cushion", "driver"}]),
    (("suspension_displacement",), []),
    (("floor_acceleration",), []),
    (("frame_acceleration",), []),
    (("damper_force", "coil_current"), [{"damper", "coil", "suspension"}]),
    (("damper_force", "driver_acceleration"), [{"damper", "suspension", "cushion", "driver"}]),
    (("damper_force", "suspension_displacement"), [{"damper", "suspension", "sensor"}]),
    (("damper_force", "coil_current", "driver_acceleration"), [{"damper", "coil", "suspension", "cushion", "driver"}]),
]


@pytest.mark.parametrize(("absent", "merged"), TABLE)
def test_the_groups_are_those_of_the_published_table(absent, merged):
    groups = [set(group) - {"floor"} for group in find_isolable_groups("seat", ALL - set(absent))]
    assert [group for group in groups if len(group) > 1] == merged
    assert set().union(*groups) == {"damper", "coil", "suspension", "cushion", "driver", "sensor"}
    assert sum(map(len, groups)) == 6


def test_the_temperature_changes_no_group():
    assert find_isolable_groups("seat", ALL | {"damper_temperature"}) == find_isolable_groups("seat", ALL)


@pytest.mark.parametrize(
    ("absent", "sentence"),
    [
        ("damper_force", "without damper_force, damper and suspension cannot be distinguished: add a load cell"),
        ("coil_current", "without coil_current, damper and coil cannot be distinguished: log the current"),
        ("current_command", "coil cannot be assessed: log the commanded current"),
        ("driver_acceleration", "suspension, cushion and driver cannot be distinguished: add an accelerometer"),
    ],
)
def test_a_missing_channel_and_its_remedy_are_one_sentence(absent, sentence):
    assert any(sentence in said for said in describe_missing_sensors("seat", ALL - {absent}))


def test_a_full_seat_lacks_nothing_but_the_floor_against_the_suspension():
    (sentence,) = describe_missing_sensors("seat", ALL)
    assert sentence.startswith("suspension and floor cannot be distinguished by any channel")
