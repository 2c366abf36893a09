"""Fifty and more wrong scenario files: each one clear error with its place, exit status 2, nothing written."""

import json
from pathlib import Path

import pytest

from seatsim.scenario.describe import describe
from seatsim.scenario.loading import load
from seatsim.schema.errors import InputError, list_sentences

from ..text import cases

GOOD = """\
name: good
seed: 7
plant:
  frame_mass: 20.0
  driver_mass: 80.0
  suspension_stiffness: 4600.0
  suspension_damping: 150.0
  cushion_stiffness: 60000.0
  cushion_damping: 1500.0
damper:
  model: bouc_wen
  parameters: {c_a: 250.0, c_b: 350.0, alpha_a: 45.0, alpha_b: 620.0, k0: 0.0, x0: 0.0, f0: 0.0, A: 2000.0,
               beta: 1000.0, gamma: 1000.0, n: 2}
actuator: {rate: 130.0, max_current: 1.0}
temperature: 20.0
controller: {law: constant, current: 0.5}
excitation: {kind: sine, amplitude: 0.01, frequency: 2.0, duration: 1.0}
effects: []
solver: {step: 0.001}
"""

# what is replaced, by what, and what the error must say
CASES = [
    *cases(r"""
frame_mass: 20.0 => fram_mass: 20.0 => line 4 | plant.fram_mass | did you mean 'frame_mass'
frame_mass: 20.0 => frame_mass: -20.0 => line 4 | plant.frame_mass | -20 | greater than 0 kg
frame_mass: 20.0 => frame_mass: twenty => line 4 | 'twenty' | number in kg
frame_mass: 20.0 => frame_mass: true => line 4 | True | number
frame_mass: 20.0 => frame_mass: .nan => line 4 | finite number
frame_mass: 20.0 => frame_mass: .inf => line 4 | finite number
frame_mass: 20.0 => frame_mass: [20.0] => line 4 | number in kg
frame_mass: 20.0 => frame_mass: => line 4 | number in kg
  frame_mass: 20.0\n =>  => plant.frame_mass | missing
frame_mass: 20.0 => frame_mass: 20.0\n  frame_mass: 21.0 => line 5 | duplicate key
cushion_stiffness: 60000.0 => cushion_stiffness: 0.0 => line 8 | greater than 0 N/m
suspension_damping: 150.0 => suspension_damping: -1 => line 7 | at least 0 N s/m
cushion_damping: 1500.0 => cushion_damping: 1500.0\n  travel: 0.05 => line 10 | plant.travel
cushion_damping: 1500.0 => cushion_damping: 1500.0\n  travel: [0.05, -0.05] => line 10 | plant.travel.0
cushion_damping: 1500.0 => cushion_damping: 1500.0\n  travel: [-0.05] => line 10 | plant.travel
cushion_damping: 1500.0 => cushion_damping: 1500.0\n  damper_ratio: 0 => line 10 | damper_ratio
plant: => plant: 3\nplan: => plan | unknown key | did you mean 'plant'
plant: => plants: => line 3 | did you mean 'plant'
model: bouc_wen => model: bouc_wenn => line 11 | damper.model | did you mean 'bouc_wen' | bingham
model: bouc_wen => modell: bouc_wen => line 11 | did you mean 'model'
model: bouc_wen => model: 3 => line 11 | not a name
model: bouc_wen => model: nowhere.module:Class => line 11 | no module 'nowhere.module' is installed
model: bouc_wen => model: 'math:Class' => line 11 | no class 'Class'
model: bouc_wen => model: 'collections:OrderedDict' => line 11 | not a damper
c_a: 250.0,  =>  => line 12 | c_a | missing | bouc_wen | state every parameter
  parameters: {c_a: 250.0, c_b: 350.0, alpha_a: 45.0, alpha_b: 620.0, k0: 0.0, x0: 0.0, f0: 0.0, A: 2000.0,\n \
              beta: 1000.0, gamma: 1000.0, n: 2}\n => \
 => line 10 | damper.parameters | c_a | missing
c_a: 250.0 => c_z: 250.0 => line 12 | c_z | unknown key
c_a: 250.0 => c_a: -250.0 => line 12 | at least 0 N s/m
n: 2} => n: 0.5} => line 13 | at least 1
n: 2} => n: '2'} => line 13 | '2' | number
rate: 130.0 => rate: 0 => line 14 | greater than 0 1/s
rate: 130.0,  =>  => line 14 | rate | missing
max_current: 1.0 => max_curent: 1.0 => line 14 | did you mean 'max_current'
max_current: 1.0 => max_current: -1.0 => line 14 | greater than 0 A
max_current: 1.0 => max_current: 1.0, delay: -0.01 => line 14 | at least 0 s
actuator: {rate: 130.0, max_current: 1.0} => actuator: 130 => line 14 | not a mapping
temperature: 20.0 => temperature: warm => line 15 | 'warm' | degC
temperature: 20.0 => temperature: 900 => line 15 | at most 200 degC
temperature: 20.0 => temperature: [] => at least one value
temperature: 20.0 => temperature: [20.0, hot] => 'hot'
temperature: 20.0 => temperature: {starts: 20.0} => line 15 | did you mean 'start'
temperature: 20.0\n =>  => temperature | missing
law: constant => law: konstant => line 16 | did you mean 'constant' | skyhook
law: constant,  =>  => line 16 | 'law' is missing
current: 0.5 => curent: 0.5 => line 16 | did you mean 'current'
current: 0.5 => current: -0.5 => line 16 | at least 0 A
current: 0.5 => current: 0.5, sample_time: 0.0015 => sample_time | multiple | solver.step
current: 0.5 => current: 0.5, sample_time: -1 => line 16 | sample_time
current: 0.5 => current: 0.5, inverse: {model: original_bingham, temperature: cold} => line 16 | 'cold'
{law: constant, current: 0.5} => {law: static_output_feedback} => exactly one of | gain
{law: constant, current: 0.5} => {law: static_output_feedback, gain: [1.0]} => line 16 | gain
{law: constant, current: 0.5} => {law: static_output_feedback, design: none.yaml} => none.yaml
kind: sine => kind: sin => line 17 | did you mean 'sine'
kind: sine,  =>  => line 17 | 'kind' is missing
frequency: 2.0 => frequency: -2.0 => line 17 | frequency
duration: 1.0 => duration: 0 => line 17 | duration | greater than 0 s
kind: sine, amplitude: 0.01, frequency: 2.0 => kind: road, road_class: Z, speed: 10.0 => 'Z' | permitted: A
kind: sine, amplitude: 0.01, frequency: 2.0, duration: 1.0 => kind: recording => 'path' | seatsim gap
kind: sine, amplitude: 0.01, frequency: 2.0, duration: 1.0 => kind: recording, path: nowhere, run: a => \
nowhere: no such folder with a recording.yaml
kind: sine, amplitude: 0.01, frequency: 2.0, duration: 1.0 => \
kind: table, path: nowhere.csv, column: a, time_column: t => nowhere.csv
effects: [] => effects: suspension.friction => line 18 | not a list
effects: [] => effects: [{effect: suspension.frction, parameters: {force: 45.0}}] => \
line 18 | did you mean 'suspension.friction'
effects: [] => effects: [{effect: suspension.friction, parameters: {force: -45.0}}] => at least 0 N
effects: [] => effects: [{effect: suspension.friction}] => force | missing
step: 0.001 => step: 0 => line 19 | greater than 0 s
step: 0.001 => step: 1 => line 19 | at most 0.01 s
step: 0.001 => steps: 0.001 => line 19 | did you mean 'step'
seed: 7 => seed: -7 => line 2 | seed | at least 0
seed: 7 => seed: 99999999999999999999 => line 2 | seed | at most 9223372036854775807
seed: 7 => seed: lucky => line 2 | 'lucky' | whole number
solver: {step: 0.001} => sweep: {plant.driver_mass: 55.0} => line 19 | list
solver: {step: 0.001} => sweep: {plant.driver_mas: [55.0, 75.0]} => driver_mas | did you mean 'driver_mass'
solver: {step: 0.001} => variants: {hot: {temperature: boiling}} => line 19, variant 'hot' | 'boiling'
{law: constant, current: 0.5} => {law: static_output_feedback, gain: ['2.0', 1.0]} => line 16 | '2.0' | not permitted
current: 0.5 => current: 0.5, sample_time: true => line 16 | sample_time | not permitted
name: good => name: good: bad => line 1 | mapping values
"""),
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
