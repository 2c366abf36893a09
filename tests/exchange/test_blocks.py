"""Every damper, every effect and every law but one that solves in a loop has a counterpart in C."""

import dataclasses
import re
import subprocess
from pathlib import Path

import numpy as np
import pytest
from scipy.io import loadmat

from seatsim.dampers.base import DAMPERS
from seatsim.effects.base import EFFECTS, ON_DAMPER, ON_SEAT, acts_on
from seatsim.exchange.block import list_variables
from seatsim.exchange.blocks.controller import controller_block
from seatsim.exchange.blocks.damper import damper_block
from seatsim.exchange.blocks.rig_motion import rig_block
from seatsim.exchange.c_source import print_c, print_model
from seatsim.exchange.export import find_compiler, identifier, make_files, write_mat
from seatsim.exchange.printing.program import NotPrintableError
from seatsim.rig.plant import control_system
from seatsim.scenario.loading import load
from seatsim.schema.errors import InputError

from .test_units import block_of

STRICT = ("-Wall", "-Wextra", "-Wconversion", "-Wpedantic", "-Werror")
"""Warnings that the rules for control units ask for; none is left."""


def run_vector(path, *flags):
    """Compile a file with its test vector, run it, and return what it prints."""
    program = path.with_suffix(".out")
    command = [find_compiler(), "-std=c99", *STRICT, "-O1", "-ffp-contract=off", "-DSEATSIM_TEST", *flags]
    subprocess.run([*command, "-o", str(program), str(path), "-lm"], check=True)
    return subprocess.run([str(program)], capture_output=True, text=True, check=False)


def test_every_damper_is_printed(seat_file):
    for name in DAMPERS.names():
        assert f"{DAMPERS.find(name).__name__}_force" in print_model(block_of(name, seat_file))


def test_every_effect_of_the_loop_is_printed(seat_file):
    found = [EFFECTS.find(name) for name in EFFECTS.names()]
    carried = [cls for cls in found if acts_on(cls, (*ON_DAMPER, *ON_SEAT))]
    effects = []
    for cls in carried:
        form = EFFECTS.specification_of(cls).forms[0]
        effects.append({"effect": EFFECTS.name_of(cls), "parameters": dict(form.free) | dict(form.fixed)})
    block = rig_block(load(seat_file, {"effects": effects})[0])
    text = print_model(block)
    names = [v.name for v in list_variables(block)]
    assert len(names) == len(set(names))
    for cls in carried:
        assert f"{cls.__name__}_" in text
        assert any(name.startswith(f"effects.{EFFECTS.name_of(cls)}.") for name in names)


def test_every_law_is_printed_but_one_that_solves_a_programme():
    left_out = []
    for scenario in load("laws"):
        try:
            print_model(controller_block(scenario))
        except NotPrintableError as error:
            left_out.append(str(error))
    assert len(left_out) == 1
    assert "controllers.laws.model_predictive.ask_planner" in left_out[0]


@pytest.mark.parametrize(
    "name, settings",
    [
        ("quickstart", {}),
        ("laws", {"controller": {"law": "lqg", "sample_time": 0.005}}),
        ("laws", {"controller": {"law": "sliding_mode"}, "damper": {"model": "modified_bouc_wen"}}),
    ],
)
def test_a_controller_passes_its_test_vector_in_double_and_float(name, settings, tmp_path):
    (tmp_path / "controller.c").write_text(print_c(controller_block(load(name, settings)[0])))
    done = run_vector(tmp_path / "controller.c")
    assert done.returncode == 0 and "greatest error is 0 of" in done.stdout
    assert "malloc" not in (tmp_path / "controller.c").read_text()
    assert run_vector(tmp_path / "controller.c", "-DSEATSIM_FLOAT").returncode == 0


@pytest.mark.parametrize(
    ("make", "name"),
    [(controller_block, "hot-damper-cold-inverse"), (damper_block, "quickstart"), (rig_block, "quickstart")],
)
def test_sources_compile_without_a_warning(make, name, tmp_path):
    block = make(load(name)[0])
    for version in (2, 3):
        for file, content in make_files(block, version).items():
            (tmp_path / Path(file).name).write_bytes(content)
    (tmp_path / "alone.c").write_text(print_c(block))
    files = [str(tmp_path / file) for file in ("alone.c", "fmi2.c", "fmi3.c")]
    command = [find_compiler(), "-std=c99", *STRICT, "-fsyntax-only", "-DSEATSIM_TEST", *files]
    for precision in ((), ("-DSEATSIM_FLOAT",)):
        done = subprocess.run([*command, *precision], capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr


def test_a_rig_with_effects_passes_its_test_vector(seat_file, tmp_path):
    given = {"damper.remanence": {"width": 0.05}, "driver.biodynamics": {"share": 0.2}, "coil.delay": {"time": 0.0043}}
    effects = [{"effect": name, "parameters": parameters} for name, parameters in given.items()]
    (tmp_path / "rig.c").write_text(print_c(rig_block(load(seat_file, {"effects": effects})[0])))
    done = run_vector(tmp_path / "rig.c")
    assert done.returncode == 0, done.stdout


@pytest.mark.parametrize("name", ["2 seats @MODEL@ */ int evil; /* @FED@ \\", "ä" * 300])
def test_a_name_stays_out_of_the_code(name, seat_file, tmp_path):
    block = damper_block(dataclasses.replace(load(seat_file)[0], name=name))
    (tmp_path / "damper.c").write_text(print_c(block))
    assert run_vector(tmp_path / "damper.c").returncode == 0
    text = (tmp_path / "damper.c").read_text()
    assert text.count("} Model;") == 1
    assert "int evil" not in text.partition("*/")[2]
    assert identifier(block).isascii() and identifier(block).isidentifier() and len(identifier(block)) < 70


def test_a_changed_number_of_the_test_vector_is_found(seat_file, tmp_path):
    text = print_c(damper_block(load(seat_file)[0]))
    changed = re.sub(r"(nominal_parameters = \{\{(?:R\()?)250\.0", r"\g<1>251.0", text)
    (tmp_path / "damper.c").write_text(changed)
    assert changed != text and run_vector(tmp_path / "damper.c").returncode == 1


def test_a_mat_file_holds_plant_and_design(seat_file, tmp_path):
    scenario = load(seat_file)[0]
    write_mat(controller_block(scenario), scenario, tmp_path / "controller.mat")
    found = loadmat(tmp_path / "controller.mat", simplify_cells=True)
    assert np.array_equal(found["plant"]["B"], control_system(scenario.plant).B)
    assert list(found["plant"]["inputs"]) == ["floor_acceleration", "damper_force"]
    law = found["parameters"]["law"]
    assert (law["displacement"], law["velocity"], law["frame_velocity"]) == (2.0, 2147.6, 0.0)
    assert found["step"] == 0.005


def test_a_delay_too_long_for_a_block_is_refused(seat_file):
    with pytest.raises(InputError, match="holds 256 at most"):
        rig_block(load(seat_file, {"actuator.delay": 0.5})[0])
