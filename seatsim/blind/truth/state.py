"""The parameters of the true rig, and the places in its state vector and memory.

The symbols of the nominal part are those of section 2 of the contract. A departure is off while its leading parameter
(a force, share, gain or law) is zero; its lengths, times and exponents then carry a value that no formula divides by
zero with. Motion is relative: `x = zs - z0` of the suspension, `y = zc - zs` of the cushion.

numba keeps compiled code beside each source and looks only at that file's date: after an edit of a function that is
called from another module, delete the `__pycache__` of this package.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TypeVar

import numba
import numpy as np


@dataclass(frozen=True)
class RigParameters:
    """All parameters of one run. Compiled functions see them as a record with a 64-bit float for each field."""

    # seat
    ms: float = 0.0  # kg, frame
    m: float = 0.0  # kg, driver on the cushion
    kf: float = 0.0  # N/m, suspension
    cf: float = 0.0  # N s/m, suspension
    kc: float = 0.0  # N/m, cushion
    cc: float = 0.0  # N s/m, cushion
    # nominal damper
    is_bingham: float = 0.0  # 1: Bingham with tanh(v / v_ref); 0: Bouc-Wen
    c_a: float = 0.0  # N s/m, viscous damping without current
    c_b: float = 0.0  # N s/(m A), its rise with current
    y_a: float = 0.0  # N, yield force without current (for Bouc-Wen: per unit of the hysteretic variable)
    y_b: float = 0.0  # N/A, its rise with current
    k0: float = 0.0  # N/m, stiffness
    x0: float = 0.0  # m, where the stiffness is at rest
    f0: float = 0.0  # N, offset
    A: float = 0.0  # 1/m, Bouc-Wen
    beta: float = 0.0  # 1/m, Bouc-Wen
    gamma: float = 0.0  # 1/m, Bouc-Wen
    n: float = 0.0  # -, exponent of Bouc-Wen
    v_ref: float = 0.0  # m/s, Bingham: speed at which 76 % of the yield force is reached
    damper_ratio: float = 1.0  # -, stroke of the damper per suspension displacement
    # nominal coil
    rate: float = 0.0  # 1/s
    i_max: float = 0.0  # A
    # damper: heat
    fade_law: float = 0.0  # 0 off, 1 Arrhenius, 2 powers
    fade_viscous: float = 0.0  # 1000 K (Arrhenius) or 1/K (hyperbola), loss of viscosity
    fade_yield: float = 0.0  # 1/K (Arrhenius) or an exponent, loss of yield stress
    t_start: float = 20.0  # degC, of the damper when the run starts
    t_ambient: float = 20.0  # degC
    fluid_heat: float = 60.0  # J/K, heat capacity of the fluid
    housing_heat: float = 700.0  # J/K, heat capacity of the housing
    fluid_to_housing: float = 6.0  # W/K
    housing_to_air: float = 1.5  # W/K
    thermometer_time: float = 2.5  # s, lag of the thermometer on the housing
    # damper: gas
    gas_law: float = 0.0  # 2: preload with a falling stiffness; otherwise polytropic
    gas_force: float = 0.0  # N, at mid stroke
    gas_length: float = 0.1  # m, column of gas
    gas_exponent: float = 1.3  # -, polytropic
    gas_rate: float = 0.0  # N/m, stiffness at mid stroke of law 2
    # damper: other departures that the library has an effect for
    asym_viscous_up: float = 0.0  # -, relative change of viscous damping in extension
    asym_viscous_down: float = 0.0  # -, in compression
    asym_yield_up: float = 0.0  # -, relative change of yield force in extension
    asym_yield_down: float = 0.0  # -, in compression
    asym_speed: float = 0.02  # m/s, over which one direction goes over into the other
    preyield_share: float = 0.0  # -, share of the yield force that comes late
    preyield_length: float = 3e-4  # m, over which it builds up
    preyield_time: float = 0.0  # s, or in which it builds up (0: by length)
    saturation_froehlich: float = 0.0  # 1/A
    saturation_langevin: float = 0.0  # 1/A
    relay_share: float = 0.0  # -, share of the field that passes through hysteresis relays
    relay_width: float = 0.2  # A, mean width of the relays
    remanence_gain: float = 0.0  # -, share of the field that decays slowly
    remanence_time: float = 0.5  # s
    play_gap: float = 0.0  # m, full width of the mount's play
    play_air: float = 0.0  # m, air that is squeezed before the damper carries
    play_turn: float = 0.0  # 1: the damper rests until a turning motion has crossed the gap
    mount_stiffness: float = 3e6  # N/m
    seal_force: float = 0.0  # N
    seal_stribeck: float = 1.2  # -, breakaway over sliding force
    seal_speed: float = 0.01  # m/s, Stribeck
    seal_length: float = 3e-5  # m, deflection of the bristles
    seal_pressure: float = 0.0  # -, growth of the friction with 300 N of damper force
    # damper: departures outside the library
    cavitation_force: float = 0.0  # N, at which the cavity opens
    cavitation_fill: float = 1.0  # -, share of the stroke that opens it
    orifice_damping: float = 0.0  # N s^2/m^2
    thinning_power: float = 0.0  # -
    thinning_speed: float = 0.1  # m/s
    field_stiffness: float = 0.0  # N/(m A)
    inertance: float = 0.0  # kg
    bypass_share: float = 0.0  # -, of the force, lost at mid stroke
    bypass_length: float = 0.01  # m
    # coil
    second_rate: float = 0.0  # 1/s, second pole in series
    slow_share: float = 0.0  # -, of the current, that follows the slow branch
    slow_rate: float = 20.0  # 1/s
    fall_slow: float = 0.0  # -, how much slower the current falls
    fall_law: float = 0.0  # 0 off, 1 everywhere, 2 more so at low current
    delay: float = 0.0  # s
    delay_jitter: float = 0.0  # -, largest relative change of the delay from row to row
    limit: float = 0.0  # A
    limit_sag: float = 0.0  # -, by how much the limit falls with the mean current
    limit_power: float = 8.0  # -, how sharply the limit sets in
    command_quantum: float = 0.0  # A
    back_emf: float = 0.0  # A s/m
    dead_zone: float = 0.0  # A
    ring_damping: float = 0.0  # -, damping ratio of the regulator
    ring_rate: float = 0.0  # rad/s, its natural frequency
    dropout_seed: float = 0.0
    dropout_interval: float = 0.0  # s, mean time between dropouts
    dropout_duration: float = 0.0  # s
    # suspension
    friction_force: float = 0.0  # N
    friction_stribeck: float = 1.2  # -
    friction_speed: float = 0.01  # m/s
    friction_length: float = 3e-5  # m
    friction_travel: float = 0.0  # 1/m, growth of the friction with travel
    friction_damping: float = 0.0  # N s/m
    stop_gap_up: float = 1.0  # m, free travel
    stop_gap_down: float = 1.0  # m
    stop_stiffness: float = 0.0  # N/m^stop_power, or N/m of an exponential buffer
    stop_power: float = 1.5  # -, 0: exponential buffer
    stop_loss: float = 0.0  # s/m
    stop_length: float = 0.004  # m, of the exponential buffer
    sinh_length: float = 0.0  # m
    leaf_gain: float = 0.0  # -, stiffness of the helper leaf over kf
    leaf_length: float = 0.02  # m
    bushing_stiffness: float = 0.0  # N/m, Maxwell element
    bushing_time: float = 0.05  # s
    softening_length: float = 0.0  # m
    lever_slope: float = 0.0  # 1/m, change of the damper's lever ratio with travel
    creep_stiffness: float = 0.0  # N/m
    creep_time: float = 3.0  # s
    # cushion
    foam_length: float = 0.0  # m, of the exponential foam
    foam_poly: float = 0.0  # -, of the polynomial foam
    foam_scale: float = 0.02  # m
    foam_loss: float = 0.0  # -
    separation_force: float = 0.0  # N, largest tension
    separation_width: float = 40.0  # N, over which law 1 sets in
    separation_law: float = 0.0  # 1: soft plus; otherwise a saturating power
    zener_stiffness: float = 0.0  # N/m
    zener_time: float = 0.1  # s
    cover_force: float = 0.0  # N
    cover_length: float = 3e-4  # m
    foam_rate: float = 0.0  # s/m, growth of the damping with speed
    # driver
    mass_gain: float = 0.0  # -, relative error of the driver's mass
    body_fraction: float = 0.0  # -, of the driver's mass, that swings inside
    body_rate: float = 30.0  # rad/s
    body_damping: float = 0.3  # -
    second_body_fraction: float = 0.0  # -
    second_body_rate: float = 60.0  # rad/s
    second_body_damping: float = 0.3  # -
    muscle_gain: float = 0.0  # N s/m
    muscle_delay: float = 0.08  # s
    foot_stiffness: float = 0.0  # N/m
    foot_damping: float = 0.0  # N s/m
    # floor
    base_rate: float = 100.0  # rad/s, resonance of the base on the floor
    base_damping: float = 0.05  # -
    base_mass: float = 0.0  # kg, 0: the base is the floor


_RECORD = np.dtype([(field.name, np.float64) for field in dataclasses.fields(RigParameters)])
"""The layout in which compiled functions see `RigParameters`."""


def parameter_record(values: Mapping[str, float]) -> np.void:
    """Return the record for the given parameters; those not given keep their default, so their departure is off.

    Raises:
        TypeError: there is no parameter of a given name.
    """
    record: np.void = np.array([dataclasses.astuple(RigParameters(**values))], dtype=_RECORD)[0]
    return record


(
    X,  # m
    V,  # m/s, x'
    Y,  # m
    W,  # m/s, y'
    CURRENT,  # A, in the winding
    CURRENT_2,  # second state of the coil (A, or A/s for a ringing regulator)
    Z,  # hysteretic variable of Bouc-Wen
    FRICTION,  # linkage friction over its sliding force
    SEAL,  # seal friction over its sliding force
    T_FLUID,  # degC
    T_HOUSING,  # degC
    T_THERMOMETER,  # degC
    BODY,  # m, inner body against the seat
    BODY_V,  # m/s
    BODY2,  # m, second inner body
    BODY2_V,  # m/s
    ZENER,  # m, spring of the memory foam
    COVER,  # friction of the cover over its sliding force
    BUSHING,  # m, spring of the Maxwell bushing
    CREEP,  # m, crept part of the spring's deflection
    BASE,  # m, base against the floor
    BASE_V,  # m/s
    PREYIELD,  # late yield variable, or late speed in m/s
    MAGNETISATION,  # A, slow part of the field
    SAG,  # A, mean current that makes the supply sag
    MOUNT,  # m, stretch of the damper's mount
) = range(26)
STATES = 26

(
    CAVITY_VOLUME,  # m of stroke that the cavity has opened
    RELAYS_MEAN,  # A, mean of the hysteresis relays
    DROPOUT_LEFT,  # s, that the present dropout goes on
    V_FRAME,  # m/s, absolute, as a controller would integrate it
    V_DRIVER,  # m/s, absolute
    V_PISTON,  # m/s, last solution of the damper in series with its mount
) = range(6)
MEMORIES = 6
RELAYS = 40
"""Relays of the discrete Preisach model; with 40 the steps of the field (1/40 of its range) are below the noise."""


F = TypeVar("F", bound=Callable[..., object])


def compiled(function: F) -> F:
    """Compile a function and keep the result on disk.

    Plain IEEE arithmetic, without the reordering that the kernel under test allows itself.
    """
    done: F = numba.njit(cache=True)(function)
    return done


FASTEST = 15000.0
"""Bound on the rate of a bristle, 1/s: 1.5 per step of 0.1 ms, inside the stability limit of Runge-Kutta 4 (2.78)."""
MICRO_DAMPING = 0.001
"""Damping of the bristles, s: keeps a sticking friction from ringing; it acts below the Stribeck speed only."""


@compiled
def bristle_rate(deflection: float, v: float, length: float, stribeck: float, speed: float) -> float:
    """Return the rate of the bristle `s`, in shares of the sliding force, 1/s.

    `s' = |v| / length (sign v - s / G(v))` with `G(v) = 1 + (stribeck - 1) exp(-(v / speed)^2)`.
    """
    level = 1.0 + (stribeck - 1.0) * math.exp(-((v / speed) ** 2))
    rate = min(abs(v) / length, FASTEST)
    return rate * ((1.0 if v > 0.0 else -1.0) - deflection / level)
