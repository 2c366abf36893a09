"""Equations of the true rig against closed forms, and the whole rig against scipy where it is linear."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.signal import lsim

from seatsim.blind.make.draw_experiment import BINGHAM, BOUC_WEN, COIL, PLANT
from seatsim.blind.truth.physics import (
    coil,
    control_laws,
    cushion,
    damper,
    magnetisation,
    mount,
    occupant,
    state,
    suspension,
    temperature,
)
from seatsim.blind.truth.physics.friction import FASTEST, bristle_rate
from seatsim.blind.truth.physics.parameters import parameter_record
from seatsim.blind.truth.physics.rig import EXCITATION_RATE, INTEGRATION_STEP, SAMPLE_RATE, Inputs, simulate

BINGHAM_SEAT, BOUC_WEN_SEAT = PLANT | BINGHAM | COIL, PLANT | BOUC_WEN | COIL
MEMORY = np.zeros(state.MEMORIES)


def at(**values: float) -> np.ndarray:
    y = np.zeros(state.STATES)
    for name, value in values.items():
        y[getattr(state, name)] = value
    return y


def rates_of(write, *arguments) -> np.ndarray:
    """Return the rates that a function writes; where it takes the array, the arguments hold None."""
    rates = np.zeros(state.STATES)
    write(*(rates if argument is None else argument for argument in arguments))
    return rates


def test_a_record_takes_known_parameters_only() -> None:
    record = parameter_record({"kf": 5.0})
    assert (record["kf"], record["t_start"], record["mass_gain"]) == (5.0, 20.0, 0.0)
    with pytest.raises(TypeError, match="kg"):
        parameter_record({"kg": 1.0})


def test_nominal_damper_forces() -> None:
    bingham = parameter_record(BINGHAM_SEAT | {"f0": 7.0, "k0": 300.0, "x0": 0.01})
    y = at(CURRENT=0.5)
    by_hand = (250.0 + 350.0 * 0.5) * 0.1 + 300.0 * 0.02 + (45.0 + 620.0 * 0.5) * math.tanh(0.1 / 0.004) + 7.0
    assert damper.main_force(y, MEMORY, 0.03, 0.1, bingham) == pytest.approx(by_hand, rel=1e-12)
    bouc_wen = parameter_record(BOUC_WEN_SEAT)
    y = at(CURRENT=0.5, Z=-0.3)
    assert damper.main_force(y, MEMORY, 0.0, 0.1, bouc_wen) == pytest.approx(42.5 - 0.3 * 355.0, rel=1e-12)
    rate = rates_of(damper.write_yield_rates, y, None, 0.1, bouc_wen)[state.Z]
    assert rate == pytest.approx(2000.0 * 0.1 - 1000.0 * 0.1 * 0.09 + 1000.0 * 0.1 * 0.3 * 0.3, rel=1e-12)
    assert rates_of(damper.write_yield_rates, at(Z=1.0), None, 0.1, bouc_wen)[state.Z] == pytest.approx(0.0)
    back = rates_of(damper.write_yield_rates, y, None, -0.1, bouc_wen)[state.Z]
    assert back == pytest.approx(-2000.0 * 0.1 + 1000.0 * 0.1 * 0.09 + 1000.0 * 0.1 * 0.3 * 0.3, rel=1e-12)


def test_damper_departures() -> None:
    gas = parameter_record(BINGHAM_SEAT | {"gas_force": 80.0, "gas_length": 0.1, "gas_exponent": 1.3})
    assert damper.gas_force(0.02, gas) == pytest.approx(-80.0 * 1.2**-1.3)
    soft = parameter_record(BINGHAM_SEAT | {"gas_law": 2.0, "gas_force": 80.0, "gas_rate": 400.0, "gas_length": 0.1})
    assert damper.gas_force(0.02, soft) == pytest.approx(-80.0 + 400.0 * (0.02 - 0.002))
    uneven = parameter_record(BINGHAM_SEAT | {"asym_viscous_up": 0.2, "asym_viscous_down": -0.1})
    assert damper.viscous_damping(at(), 1.0, uneven) == pytest.approx(300.0)
    assert damper.viscous_damping(at(), -1.0, uneven) == pytest.approx(225.0)
    thin = parameter_record(BINGHAM_SEAT | {"thinning_power": 0.5, "thinning_speed": 0.1})
    assert damper.viscous_damping(at(), 0.1, thin) == pytest.approx(250.0 * 2.0**-0.25)
    bubble = parameter_record(BINGHAM_SEAT | {"cavitation_force": 100.0})
    whole = damper.main_force(at(), MEMORY, 0.0, 1.0, parameter_record(BINGHAM_SEAT))
    assert damper.main_force(at(), MEMORY, 0.0, 1.0, bubble) == pytest.approx(100.0 + 0.15 * (whole - 100.0))
    memory = np.zeros(state.MEMORIES)
    damper.update_cavity(at(), memory, 0.0, 1.0, 1e-3, bubble)
    assert memory[state.CAVITY_VOLUME] == pytest.approx(1e-3 * (1.0 - 100.0 / (100.0 + 0.15 * (whole - 100.0))))


def test_magnetisation() -> None:
    froehlich = parameter_record(BINGHAM_SEAT | {"saturation_froehlich": 0.5})
    assert magnetisation.yield_current(at(CURRENT=0.8), MEMORY, froehlich) == pytest.approx(0.8 / 1.4)
    langevin = parameter_record(BINGHAM_SEAT | {"saturation_langevin": 0.5})
    assert magnetisation.yield_current(at(CURRENT=0.01), MEMORY, langevin) == pytest.approx(0.01, rel=1e-3)
    u = 3.0 * 0.8 * 0.5
    saturated = (1.0 / math.tanh(u) - 1.0 / u) / 0.5
    assert magnetisation.yield_current(at(CURRENT=0.8), MEMORY, langevin) == pytest.approx(saturated)
    decaying = parameter_record(BINGHAM_SEAT | {"remanence_gain": 0.3, "remanence_time": 2.0})
    y = at(CURRENT=0.1, MAGNETISATION=0.6)
    assert magnetisation.yield_current(y, MEMORY, decaying) == pytest.approx(0.1 + 0.3 * 0.5)
    fall = rates_of(magnetisation.write_magnetisation_rate, y, None, decaying)[state.MAGNETISATION]
    assert fall == pytest.approx(-0.5 * (0.4 + 2.0 * 0.5) / 2.0)


def test_relays_remember_the_direction() -> None:
    p = parameter_record(BINGHAM_SEAT | {"relay_share": 1.0, "relay_width": 0.2})
    memory, relays, means = np.zeros(state.MEMORIES), np.zeros(state.RELAYS), []
    for current in (0.5, 1.3, 0.5, -0.3):
        magnetisation.update_relays(at(CURRENT=current), memory, relays, p)
        means.append(memory[state.RELAYS_MEAN])
    assert means[1] == 1.0 and means[3] == 0.0
    assert means[0] == pytest.approx(0.4, abs=0.05)  # half a mean width late, on both sides
    assert means[2] == pytest.approx(0.6, abs=0.05)


def test_temperatures_keep_the_energy() -> None:
    p = parameter_record(BINGHAM_SEAT)
    y = at(T_FLUID=50.0, T_HOUSING=30.0, T_THERMOMETER=25.0)
    rates = rates_of(temperature.write_heat_rates, y, None, -70.0, p)
    stored = 60.0 * rates[state.T_FLUID] + 700.0 * rates[state.T_HOUSING]
    assert stored == pytest.approx(70.0 - 1.5 * 10.0)
    assert rates[state.T_FLUID] == pytest.approx((70.0 - 6.0 * 20.0) / 60.0)
    assert rates[state.T_THERMOMETER] == pytest.approx(5.0 / 2.5)
    arrhenius = parameter_record({"fade_law": 1.0, "fade_viscous": 1.1, "fade_yield": 0.004})
    assert temperature.viscous_factor(60.0, arrhenius) == pytest.approx(math.exp(1100.0 * (1 / 333.15 - 1 / 293.15)))
    assert temperature.yield_factor(60.0, arrhenius) == pytest.approx(math.exp(-0.16))
    power = parameter_record({"fade_law": 2.0, "fade_viscous": 0.012, "fade_yield": 1.3})
    assert temperature.viscous_factor(60.0, power) == pytest.approx(1.0 / 1.48)
    assert temperature.yield_factor(60.0, power) == pytest.approx((333.15 / 293.15) ** -1.3)


def test_a_bristle_settles_at_its_sliding_level() -> None:
    level = 1.0 + 0.4 * math.exp(-((0.01 / 0.02) ** 2))
    assert bristle_rate(level, 0.01, 1e-4, 1.4, 0.02) == pytest.approx(0.0, abs=1e-9)
    assert bristle_rate(0.0, 0.01, 1e-4, 1.4, 0.02) == pytest.approx(100.0)
    assert bristle_rate(0.5, -0.01, 1e-4, 1.0, 0.02) == pytest.approx(100.0 * (-1.0 - 0.5))
    assert bristle_rate(0.0, 9.0, 1e-4, 1.4, 0.02) == FASTEST


def test_a_loose_damper_bears_what_its_mount_transmits() -> None:
    p = parameter_record(BINGHAM_SEAT | {"play_gap": 0.001, "mount_stiffness": 4e6})
    assert mount.mount_force(0.0004, p) == 0.0
    assert mount.mount_force(-0.0006, p) == pytest.approx(-400.0)
    for wanted in (-300.0, 5.0, 900.0):
        memory = np.zeros(state.MEMORIES)
        v = mount.piston_speed(at(CURRENT=0.4), memory, 0.0, wanted, p)
        assert damper.main_force(at(CURRENT=0.4), memory, 0.0, v, p) == pytest.approx(wanted, abs=0.05)
        assert memory[state.V_PISTON] == v
        bracketed = mount.bracketed_speed(at(CURRENT=0.4), memory, 0.0, wanted, 0.0, p)
        assert damper.main_force(at(CURRENT=0.4), memory, 0.0, bracketed, p) == pytest.approx(wanted, abs=0.05)
    air = parameter_record(BINGHAM_SEAT | {"play_air": 0.001, "mount_stiffness": 4e6})
    assert mount.mount_force(0.001, air) == pytest.approx(4e6 * 0.001 / 2.0)
    turn = parameter_record(BINGHAM_SEAT | {"play_gap": 0.001, "play_turn": 1.0})
    assert mount.damper_force(at(MOUNT=0.0), np.zeros(state.STATES), MEMORY, 0.0, 0.2, turn) == 0.0
    assert mount.damper_force(at(MOUNT=0.001), np.zeros(state.STATES), MEMORY, 0.0, 0.2, turn) == pytest.approx(95.0)


def test_suspension_forces() -> None:
    p = parameter_record(PLANT | {"stop_gap_up": 0.02, "stop_gap_down": 0.03, "stop_stiffness": 1e5, "stop_loss": 0.5})
    assert suspension.stop_force(0.019, 1.0, p) == 0.0
    assert suspension.stop_force(0.03, 0.2, p) == pytest.approx(1e5 * 0.01**1.5 * 1.1)
    assert suspension.stop_force(-0.04, 0.2, p) == pytest.approx(-1e5 * 0.01**1.5 * 0.9)
    assert suspension.stop_force(0.03, -9.0, p) == 0.0  # a buffer never pulls
    foam = parameter_record(PLANT | {"stop_gap_up": 0.02, "stop_stiffness": 1e4, "stop_power": 0.0})
    assert suspension.stop_force(0.028, 0.0, foam) == pytest.approx(1e4 * 0.004 * (math.exp(2.0) - 1.0))
    hard = parameter_record(PLANT | {"sinh_length": 0.02})
    assert suspension.spring_force(0.03, hard) == pytest.approx(4600.0 * 0.02 * math.sinh(1.5))
    leaf = parameter_record(PLANT | {"leaf_gain": 0.4, "leaf_length": 0.02})
    assert suspension.spring_force(0.02, leaf) == pytest.approx(4600.0 * 0.02 * 1.2)
    linked = parameter_record(PLANT | {"bushing_stiffness": 2500.0, "creep_stiffness": 900.0})
    y = at(X=0.01, V=0.2, BUSHING=0.004, CREEP=0.005)
    force = suspension.suspension_force(y, np.zeros(state.STATES), linked)
    assert force == pytest.approx(46.0 + 30.0 + 2500.0 * 0.004 - 900.0 * 0.005)
    rates = rates_of(suspension.suspension_force, y, None, linked)
    assert rates[state.BUSHING] == pytest.approx(0.2 - 0.004 / 0.05)
    assert rates[state.CREEP] == pytest.approx(0.005 / 3.0)
    rubbing = parameter_record(PLANT | {"friction_force": 25.0, "friction_travel": 5.0, "friction_damping": 10.0})
    sliding = suspension.linkage_friction(at(X=0.02, V=0.5, FRICTION=1.0), np.zeros(state.STATES), rubbing)
    assert sliding == pytest.approx(25.0 * 1.1 + 5.0)


def test_cushion_forces() -> None:
    hard = parameter_record(PLANT | {"foam_length": 0.02})
    assert cushion.foam_force(-0.01, 0.0, hard) == pytest.approx(-60000.0 * 0.02 * (math.exp(0.5) - 1.0))
    poly = parameter_record(PLANT | {"foam_poly": 0.25, "foam_loss": 2.0})
    force = -600.0 - 60000.0 * 0.02 * 0.25 * (0.25 + 0.125) + 1500.0 * (1.0 + 2.0 * 0.25 * 0.5) * 0.1
    assert cushion.foam_force(-0.01, 0.1, poly) == pytest.approx(force)
    assert cushion.foam_force(0.01, 0.1, poly) == pytest.approx(600.0 + 150.0)
    soft = parameter_record(PLANT | {"separation_force": 100.0, "separation_law": 1.0, "separation_width": 10.0})
    assert cushion.limit_tension(100.0, soft) == pytest.approx(100.0 - 10.0 * math.log(2.0))
    assert cushion.limit_tension(900.0, soft) == pytest.approx(100.0)
    assert cushion.limit_tension(-900.0, soft) == pytest.approx(-900.0)
    partial = parameter_record(PLANT | {"separation_force": 100.0, "separation_law": 2.0})
    assert cushion.limit_tension(100.0, partial) == pytest.approx(100.0 / 2.0**0.25)
    assert cushion.limit_tension(-100.0, partial) == -100.0
    stuck = parameter_record(PLANT | {"cover_force": 20.0, "zener_stiffness": 1000.0})
    y = at(W=0.03, COVER=0.5, ZENER=0.002)
    assert cushion.cushion_force(y, np.zeros(state.STATES), stuck) == pytest.approx(45.0 + 10.0 + 2.0)
    rates = rates_of(cushion.cushion_force, y, None, stuck)
    assert (rates[state.COVER], rates[state.ZENER]) == pytest.approx((100.0 * 0.5, 0.03 - 0.02))


def test_occupant_forces() -> None:
    p = parameter_record(PLANT | {"mass_gain": 0.5, "body_fraction": 0.25, "body_rate": 20.0, "body_damping": 0.3})
    y = at(BODY=0.01, BODY_V=-0.2)
    restoring = 400.0 * 0.01 - 2.0 * 0.3 * 20.0 * 0.2
    assert occupant.occupant_force(y, 0.0, p) == pytest.approx(120.0 * 0.25 * restoring)
    rates = rates_of(occupant.write_occupant_rates, y, None, 3.0, p)
    assert (rates[state.BODY], rates[state.BODY_V]) == pytest.approx((-0.2, -restoring - 3.0))
    feet = parameter_record(PLANT | {"foot_stiffness": 600.0, "foot_damping": 60.0, "muscle_gain": 400.0})
    force = occupant.occupant_force(at(X=0.01, Y=0.02, V=0.1, W=0.3), 0.05, feet)
    assert force == pytest.approx(-600.0 * 0.03 - 60.0 * 0.4 - 400.0 * 0.05)


def test_the_driver_of_the_coil() -> None:
    commands, row = np.array([0.1, 0.2, 0.3, 0.4]), 1.0 / SAMPLE_RATE
    assert coil.held_command(commands, 2.9 * row, row, parameter_record({})) == 0.3
    late = parameter_record({"delay": 1.5 * row})
    assert coil.held_command(commands, 3.0 * row, row, late) == 0.2
    assert coil.held_command(commands, 0.5 * row, row, late) == 0.0

    def target(command: float, **values: float) -> float:
        return coil.target_current(command, 0.0, 1e-4, at(), np.zeros(state.MEMORIES), parameter_record(COIL | values))

    assert (target(1.7), target(-0.3)) == (1.0, 0.0)
    assert target(0.37, command_quantum=0.1) == pytest.approx(0.4)
    assert target(0.37, dead_zone=0.05) == pytest.approx(0.32)
    assert target(0.5, limit=0.5, limit_power=8.0) == pytest.approx(0.5 / 2.0**0.125)


def test_dropouts_begin_at_the_same_times_whatever_the_step() -> None:
    p = parameter_record({"dropout_interval": 0.3, "dropout_duration": 0.05})

    def begins(h: float) -> list[float]:
        memory = np.zeros(6)
        off = np.array([coil.drops_out(n * h, h, memory, p) for n in range(round(5.0 / h))])
        return list(np.round(np.flatnonzero(np.diff(off.astype(int)) > 0) * h, 2))

    assert begins(1e-4) == begins(2.5e-4) != []


def test_dropouts_last_their_time_and_come_at_their_rate() -> None:
    p, h, memory = parameter_record({"dropout_interval": 0.05, "dropout_duration": 0.01}), 1e-3, np.zeros(6)
    off = np.array([coil.drops_out(n * h, h, memory, p) for n in range(20000)])
    lengths = np.diff(np.flatnonzero(np.diff(off.astype(int)) != 0))[::2]
    assert set(lengths) <= {10, 11}
    assert np.mean(off) == pytest.approx(0.01 / 0.06, rel=0.15)


@pytest.mark.parametrize(
    ("values", "rate"),
    [
        ({}, 130.0 * 0.3),
        ({"back_emf": 0.5}, 130.0 * (0.3 - 0.5 * 0.2)),
        ({"second_rate": 500.0}, 500.0 * (0.2 - 0.5)),
        ({"slow_share": 0.25, "slow_rate": 20.0}, 0.75 * 130.0 * (0.8 - (0.5 - 0.05) / 0.75) + 0.25 * 20.0 * 0.6),
        ({"ring_rate": 100.0, "ring_damping": 0.2}, 0.2),
    ],
)
def test_coil_rates(values: dict[str, float], rate: float) -> None:
    p = parameter_record(COIL | values)
    found = rates_of(coil.write_coil_rates, at(CURRENT=0.5, CURRENT_2=0.2), None, 0.8, -0.2, p)
    assert found[state.CURRENT] == pytest.approx(rate)


def test_the_coil_falls_slowly() -> None:
    diode, low = (parameter_record(COIL | {"fall_law": law, "fall_slow": 0.5}) for law in (1.0, 2.0))
    assert coil.falling_rate(0.5, 0.8, diode) == 130.0
    assert coil.falling_rate(0.5, 0.2, diode) == pytest.approx(130.0 / 1.5)
    assert coil.falling_rate(0.5, 0.2, low) == pytest.approx(130.0 / (1.0 + 1.6 * 0.5 * 0.5))


def test_control_laws() -> None:
    p, schedule, memory = parameter_record(COIL), np.array([0.0, 1.4]), np.zeros(state.MEMORIES)
    memory[state.V_FRAME] = 0.1

    def command(law: list[float], **values: float) -> float:
        return control_laws.command_of(np.array(law), schedule, 1, at(**values), memory, p)

    assert command([control_laws.SCHEDULE, 0, 0, 0, 0, 0]) == 1.0
    skyhook = [control_laws.SKYHOOK, 0.8, 0.01, 0, 0, 0]
    assert [command(skyhook, V=v) for v in (0.02, -0.02, 0.005)] == [0.8, 0.0, 0.0]
    feedback = [control_laws.FEEDBACK, 0.9, -500.0, 100.0, 3000.0, 0.0]
    wanted = -500.0 * 0.02 + 100.0 * 0.2 + 3000.0 * 0.1
    assert command(feedback, X=0.02, V=0.2) == round((wanted - 40.0 - 50.0) / (600.0 + 70.0), 4)
    assert command(feedback, X=0.02, V=-0.2) == 0.0


def test_a_linear_rig_moves_as_its_transfer_function() -> None:
    linear = PLANT | COIL | {"is_bingham": 1.0, "v_ref": 1.0, "c_a": 400.0}
    rows = round(2.0 * SAMPLE_RATE)
    rng = np.random.default_rng(0)
    samples = round(2.0 * EXCITATION_RATE) + 1
    time = np.arange(samples) / EXCITATION_RATE
    floor = np.convolve(rng.standard_normal(samples), np.ones(40) / 40.0, "same")
    force = 30.0 * np.sin(2.0 * np.pi * 3.0 * time)
    motion = simulate(parameter_record(linear), Inputs(floor, EXCITATION_RATE, force, np.zeros(6), np.zeros(rows)))
    ms, m, kf, cf, kc, cc = PLANT.values()
    c = cf + 400.0
    frame = [-kf / ms, -c / ms, kc / ms, cc / ms]
    driver = [0.0, 0.0, -kc / m, -cc / m]
    A = np.array([[0, 1, 0, 0], frame, [0, 0, 0, 1], [b - a for a, b in zip(frame, driver, strict=True)]])
    B = np.array([[0, 0, 0], [-1, 1 / ms, 0], [0, 0, 0], [0, -1 / ms, 0]])
    C = np.array([frame, driver, [1, 0, 0, 0], [0, 400.0, 0, 0]])
    D = np.array([[0, 0, 1 / ms], [0, 0, 0], [0, 0, 0], [0, 0, 0]])
    # the rig holds the frame force over a step of 0.1 ms, so its motion is half a step late on average
    late = 30.0 * np.sin(2.0 * np.pi * 3.0 * (time - 0.5 * INTEGRATION_STEP))
    _, expected, _ = lsim((A, B, C, D), np.column_stack([floor, late, force]), time)
    step = round(EXCITATION_RATE / SAMPLE_RATE)
    found = (motion.frame, motion.driver, motion.displacement, motion.force)
    for values, exact in zip(found, expected.T, strict=True):
        np.testing.assert_allclose(values[5:], exact[::step][5:rows], atol=2e-4 * np.std(exact))
