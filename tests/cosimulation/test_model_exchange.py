"""A unit for model exchange is integrated to the fourth order, past its events, and moves the seat."""

import math
import platform
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest

from seatsim.cosimulation.damper import FmuDamper
from seatsim.cosimulation.unit import run_unit
from seatsim.scenario.loading import load
from seatsim.schema.errors import RunError
from seatsim.schema.modules import use
from seatsim.simulation.simulate import simulate

from ..text import parse

COMPILER = shutil.which("gcc") or shutil.which("cc")
pytestmark = pytest.mark.skipif(
    COMPILER is None or sys.platform != "linux", reason="needs a C compiler (gcc) and the libraries of Linux"
)
NAMES = ("x", "v", "i", "F", "c", "k", "tau", "edge", "moment", "ramp", "z", "z_rate")
CAUSALITY = ("input",) * 3 + ("output",) + ("parameter",) * 6 + ("local",) * 2
STATE, RATE, OFF = NAMES.index("z"), NAMES.index("z_rate"), len(NAMES)
K, TAU, C = 20000.0, 0.02, 500.0


def describe(version, events, saves, longest):
    """Return the description of the unit."""

    def row(k):
        kind = f'variability="tunable" name="{NAMES[k]}"' if CAUSALITY[k] == "parameter" else f'name="{NAMES[k]}"'
        start = ' start="0"' if CAUSALITY[k] in ("input", "parameter") else ""
        # FMI 2 counts the variables from 1, FMI 3 names them by their reference.
        rate = f' derivative="{STATE + 1 if version == 2 else STATE}"' if k == RATE else ""
        head = f'{kind} valueReference="{k}" causality="{CAUSALITY[k]}"'
        return (
            f"<ScalarVariable {head}><Real{start}{rate}/></ScalarVariable>"
            if version == 2
            else (f"<Float64 {head}{start}{rate}/>")
        )

    rows = "\n".join(map(row, range(len(NAMES))))
    experiment = f'<DefaultExperiment stepSize="{longest}"/>' if longest else ""
    if version == 2:
        return (
            f'<fmiModelDescription fmiVersion="2.0" modelName="d" guid="{{me}}" numberOfEventIndicators="{events}">'
            f'<ModelExchange modelIdentifier="d" canGetAndSetFMUstate="{saves}"'
            f' completedIntegratorStepNotNeeded="true"/>{experiment}<ModelVariables>{rows}</ModelVariables>'
            '<ModelStructure><Outputs><Unknown index="4"/></Outputs>'
            f'<Derivatives><Unknown index="{RATE + 1}"/></Derivatives></ModelStructure></fmiModelDescription>'
        )
    return (
        '<fmiModelDescription fmiVersion="3.0" modelName="d" instantiationToken="{me}">'
        f'<ModelExchange modelIdentifier="d" canGetAndSetFMUState="{saves}"/>{experiment}<ModelVariables>{rows}'
        f'<Float64 name="off" valueReference="{OFF}" causality="local"/></ModelVariables><ModelStructure>'
        f'<Output valueReference="3"/><ContinuousStateDerivative valueReference="{RATE}"/>'
        + f'<EventIndicator valueReference="{OFF}"/>' * events
        + "</ModelStructure></fmiModelDescription>"
    )


@pytest.fixture(scope="module")
def libraries(tmp_path_factory):
    """The library of either version."""
    folder, source = tmp_path_factory.mktemp("libraries"), Path(__file__).with_name("exchange_damper.c")
    for version in (2, 3):
        flags = ["-std=c99", "-shared", "-fPIC", *["-DFMI3"][: version - 2], "-o", str(folder / str(version))]
        subprocess.run([COMPILER, *flags, str(source)], check=True, timeout=60)
    return {version: (folder / str(version)).read_bytes() for version in (2, 3)}


@pytest.fixture
def unit(libraries, tmp_path, forget_own_code):
    """Make the unit, with so many event indicators, that saves its state or not, and give the damper that it is."""

    def make(version, events=0, saves="true", folder=tmp_path, longest=None, **parameters):
        path = folder / "damper.fmu"
        place = "linux64" if version == 2 else f"{platform.machine()}-linux"
        with zipfile.ZipFile(path, "w") as archive:
            archive.writestr("modelDescription.xml", describe(version, events, saves, longest))
            archive.writestr(f"binaries/{place}/d.so", libraries[version])
        use(path)
        inputs = (("displacement", "x"), ("velocity", "v"), ("current", "i"))
        return FmuDamper(str(path), inputs, "F", tuple(parameters.items()))

    return make


def run(damper, step, end=0.2, speed=0.3, rise=0.0):
    """Return the force at the end of a motion of constant speed from zero, and whether steps can be repeated.

    The current rises by `rise` in A/s.
    """
    given = {"displacement": 0.0, "velocity": speed, "acceleration": 0.0, "current": 0.0, "temperature": 20.0}
    with run_unit(damper) as running:
        force = running.start(damper, given)
        for k in range(round(end / step)):
            force = running.step(
                k * step, step, given | {"displacement": speed * k * step, "current": rise * (k + 1) * step}
            )
        return force, running.repeats


def relaxed(z, speed, time, k=K):
    """Return the exact state after a time at constant speed."""
    rest = k * speed * TAU
    return rest + (z - rest) * math.exp(-time / TAU)


@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize(("ramp", "rise"), [(0.0, 0.0), (1e5, 0.0), (0.0, 20.0)])
def test_the_states_are_integrated_to_the_fourth_order(version, ramp, rise, unit):
    # With a ramp, or a current that rises within the steps, the rate depends on the time: the response of a lag to r t.
    time = 0.04
    risen = (ramp + rise * K * 0.3) * TAU * (time - TAU * (1.0 - math.exp(-time / TAU)))
    exact = C * (1.0 + rise * time) * 0.3 + relaxed(0.0, 0.3, time) + risen
    coarse, fine = (abs(run(unit(version, ramp=ramp), step, time, rise=rise)[0] - exact) for step in (4e-3, 2e-3))
    assert fine < coarse / 14.0 and fine < 1e-3


@pytest.mark.parametrize("version", [2, 3])
def test_no_part_of_a_step_is_longer_than_the_unit_recommends(version, unit):
    divided, fine = run(unit(version, longest=1e-3), 4e-3, 0.04)[0], run(unit(version), 1e-3, 0.04)[0]
    assert divided == pytest.approx(fine, rel=1e-12) != run(unit(version), 4e-3, 0.04)[0]


@pytest.mark.parametrize("version", [2, 3])
def test_an_event_within_a_step_is_located(version, unit):
    # At 0.3 m/s the edge is passed at 0.0101 s, within a step, from which on the stiffness is doubled.
    passed = 0.0101
    exact = C * 0.3 + relaxed(relaxed(0.0, 0.3, passed), 0.3, 0.02 - passed, 2.0 * K)
    force, repeats = run(unit(version, events=1, edge=0.3 * passed), 1e-3, 0.02)
    assert force == pytest.approx(exact, rel=1e-6) and repeats


def test_an_announced_event_ends_a_part_of_a_step(unit):
    force, _ = run(unit(2, moment=0.0101), 1e-3, 0.02)
    assert force == pytest.approx(C * 0.3 + relaxed(0.0, 0.3, 0.02 - 0.0101) + 50.0, rel=1e-6)


def test_a_step_is_repeated_where_events_can_be_taken_back(unit):
    assert [run(unit(2, *how), 1e-3, 0.002)[1] for how in ((0, "false"), (1, "false"), (1, "true"))] == parse("""
        [true, false, true]
    """)
    assert not run(unit(2, 0, "false", moment=1.0), 1e-3, 0.002)[1]


def test_a_unit_that_does_not_stand_still_at_an_event_is_refused(unit, monkeypatch):
    monkeypatch.setattr("fmpy.fmi2.FMU2Model.newDiscreteStates", lambda _: (True, False, False, False, False, 0.0))
    with pytest.raises(RunError, match="does not come to an end with its event at 0 s"):
        run(unit(2), 1e-3, 0.002)


@pytest.mark.parametrize("version, saves", [(2, "true"), (3, "false")])
def test_a_seat_moves_as_with_the_damping_in_its_suspension(version, saves, unit, seat_file):
    unit(version, 0, saves, seat_file.parent)
    base = {"controller": {"law": "constant", "current": 0.0}, "excitation.duration": 0.2}
    damper = {
        "model": "fmu:damper.fmu",
        "inputs": {"displacement": "x", "velocity": "v", "current": "i"},
        "outputs": {"force": "F"},
    }
    own = load(seat_file)[0].plant.suspension_damping
    histories = [
        simulate(
            load(
                seat_file,
                {**base, "damper": damper | {"parameters": {"c": c, "k": 0.0}}, "plant.suspension_damping": own + rest},
            )[0],
            carry_all_effects=False,
        )
        for c, rest in ((500.0, 0.0), (0.0, 500.0))
    ]
    first, second = (history["driver_acceleration"] for history in histories)
    assert np.max(np.abs(first - second)) < 2e-3 * np.max(np.abs(second))
