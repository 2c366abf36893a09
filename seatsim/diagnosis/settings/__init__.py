"""Every threshold of a diagnosis in one immutable value.

Below each field stand its meaning with its unit, what is lost where it is raised or lowered, and how its value was
chosen: "on simulated rigs" whose effects have other functional forms than the candidates; "numerically", so that the
result does not depend on it; "by convention"; or by what is said. What a definition fixes (rows left out, channels
compared), and what only makes a computation accurate or quick (steps of a search, samples of a bootstrap), stands with
the code that uses it.
"""

from __future__ import annotations

from typing import NamedTuple

from seatsim.diagnosis.settings.examining import DamperFormSettings, DesignSettings, LocalisationSettings
from seatsim.diagnosis.settings.judging import DecisionSettings, ValidationSettings
from seatsim.diagnosis.settings.searching import NoiseSettings, SelectionSettings


class DiagnosisSettings(NamedTuple):
    """The thresholds of every stage; `settings._replace(noise=settings.noise._replace(model_error=0.1))` sets one."""

    noise: NoiseSettings = NoiseSettings()
    selection: SelectionSettings = SelectionSettings()
    decision: DecisionSettings = DecisionSettings()
    validation: ValidationSettings = ValidationSettings()
    localisation: LocalisationSettings = LocalisationSettings()
    design: DesignSettings = DesignSettings()
    damper_forms: DamperFormSettings = DamperFormSettings()
