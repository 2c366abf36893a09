"""The forms of effects of `typical_effects.yaml`, and the noise of a seat's sensors."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from pydantic import TypeAdapter
from ruamel.yaml import YAML


class Form(NamedTuple):
    """An effect at a typical size: its sizes, and its shape; what is not named is as the record has it, or off."""

    sizes: Mapping[str, float]
    shape: Mapping[str, float | str] = {}


FORMS: Mapping[str, Sequence[Form]] = TypeAdapter(dict[str, list[Form]]).validate_python(
    YAML(typ="safe").load(Path(__file__).with_suffix(".yaml"))
)
"""Forms by effect."""
ACCELERATIONS = {"floor_acceleration": 0.01, "frame_acceleration": 0.03, "driver_acceleration": 0.015}
CHANNELS = ACCELERATIONS | {"suspension_displacement": 5e-5, "damper_force": 2.5, "coil_current": 0.003}
NOISE = CHANNELS | {"damper_temperature": 0.1}
"""RMS by channel, in its unit."""
