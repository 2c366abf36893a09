"""The flat parameter record and the state vector of the truth rig."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

PLANT = ("ms", "m", "kf", "cf", "kc", "cc")
DAMPER = ("is_bingham", "c_a", "c_b", "y_a", "y_b", "k0", "x0", "f0", "A", "beta", "gamma", "n", "v_ref")
COIL = ("rate", "i_max")
NOMINAL = (*PLANT, *DAMPER, *COIL)
EXTRAS = (
    # damper, of the library
    "fade_visc", "fade_yield", "fade_form", "t_start", "t_ambient", "heat_fluid", "heat_body", "h_gap", "h_air",
    "tau_thermo", "gas_force", "gas_length", "gas_exponent", "gas_form", "gas_rate", "asym_visc_up", "asym_visc_down",
    "asym_yield_up", "asym_yield_down", "asym_speed", "pre_share", "pre_length", "pre_tau", "sat_froehlich",
    "sat_langevin",
    "rem_relay", "rem_width", "rem_decay", "rem_gain", "rem_tau", "play_gap", "play_air", "play_turn",
    "mount_k",
    "seal_force", "seal_stribeck", "seal_speed", "seal_length", "seal_pressure",
    # damper, outside
    "cav_force", "cav_fill", "orifice", "thin_power", "thin_speed", "mag_stiffness", "inertance", "bypass",
    "bypass_length",
    # coil
    "coil_rate2", "coil_slow", "coil_slow_rate", "fall_slow", "fall_form", "delay", "delay_jitter", "limit",
    "limit_sag",
    "limit_power", "quantum", "back_emf", "dead_zone", "ring_damping", "ring_rate", "drop_seed", "drop_every",
    "drop_time",
    # suspension
    "fr_force", "fr_stribeck", "fr_speed", "fr_length", "fr_travel", "fr_damping", "stop_gap_up", "stop_gap_down",
    "stop_k", "stop_power", "stop_loss", "stop_length", "sinh_length", "leaf_gain", "leaf_length",
    "bush_k", "bush_tau", "soften_length", "soften_ratio", "creep_k", "creep_tau",
    # cushion
    "foam_length", "foam_poly", "foam_scale", "foam_loss", "lift_force", "lift_width", "lift_form",
    "zener_k", "zener_tau", "cover_force", "cover_length", "foam_v",
    # driver
    "mass_gain", "body_fraction", "body_rate", "body_damping", "body2_fraction", "body2_rate", "body2_damping",
    "muscle_gain", "muscle_delay", "foot_k", "foot_c",
    # floor
    "base_rate", "base_damping", "base_mass",
)  # fmt: skip
DTYPE = np.dtype([(name, np.float64) for name in (*NOMINAL, *EXTRAS)])

(X, V, Y, W, CUR, CUR2, Z, FRIC, SEAL, T_FLUID, T_BODY, T_THERMO, BODY, BODY_V, BODY2, BODY2_V, ZENER, COVER, BUSH,
 CREEP,
 BASE, BASE_V, PRE, MAGNET, SAG, MOUNT) = range(26)  # fmt: skip
STATES = 26
"""Suspension and cushion deflection and their rates, coil, hysteresis, friction, heat, body, foam, bushing, base."""

VOLUME, RELAYS_MEAN, DROP_LEFT, V_FRAME, V_DRIVER, V_PISTON = range(6)
MEMORIES = 6
"""What changes once a step: cavity volume, relays, dropout, absolute velocities."""
RELAYS = 40

OFF: Mapping[str, float] = {
    "t_start": 20.0, "t_ambient": 20.0, "heat_fluid": 60.0, "heat_body": 700.0, "h_gap": 6.0, "h_air": 1.5,
    "tau_thermo": 2.5, "gas_length": 0.1, "gas_exponent": 1.3, "asym_speed": 0.02, "pre_length": 3e-4, "rem_width": 0.2,
    "rem_tau": 0.5, "mount_k": 3e6, "seal_stribeck": 1.2, "seal_speed": 0.01, "seal_length": 3e-5, "cav_fill": 1.0,
    "thin_speed": 0.1, "bypass_length": 0.01, "coil_slow_rate": 20.0, "limit_power": 8.0, "fr_stribeck": 1.2,
    "fr_speed": 0.01, "fr_length": 3e-5, "stop_gap_up": 1.0, "stop_gap_down": 1.0, "stop_power": 1.5,
    "stop_length": 0.004, "leaf_length": 0.02, "bush_tau": 0.05, "creep_tau": 3.0, "foam_scale": 0.02,
    "lift_width": 40.0, "zener_tau": 0.1,
    "cover_length": 3e-4, "body_rate": 30.0, "body_damping": 0.3, "body2_rate": 60.0, "body2_damping": 0.3,
    "muscle_delay": 0.08, "base_rate": 100.0, "base_damping": 0.05,
}  # fmt: skip
"""Values of shape parameters while their effect is off; every other extra is zero, and zero is off."""


def record(values: Mapping[str, float]) -> Any:
    """Return the parameter record for nominal values and extras; what is not named is off."""
    out = np.zeros(1, dtype=DTYPE)[0]
    for name, value in ({**OFF, **values}).items():
        out[name] = value
    return out
