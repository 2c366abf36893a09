"""Isolable groups of channels against a published analysis, ranks of the equations, and groups derived by hand.

A test is a set of equations with one unknown less than equations; a block that is in no test leaves no trace, and two
blocks are told apart where a test holds one of them and not the other.
"""

import itertools

import numpy as np
import pytest

from seatsim.diagnosis.design.isolability import describe_missing_sensors, find_isolable_groups

from ...text import parse, words

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
"""Channels that are absent, and blocks that then fall together: section 3.1 of the reference on diagnosis
(faultdiagnosistoolbox 0.12.5); its `plant` is our suspension, and the floor's unmeasured input enters the same balance.
"""


@pytest.mark.parametrize(("absent", "merged"), TABLE)
def test_the_groups_are_those_of_the_published_table(absent, merged):
    groups = [set(group) - {"floor"} for group in find_isolable_groups("seat", ALL - set(absent))]
    assert [group for group in groups if len(group) > 1] == merged
    assert set().union(*groups) == {"damper", "coil", "suspension", "cushion", "driver", "sensor"}
    assert sum(map(len, groups)) == 6


@pytest.mark.parametrize(
    ("channels", "groups"),
    [
        # x gives v, and without a command the current is stated: all of Fd = F(x, v, i) is known.
        ({"displacement", "damper_force"}, [["damper", "coil", "sensor"]]),
        # The coil's equation needs a current that is measured: with the command it is a test of its own.
        ({"coil_current", "current_command"}, [["coil", "sensor"]]),
        # Without a command the measured current tests nothing.
        ({"coil_current"}, []),
        ({"displacement", "velocity"}, [["sensor"]]),
        # The two sensors of the motion check each other, so that one more block is told from sensors.
        ({"displacement", "velocity", "damper_force"}, [["damper", "coil", "sensor"]]),
        ({"damper_force"}, []),
    ],
)
def test_groups_of_a_bench_by_hand(channels, groups):
    assert find_isolable_groups("damper_bench", channels) == groups


LINES = [
    ("floor", "frame_acc spring cushion_force damper"),
    ("suspension", "spring x v"),
    ("driver", "driver_acc cushion_force"),
    ("cushion", "cushion_force xc vc"),
    ("damper", "damper x v i"),
    ("", "x v"),
    ("", "v frame_acc floor_acc"),
    ("", "xc vc"),
    ("", "vc driver_acc frame_acc"),
]
"""The seat once more: force balance of frame and driver, laws of spring, cushion and damper, and derivatives."""
MEASURED = parse("""
    {floor_acceleration: floor_acc, frame_acceleration: frame_acc, driver_acceleration: driver_acc,
     suspension_displacement: x, damper_force: damper, coil_current: i}
""")


def group_by_rank(channels):
    """Return the groups of blocks but sensors, by ranks of the equations with random coefficients.

    An equation is in a test where the others have the rank of all, and apart from another where that holds without it.
    """
    lines = LINES + ([("coil", "i")] if "current_command" in channels or "coil_current" not in channels else [])
    lines += [("sensor", MEASURED[name]) for name in channels if name in MEASURED]
    unknowns = sorted({name for _, names in lines for name in names.split()})
    matrix = np.array([[name in names.split() for name in unknowns] for _, names in lines], dtype=float)
    matrix *= np.random.default_rng(1).uniform(1.0, 2.0, matrix.shape)

    def is_tested(k, without=()):
        left = [row for row in range(len(lines)) if row not in without]
        return np.linalg.matrix_rank(matrix[[row for row in left if row != k]]) == np.linalg.matrix_rank(matrix[left])

    blocks = {block: k for k, (block, _) in enumerate(lines) if block not in ("", "sensor")}
    tested = [block for block, k in blocks.items() if is_tested(k)]
    together = {a: frozenset(b for b in tested if not is_tested(blocks[a], (blocks[b],)) or a == b) for a in tested}
    return set(together.values())


@pytest.mark.parametrize("size", range(1, 8))
def test_groups_are_those_of_ranks_of_the_seats_equations(size):
    for channels in itertools.combinations([*MEASURED, "current_command"], size):
        found = {frozenset(group) - {"sensor"} for group in find_isolable_groups("seat", channels)} - {frozenset()}
        assert found == group_by_rank(channels), channels


BY_FORM = "cannot be distinguished by any channel: only the form of an effect, or a repeat of a run, can"
NEVER = f"damper and sensor {BY_FORM}"


@pytest.mark.parametrize(("further", "sentences"), [
    # A stated current is the coil's: neither its log alone nor a command alone parts the two.
    ("damper_force", []),
    ("damper_force coil_current", ["without current_command, coil cannot be assessed: log the commanded current"]),
    # With a load cell the sensor of the current checks damper and coil, so that it is told from the coil.
    ("coil_current current_command", ["without damper_force, sensor and coil cannot be distinguished and damper cannot"
                                      " be assessed: add a load cell at the damper"]),
    ("damper_force coil_current current_command", []),
    ("damper_force command_voltage", ["without coil_current, damper or sensor and coil cannot be distinguished: log the"
                                      " current of the coil"]),
])  # fmt: skip
def test_sentences_on_a_bench(further, sentences):
    assert describe_missing_sensors("damper_bench", {"displacement", *further.split()}) == [*sentences, NEVER]


def test_a_full_seat_lacks_nothing_but_the_floor_against_the_suspension():
    (sentence,) = describe_missing_sensors("seat", ALL)
    assert sentence == f"suspension and floor {BY_FORM}"


def test_a_seat_without_the_driver_lists_what_cannot_be_told_and_what_cannot_be_judged():
    load_cell, driver, floor = describe_missing_sensors("seat", ALL - {"driver_acceleration", "damper_force"})
    said = "without {}, {} cannot be distinguished: add {}".format
    blocks = "damper and suspension or cushion or driver", "damper or suspension, cushion and driver"
    assert load_cell == said("damper_force", blocks[0], "a load cell at the damper")
    assert driver == said("driver_acceleration", blocks[1], "an accelerometer at the driver")
    assert floor == f"suspension and floor {BY_FORM}"
