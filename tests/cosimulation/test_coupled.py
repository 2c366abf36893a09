"""A damper that was exported and comes back as a unit moves the seat as it did before."""

import shutil
import tempfile
import zipfile

import numpy as np
import pytest

from seatsim.cli.check_files import check_file
from seatsim.exchange.blocks.controller import controller_block
from seatsim.exchange.blocks.damper import damper_block
from seatsim.exchange.blocks.rig_motion import rig_block
from seatsim.exchange.fmu import compile_library, write_fmu
from seatsim.identification.damper_record import find_model
from seatsim.scenario.loading import load
from seatsim.scenario.sections import scenario_schema
from seatsim.schema.errors import InputError, RunError
from seatsim.schema.modules import MissingModuleError, use
from seatsim.simulation.coupled import _agree
from seatsim.simulation.damper_bench import sine_test
from seatsim.simulation.simulate import simulate

BASE = {"controller": {"law": "constant", "current": 0.4}, "excitation.duration": 0.3}
INPUTS = {"displacement": "displacement", "velocity": "velocity", "acceleration": "acceleration", "current": "command"}
UNIT = {"model": "fmu:damper.fmu", "inputs": INPUTS, "outputs": {"force": "force"}, "parameters": {"is_current": True}}


@pytest.fixture(scope="module")
def exported(kept_seat_file, tmp_path_factory):
    """The damper of the seat as a unit."""
    path = tmp_path_factory.mktemp("exported") / "damper.fmu"
    write_fmu(damper_block(load(kept_seat_file)[0]), 2, path)
    return path


@pytest.fixture
def unit_file(exported, seat_file, forget_own_code):
    """The seat, with its damper beside it as a unit that the user named."""
    use(shutil.copy(exported, seat_file.parent))
    return seat_file


def rewrite(path, change):
    """Put what a function makes of the name and content of each file of a unit in its place, and name the unit."""
    with zipfile.ZipFile(path) as archive:
        held = {name: archive.read(name) for name in archive.namelist()}
    with zipfile.ZipFile(path, "w") as archive:
        for name, content in held.items():
            archive.writestr(name, change(name, content))
    use(path)


def difference(path, step):
    """Return how far the force of the unit is from that of the model, over its greatest value."""
    own, other = (
        simulate(load(path, {**BASE, **extra, "solver.step": step})[0], carry_all_effects=False)["damper_force"]
        for extra in ({}, {"damper": UNIT})
    )
    return np.max(np.abs(own - other)) / np.max(np.abs(own))


def test_a_unit_is_its_model_to_the_second_order_of_the_step(unit_file, conform):
    coarse, fine = difference(unit_file, 1e-3), difference(unit_file, 5e-4)
    for step, found in ((1.0, coarse), (0.5, fine)):
        claim = f"exported damper coupled back as a unit, step {step} ms: deviation of the force, over its peak"
        conform(claim, "the same damper in the loop", found, tolerance=0.02 * step**2)
    assert fine < coarse / 3.0


def test_a_unit_that_cannot_save_its_state_is_stepped_once(unit_file):
    stated = b'FMUstate="%s"'
    rewrite(unit_file.with_name("damper.fmu"), lambda _, content: content.replace(stated % b"true", stated % b"false"))
    assert difference(unit_file, 5e-4) < 0.02


@pytest.mark.parametrize("values, said", [([np.nan], "gives a force of nan N at 0 s"), (None, "failed at the step")])
def test_a_unit_that_fails_ends_the_run_and_its_folder(unit_file, tmp_path, monkeypatch, values, said):
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    if values:
        monkeypatch.setattr("fmpy.fmi2.FMU2Slave.getReal", lambda *_: values)
    damper = UNIT | {"parameters": {"is_current": True, "damper.alpha_a": 1e308}}
    files = set(tmp_path.iterdir())
    with pytest.raises(RunError, match=f"damper.fmu: the unit {said}"):
        simulate(load(unit_file, BASE | {"damper": damper})[0], carry_all_effects=False)
    assert set(tmp_path.iterdir()) == files


def test_editors_and_check_know_units(unit_file):
    assert check_file(unit_file.with_name("damper.fmu")).holds[0] == "input displacement"
    keys = scenario_schema()["properties"]["damper"]["properties"]
    assert set(keys["inputs"]["properties"]) > set(INPUTS) and keys["outputs"]["required"] == ["force"]


def test_a_unit_runs_only_where_it_was_named(seat_file, forget_own_code):
    seat_file.with_name("damper.fmu").write_bytes(b"anything")
    with pytest.raises(InputError, match="runs only where the file is named: --with") as raised:
        load(seat_file, {"damper": UNIT})
    assert isinstance(raised.value.__cause__, MissingModuleError)


def test_a_unit_that_changed_since_is_refused(unit_file):
    unit_file.with_name("damper.fmu").write_bytes(b"anything")
    with pytest.raises(InputError, match="has changed since it was named"):
        load(unit_file, {"damper": UNIT})


@pytest.mark.parametrize(
    "changed, said",
    [
        ({"inputs": {"velocity": "velocty"}}, "did you mean 'velocity'"),
        ({"inputs": {"veloctiy": "velocity"}}, "did you mean 'velocity'"),
        ({"outputs": {"force": "velocity"}}, "declared as input, not as output"),
        ({"outputs": {"force": "current"}}, "cannot be the force"),
        ({"outputs": {}}, "'outputs' is missing"),
        ({"parameters": {"coil.rate": -1.0}}, "at least"),
        ({"temperature_factors": {}}, "unknown key"),
    ],
)
def test_a_mapping_that_does_not_fit_is_one_error(unit_file, changed, said):
    with pytest.raises(InputError, match=said):
        load(unit_file, {"damper": UNIT | changed})


def test_what_a_unit_cannot_be_asked_is_refused(unit_file):
    effect = [{"effect": "damper.seal_friction", "parameters": {"force": 15.0}}]
    for extra, said in ((BASE | {"effects": effect}, "acts within the damper"), ({}, "wants a force")):
        with pytest.raises(InputError, match=said):
            simulate(load(unit_file, extra | {"damper": UNIT})[0], carry_all_effects=False)
    for block in (damper_block, rig_block, controller_block):
        with pytest.raises(InputError, match="outside the compiled loop"):
            block(load(unit_file, {"damper": UNIT})[0])
    with pytest.raises(InputError, match="outside the compiled loop"):
        sine_test(load(unit_file, {"damper": UNIT})[0].damper.record, 0.02, 1.0, 0.0, 20.0)
    with pytest.raises(InputError, match="is a unit of another program"):
        find_model("fmu:damper.fmu")


@pytest.mark.parametrize("slope", [-0.1, -0.9, -8.0, -200.0])
def test_the_force_at_the_end_of_a_step_is_found_however_stiff_the_damper(slope):
    asked = []

    def miss(trial):
        asked.append(trial)
        return 100.0 * np.tanh(slope * (trial - 30.0) / 100.0) - trial

    _agree(miss, 5.0, lambda: None)
    assert abs(miss(asked[-1])) < 1e-4 and len(asked) < 30


@pytest.mark.parametrize(
    "code, patience, problem",
    [("while (1) {}", 3.0, "not loaded after 3 s"), ("__builtin_trap();", 120.0, r"crashes as it is loaded \(signal")],
)
def test_a_library_that_does_not_load_is_an_error(code, patience, problem, unit_file, tmp_path, monkeypatch):
    monkeypatch.setattr("seatsim.cosimulation.unit.PATIENCE", patience)
    (tmp_path / "stuck.c").write_text(f"__attribute__((constructor)) static void load(void) {{ {code} }}\n")
    compile_library(tmp_path / "stuck.c", tmp_path / "stuck.so")
    stuck = (tmp_path / "stuck.so").read_bytes()
    rewrite(unit_file.with_name("damper.fmu"), lambda name, content: stuck if name.endswith(".so") else content)
    with pytest.raises(InputError, match=problem):
        simulate(load(unit_file, {**BASE, "damper": UNIT})[0], carry_all_effects=False)
