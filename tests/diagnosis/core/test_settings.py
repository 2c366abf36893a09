"""Every threshold states what it is, none can be changed in place, and those that belong together agree."""

import pytest

from seatsim.diagnosis.settings.damper_forms import DamperFormSettings
from seatsim.diagnosis.settings.designing import DesignSettings
from seatsim.diagnosis.settings.diagnosis_settings import DiagnosisSettings
from seatsim.diagnosis.settings.fitting import FitSettings, WideningSettings
from seatsim.diagnosis.settings.judging import DecisionSettings
from seatsim.diagnosis.settings.localising import LocalisationSettings, ReconstructionSettings
from seatsim.diagnosis.settings.noise_model import NoiseSettings
from seatsim.diagnosis.settings.selecting import SelectionSettings
from seatsim.diagnosis.settings.threshold import Threshold, list_thresholds
from seatsim.diagnosis.settings.validating import CrossValidationSettings, ValidationSettings

GROUPS = (
    NoiseSettings, FitSettings, SelectionSettings, DecisionSettings, CrossValidationSettings, ValidationSettings,
    ReconstructionSettings, LocalisationSettings, DesignSettings, DamperFormSettings, WideningSettings,
)  # fmt: skip
UNITS = {"-", "Hz", "s", "%", "m/s", "m"}


@pytest.mark.parametrize("group", GROUPS)
def test_every_field_states_unit_meaning_trade_off_and_origin(group):
    stated = dict(list_thresholds(group))
    assert tuple(stated) == group._fields
    for threshold in stated.values():
        assert isinstance(threshold, Threshold)
        assert threshold.unit in UNITS
        assert len(threshold.meaning) > 15
        assert threshold.trade_off and threshold.chosen
        assert not any(text.endswith((".", " ")) for text in threshold)


def test_thresholds_that_belong_together_agree():
    _, fit, selection, decision, *_ = DiagnosisSettings()
    assert fit.backtracking[0] == 1.0 and list(fit.backtracking) == sorted(fit.backtracking, reverse=True)
    assert selection.limit_starts[0] == 1.0 and 1.0 in selection.start_factors
    assert min(selection.limit_factors) > 1.0 and list(selection.limit_factors) == sorted(selection.limit_factors)
    assert selection.enlarge < selection.worthwhile < selection.promising < 1.0
    assert selection.finalists <= selection.further_shortlist <= selection.first_shortlist
    # A known set is likelier than not, and an unknown cause or no gap is where they are the verdict.
    least, most = decision.unknown_if_known
    assert least < most < 0.5 < decision.unknown_if_unknown < 1.0
    assert decision.none_least > 0.5 > decision.none_if_gap
    assert decision.effect_if_none < decision.none_if_gap and decision.effect_bounds[0] < 0.5
    # A further effect is as likely as not where it leaves about the share that the selection asks for.
    assert decision.prior * selection.enlarge**-decision.power == pytest.approx(1.0, abs=0.25)
    assert decision.equivalent**decision.power == pytest.approx(2.0, abs=0.1)
    assert 0.06 < decision.explained < 0.15 < decision.left_in_channel
