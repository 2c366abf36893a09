"""All settings of a diagnosis."""

from __future__ import annotations

from typing import NamedTuple

from seatsim.diagnosis.settings.damper_forms import DamperFormSettings
from seatsim.diagnosis.settings.designing import DesignSettings
from seatsim.diagnosis.settings.fitting import FitSettings, WideningSettings
from seatsim.diagnosis.settings.judging import DecisionSettings
from seatsim.diagnosis.settings.localising import LocalisationSettings, ReconstructionSettings
from seatsim.diagnosis.settings.noise_model import NoiseSettings
from seatsim.diagnosis.settings.selecting import SelectionSettings
from seatsim.diagnosis.settings.validating import CrossValidationSettings, ValidationSettings


class DiagnosisSettings(NamedTuple):
    """The thresholds of every stage; `settings._replace(fit=settings.fit._replace(most_steps=3))` changes one."""

    noise: NoiseSettings = NoiseSettings()
    fit: FitSettings = FitSettings()
    selection: SelectionSettings = SelectionSettings()
    decision: DecisionSettings = DecisionSettings()
    cross_validation: CrossValidationSettings = CrossValidationSettings()
    validation: ValidationSettings = ValidationSettings()
    reconstruction: ReconstructionSettings = ReconstructionSettings()
    localisation: LocalisationSettings = LocalisationSettings()
    design: DesignSettings = DesignSettings()
    damper_forms: DamperFormSettings = DamperFormSettings()
    widening: WideningSettings = WideningSettings()
