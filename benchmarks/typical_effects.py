"""Every effect of the library in every form that its record allows, at a size that is typical of a seat."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import NamedTuple


class Form(NamedTuple):
    """An effect at a typical size: its sizes, and its shape; what is not named is as the record has it, or off."""

    sizes: Mapping[str, float]
    shape: Mapping[str, float | str] = MappingProxyType({})


FRICTIONS = (
    Form({"force": 24.0}), Form({"force": 24.0}, {"presliding": 2e-4}),
    Form({"force": 24.0}, {"presliding": 5e-4, "lubrication": 5.0}),
)  # fmt: skip
ACCELERATIONS = {"floor_acceleration": 0.01, "frame_acceleration": 0.03, "driver_acceleration": 0.015}
CHANNELS = ACCELERATIONS | {"suspension_displacement": 5e-5, "damper_force": 2.5, "coil_current": 0.003}
NOISE = CHANNELS | {"damper_temperature": 0.1}
"""RMS by channel, in its unit."""
FADE = {"viscous": 0.008, "yielding": 0.008}
STOPS = {"low": -0.018, "high": 0.018}
FORMS: Mapping[str, Sequence[Form]] = {
    "suspension.friction": FRICTIONS,
    "damper.seal_friction": FRICTIONS,
    "suspension.end_stop": (
        Form(STOPS), Form(STOPS, {"power": 2.0}), Form({"high": 0.015}, {"low": -1.0}),
        Form(STOPS, {"stiffness": 2e4, "damping": 2.0}),
    ),
    "suspension.progressive_spring": (
        Form({"rise": 1000.0}), Form({"skew": 10.0}), Form({"rise": 1000.0, "skew": 5.0}),
        Form({"helper": 0.8}, {"reach": 0.008}),
    ),
    "damper.thermal_fade": (Form(FADE), Form({"yielding": 0.01}), Form(FADE, {"lag": 8.0}), Form(FADE, {"rise": 10.0})),
    "damper.gas_spring": (
        Form({"preload": 40.0}), Form({"preload": 40.0, "stiffness": 800.0}), Form({"stiffness": 1200.0}),
    ),
    "damper.asymmetry": (
        Form({"viscous": 0.15, "yielding": 0.15}), Form({"viscous": 0.2}), Form({"yielding": 0.2}, {"speed": 0.03}),
        Form({"viscous": 0.15, "yielding": 0.15}, {"offset": 0.6}), Form({"pulling": 0.2}),
    ),
    "damper.free_play": (
        Form({"gap": 6e-4}), Form({"gap": 6e-4}, {"softness": 0.8}), Form({"gap": 6e-4}, {"stiffness": 3e6}),
        Form({"gap": 6e-4}, {"softness": 0.05, "turning": 3e-4}),
    ),
    "damper.preyield_hysteresis": (
        Form({"travel": 5e-4}), Form({"travel": 1e-3}, {"share": 0.5}), Form({"lag": 2e-3}), Form({"behind": 2e-3}),
    ),
    "damper.magnetic_saturation": (
        Form({"bend": 2.0}), Form({"bend": 2.0}, {"sharpness": 1.0}), Form({"bend": 2.5}, {"sharpness": 4.0}),
    ),
    "damper.remanence": (
        Form({"width": 0.06}), Form({"width": 0.06}, {"spread": 0.6}), Form({"width": 0.06}, {"lift": 0.6}),
        Form({"width": 0.06}, {"decay": 3.0}), Form({"share": 0.2}, {"decay": 3.0}),
    ),
    "coil.lag": (Form({"time": 0.005}), Form({"time": -0.003}), Form({"time": 0.005}, {"second": 0.5})),
    "coil.asymmetric_lag": (Form({"time": 0.008}),),
    "coil.delay": (Form({"time": 0.006}),),
    "coil.current_limit": (Form({"limit": 0.5}),),
    "cushion.hardening": (
        Form({"rise": 60.0}), Form({"rise": 60.0, "bend": 5e3}), Form({"rise": 60.0, "loss": 60.0}),
        Form({"rise": 60.0}, {"unload": 1.0}),
    ),
    "cushion.separation": (
        Form({"limit": 120.0}), Form({"limit": 100.0}, {"held": 0.4}), Form({"limit": 120.0}, {"width": 60.0}),
    ),
    "driver.mass": (Form({"change": 6.0}), Form({"change": -6.0})),
    "driver.biodynamics": (Form({"share": 0.2}), Form({"share": 0.2}, {"frequency": 4.0, "damping": 0.5})),
    "floor.unmeasured_input": (Form({"rms": 15.0}), Form({"tone": 20.0}, {"frequency": 7.0})),
    "sensor.gain": tuple(Form({"error": 0.08}, {"channel": name}) for name in CHANNELS),
    "sensor.bias": (
        *(Form({"share": 0.3}, {"channel": name}) for name in CHANNELS),
        Form({"share": 0.2, "drift": 0.02}, {"channel": "suspension_displacement"}),
    ),
    "sensor.lag": tuple(Form({"time": 0.006}, {"channel": name}) for name in CHANNELS),
    "sensor.clock_skew": (
        Form({"shift": 0.008}), Form({"shift": -0.008}), Form({"shift": 0.008}, {"hold": 0.002}),
        Form({"shift": 0.004, "drift": 5e-4}),
    ),
}  # fmt: skip
"""Forms by effect."""
