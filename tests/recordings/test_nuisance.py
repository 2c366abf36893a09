"""Which nominal parameters are refitted, how far, and that varying them touches nothing else."""

import dataclasses

import numpy as np
import pytest

from seatsim.dampers.bingham import Bingham, OriginalBingham
from seatsim.dampers.bouc_wen import BoucWen
from seatsim.recordings.nuisance import Nuisance, list_nuisances, vary
from seatsim.rig.coil import Coil
from seatsim.rig.plant import Plant
from seatsim.rig.temperature import TemperatureFactors
from seatsim.scenario.scenario import DamperChoice, Scenario

PLANT = Plant(20.0, 80.0, 4600.0, 150.0, 60000.0, 1500.0)
DAMPER = BoucWen(c_b=-350.0)


def scenario(damper=DAMPER, coil=None, plant=PLANT):
    return Scenario("toy", DamperChoice(damper, TemperatureFactors()), coil or Coil(), 20.0, plant=plant)


def tolerances(posed, tolerance=0.1):
    return {(each.section, each.name): each.tolerance for each in list_nuisances(posed, tolerance)}


def test_every_parameter_varies_by_the_tolerance_times_its_size():
    found = tolerances(scenario())
    expected = {("plant", name): 0.1 * value for name, value in zip(Plant._fields[:6], PLANT[:6], strict=True)}
    expected |= {("damper", "c_a"): 25.0, ("damper", "c_b"): 35.0, ("damper", "alpha_a"): 4.5}
    expected |= {("damper", "alpha_b"): 62.0, ("damper", "A"): 200.0}
    expected |= {("damper", "beta"): 100.0, ("damper", "gamma"): 100.0}
    # Those that are nominally zero vary by a scale of their unit: the suspension's stiffness, 10 mm and 100 N.
    expected |= {("damper", "k0"): 460.0, ("damper", "x0"): 0.001, ("damper", "f0"): 10.0}
    expected |= {("coil", "rate"): 13.0, ("coil", "max_current"): 0.1}
    assert found == pytest.approx(expected)


def test_conventions_geometry_and_exponents_do_not_vary():
    listed = {name for _, name in tolerances(scenario())}
    assert not listed & {"damper_ratio", "travel", "v_ref", "n", "resistance"}
    assert {name for section, name in tolerances(scenario(OriginalBingham())) if section == "damper"} == {"f0"}


def test_a_parameter_is_off_by_its_tolerance_times_the_deviation():
    nominal = scenario()
    parameters = [Nuisance("damper", "c_b", -350.0, 35.0), Nuisance("coil", "rate", 130.0, 13.0)]
    parameters += [Nuisance("plant", "driver_mass", 80.0, 8.0), Nuisance("damper", "f0", 0.0, 10.0)]
    varied = vary(nominal, parameters, np.array([1.0, -0.5, 0.25, -1.0]))
    assert varied.damper.record == DAMPER._replace(c_b=-315.0, f0=-10.0)
    assert varied.coil == Coil(rate=123.5)
    assert varied.plant == PLANT._replace(driver_mass=82.0)
    assert nominal == scenario()
    rest = {"damper": nominal.damper, "coil": nominal.coil, "plant": nominal.plant}
    assert dataclasses.replace(varied, **rest) == nominal
    assert varied.damper.factors == nominal.damper.factors


def test_a_parameter_may_have_a_tolerance_of_its_own():
    own = {"plant.driver_mass": 0.5, "damper.parameters.c_a": 0.0, "actuator.rate": 0.3, "plant.damper_ratio": 0.05}
    found = {each.key: each.tolerance for each in list_nuisances(scenario(), 0.1, own)}
    assert found["plant.driver_mass"] == 40.0 and found["actuator.rate"] == pytest.approx(39.0)
    assert found["plant.frame_mass"] == 2.0 and "damper.parameters.c_a" not in found
    # A convention varies where it has a tolerance of its own, and only there.
    assert found["plant.damper_ratio"] == 0.05
    assert "plant.damper_ratio" not in {each.key for each in list_nuisances(scenario(), 0.1)}


def test_no_parameter_leaves_the_range_of_its_field():
    found = {each.key: each for each in list_nuisances(scenario(BoucWen(alpha_a=0.0, f0=-5.0)), 1.0)}
    keys = ("plant.frame_mass", "damper.parameters.f0", "damper.parameters.k0")
    mass, offset, stiffness = (found[key] for key in keys)
    assert mass.at(-1.0) == pytest.approx(0.05 * 20.0) and mass.at(1.0) == 40.0
    assert offset.at(-1.0) == -10.0 and stiffness.at(-1.0) == -4600.0
    assert found["plant.suspension_damping"].at(-3.0) == pytest.approx(0.05 * 150.0)
    yielding = {each.name: each for each in list_nuisances(scenario(Bingham(fc_a=0.0)), 0.05)}["fc_a"]
    assert (yielding.at(-0.5), yielding.at(0.5)) == (0.0, 2.5)
    varied = vary(scenario(), [mass._replace(nominal=20.0)], np.array([-1.0]))
    assert varied.plant.frame_mass == mass.at(-1.0)
