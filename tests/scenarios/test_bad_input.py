"""Fifty and more wrong scenario files: each one clear error with its place, exit status 2, nothing written."""

import json
from pathlib import Path

import pytest

from seatsim.scenario.describe import describe
from seatsim.scenario.loading import load
from seatsim.schema.errors import InputError, list_sentences

from ..text import beside, cases

GOOD = beside(__file__, "good.yaml")

# what is replaced, by what, and what the error must say
CASES = [
    *cases(beside(__file__, "wrong_scenarios.txt")),
    ("name: good", "\tname: good", ["line 1"]),
    (GOOD, "", ["holds no mapping"]),
    (GOOD, "- a\n- b\n", ["holds no mapping"]),
    (GOOD, "a: [1, 2\n", ["line"]),
]


@pytest.mark.parametrize(("old", "new", "expected"), CASES, ids=[str(n) for n in range(len(CASES))])
def test_a_wrong_file_is_one_clear_error(old, new, expected, here, seatsim_command):
    assert old in GOOD
    Path("wrong.yaml").write_text(GOOD.replace(old, new, 1))
    status, _, err = seatsim_command("run", "wrong.yaml", "--out", "results")
    assert status == 2 and err.count("error:") == 1 and "Traceback" not in err
    assert all(part in err for part in ("wrong.yaml", *expected))
    assert [path.name for path in here.iterdir()] == ["wrong.yaml"]


EVERY_SECTION = (1, 15, 18, 34, 36, 42, 54, 61, 64, 67)
"""Cases of which each is in a part of the file of its own."""


def test_check_says_all_that_is_wrong_with_a_file_and_run_what_is_first(here, seatsim_command):
    text, expected = GOOD, []
    for number in EVERY_SECTION:
        old, new, said = CASES[number]
        assert old in text, number
        text, expected = text.replace(old, new, 1), [*expected, *(part for part in said if "line" not in part)]
    Path("wrong.yaml").write_text(text)
    status, _, err = seatsim_command("check", "wrong.yaml")
    assert status == 2 and all(part in err for part in expected)
    every = err.splitlines()
    assert [line.startswith("error: ") for line in every] == [True] * len(EVERY_SECTION)
    assert seatsim_command("run", "wrong.yaml")[2].splitlines() == every[:1]
    found = json.loads(seatsim_command("check", "wrong.yaml", "--json")[1])
    assert found["error"] == found["errors"][0] and len(found["errors"]) == len(EVERY_SECTION)


def test_what_follows_from_a_misspelt_key_is_not_said_twice(tmp_path):
    (tmp_path / "wrong.yaml").write_text(GOOD.replace("frame_mass", "fram_mass").replace("rate:", "rat:"))
    with pytest.raises(InputError) as caught:
        load(tmp_path / "wrong.yaml")
    assert len(list_sentences(caught.value)) == 2


@pytest.mark.parametrize("arguments", [
    ("run", "missing.yaml"), ("run", "good.yaml", "missing.yaml"), ("run", "good.yaml", "--set", "plant.driver_mass"),
    ("run", "good.yaml", "--set", "plant.driver_mass=[1"), ("compare", "good.yaml", "missing.yaml"),
    ("gap", "good.yaml", "."),
    ("synthesise", "good.yaml"), ("describe", "bouc"), ("run",), ("run", "good.yaml", "--outt", "x"), ("fly",),
])  # fmt: skip
def test_a_wrong_command_exits_with_2_and_writes_nothing(arguments, here, seatsim_command):
    Path("good.yaml").write_text(GOOD)
    status, _, err = seatsim_command(*arguments)
    assert status == 2 and err
    assert [path.name for path in here.iterdir()] == ["good.yaml"]


def test_a_value_that_a_variant_puts_in_is_said_with_its_name(seat_file):
    seat_file.write_text(
        seat_file.read_text() + "variants:\n  soft: {plant.suspension_damping: 80.0}\n"
        "  passive, best: {damper.parameters: {c_a: 1.0}}\n"
    )
    with pytest.raises(InputError, match=r"line 13, variant 'passive, best', damper.parameters: .*missing"):
        load(seat_file)
    # What all variants have in common is said by its own place.
    with pytest.raises(InputError, match=r"--set plant.driver_mass=-5, plant.driver_mass: -5"):
        load(seat_file, {"plant.driver_mass": -5})


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("bingham", "c_a [N s/m]: viscous damping at zero current (required; a fit starts from 250)"),
        ("yu2019", "f0 [N]: offset, of the gas accumulator (default 0)"),
        ("plant", "driver_mass [kg]: mass m of the driver on the cushion (required)"),
        ("plant", "frame_mass [kg]"),
    ],
)
def test_a_key_that_must_be_stated_is_described_so(name, said):
    assert said in describe(name)
