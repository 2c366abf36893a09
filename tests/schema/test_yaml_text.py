"""YAML texts within limits: what they mean, and that none takes long or does anything but state values."""

import math
import random

import pytest

from seatsim.schema.yaml_text import DEEPEST, YamlError, dump, parse, parse_value

BOMB = "a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n" + "".join(
    f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 10)}]\n" for n in range(1, 12)
)
"""Ten to the power of twelve values once its aliases are put in."""
MERGES = "a0: &a0 {x: 1}\n" + "".join(f"a{n}: &a{n} {{<<: [*a{n - 1}, *a{n - 1}]}}\n" for n in range(1, 40))
"""A mapping that is merged into others more often than there are atoms in a gram."""


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1", 1), ("-0017", -17), ("0x1F", 31), ("0o17", 15), ("1_000", 1000), ("1.5", 1.5), ("1e3", 1000.0),
        (".5", 0.5), ("5.", 5.0), ("-.inf", -math.inf), ("~", None), ("", None), ("null", None), ("true", True),
        ("False", False), ("yes", "yes"), ("on", "on"), ("2024-05-01", "2024-05-01"), ("12:30", "12:30"),
        ("'1'", "1"), ('"\\u00e9"', "\u00e9"), ("a: 1", {"a": 1}), ("{1: a, true: b}", {"1": "a", "true": "b"}),
        ("[1, [2, {a: b}]]", [1, [2, {"a": "b"}]]), ("a: |\n  b\n  c\n", {"a": "b\nc\n"}), ("1.2.3", "1.2.3"),
    ],
)  # fmt: skip
def test_values_are_those_of_yaml_1_2(text, value):
    assert parse_value(text) == value


def test_what_is_written_is_read_back():
    generator = random.Random(1)
    words = ["yes", "1e3", "0o7", "~", " a", "a: b", "#", "null", "1_0", "'", '"', "é", "-", "*a", "&a", "!a", "<<"]
    for _ in range(100):
        value = {f"k{n}": generator.choice([generator.uniform(-1, 1) * 10.0 ** generator.randint(-30, 30),
                                            generator.randint(-(10**9), 10**9), generator.choice(words), True, None,
                                            [1.0, "x"], {"a": generator.choice(words)}]) for n in range(8)}  # fmt: skip
        assert parse_value(dump(value)) == value


def test_keys_that_are_merged_stand_below_the_own_ones_and_the_first_mapping_wins():
    text = "a: &a {x: 1, y: 1}\nb: &b {<<: *a, y: 2}\nc: {<<: [*b, {y: 3, z: 3}], w: 0}\n"
    assert parse_value(text)["c"] == {"w": 0, "x": 1, "y": 2, "z": 3}


@pytest.mark.parametrize(
    ("text", "problem", "line"),
    [
        (BOMB, "values once its aliases are put in", None),
        (MERGES, "values once its aliases are put in", None),
        ("a: " + "[" * 100_000, f"nest more than {DEEPEST} deep", 1),
        ("a:\n" + "".join(f"{'  ' * n}- a:\n" for n in range(1, 2000)), f"nest more than {DEEPEST} deep", None),
        ("- &a [*a]", f"nest more than {DEEPEST} deep", 1),
        ("&a {<<: *a}", f"nest more than {DEEPEST} deep", 1),
        ("a: 1\nb: *nowhere", "refers to nothing", 2),
        ("a: 1\nb: !!bool x", "the tag 'tag:yaml.org,2002:bool' is not permitted", 2),
        ("a: !own {b: 1}", "the tag '!own' is not permitted", 1),
        ("!!set {a}", "tag", 1),
        ("{!!str a: 1}", "a key is no text", 1),
        ("a: 1\n? [1, 2]\n: 3", "a key is no text", 2),
        ("{{a: 1}: 2}", "a key is no text", 1),
        ("a: 1\na: 2", "found duplicate key 'a'", 2),
        ("a: 1\n---\nb: 2", "a second document begins", 2),
        ("a: " + "9" * 5000, "a whole number of 5000 digits", 1),
        ("a: b\x00c", "is not permitted in YAML", 1),
        ('a: 1\nb: "x\\0y"', "holds a zero byte", 2),
        ('"x\\0y": 1', "holds a zero byte", 1),
        ("<<: 3", "'<<' takes a mapping", 1),
        ("a: [1", "did not find expected", None),
        ("a:\n\t- 1", "cannot start any token", 2),
    ],
)
def test_what_is_beyond_the_limits_is_refused_at_its_line(text, problem, line):
    with pytest.raises(YamlError, match=problem) as caught:
        parse(text)
    assert line is None or caught.value.line == line
