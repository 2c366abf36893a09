"""Every threshold states what it is, none can be changed in place, and those that belong together agree."""

from typing import get_args, get_origin, get_type_hints

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
OF_RECORD = {
    NoiseSettings: (100.0, 0.01, 0.15, 3, 1e-6, 2.0, 0.5),
    FitSettings: (0.58, 0.02, 6, 0.01, (1.0, 0.4, 0.12), (0.3, 0.15, 0.08, 0.04, 0.02), 0.7, 0.5),
    SelectionSettings: (
        12, 7, 4, 2, 2, 3, 2, 6.0, 1.5, 3, (0.6, 1.0, 1.6), (1.08, 1.16, 1.27), (1.0, 0.5, 0.7, 1.4, 2.0), 8.0, 1e-3,
        0.15, 0.97, 0.45, 0.7, 0.85, 0.85,
    ),
    DecisionSettings: (
        0.05, 0.12, 0.65, 0.35, 0.5, 1.2, 0.02, 20.0, 0.02, 0.9, 2, 0.02, 0.05, 2.0, 0.6, 0.4, 1e-4,
        (0.02, 0.45), 0.55, 0.02, 0.01, 0.004, 0.05, 4.0, 0.1, (0.006, 0.98), 0.5, 0.01, (0.9, 0.01, 0.1),
    ),
    CrossValidationSettings: (0.1, 40.0, 3.0, 0.01, 8, 3, 1.5),
    ValidationSettings: (1.0, 400, (5.0, 95.0), 0.1, 0.6, 0.05, 0.25, 0.03, 1e-5, 2.0),
    ReconstructionSettings: (0.1, 10.0, 2.0, 40.0, 20, 0.02, 2, (1.0, 0.4, 0.15, 0.05), 1.2),
    LocalisationSettings: (
        0.1, 1.0, 0.02, 1.2, 0.5, 0.9, 2.0, 0.6, 100.0, 10, 1e-3, 1e-9, 0.12, 1.4, 2.0, 0.03, 0.005, 0.1,
    ),
    DamperFormSettings: (
        ("biviscous", "bouc_wen", "phase_transition", "maxwell_nonlinear_slider", "ellis"), 0.1, 4000, (4, 12), 0.1,
    ),
    DesignSettings: (1e-9, 10.0, 4, 8.0, 30.0, 0.9, 10, 0.003, 16, 0.05),
    WideningSettings: (0.98, 3.0, 0.7, 0.5, 3),
}  # fmt: skip
"""Values with which the figures of the documentation were measured; another one needs the benchmarks run anew."""


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


@pytest.mark.parametrize("group", GROUPS)
def test_every_default_is_of_the_type_that_is_stated(group):
    for name, kind in get_type_hints(group).items():
        value = group._field_defaults[name]
        if get_origin(kind) is tuple:
            members = get_args(kind)
            assert type(value) is tuple and all(type(each) is members[0] for each in value)
            assert Ellipsis in members or len(value) == len(members)
        else:
            assert type(value) is kind


def test_a_threshold_is_found_by_name_and_one_without_a_statement_is_not():
    stated = dict(list_thresholds(NoiseSettings))
    assert stated["highest_frequency"].unit == "Hz"
    assert dict(list_thresholds(ValidationSettings))["percentiles"].unit == "%"
    assert dict(list_thresholds(ValidationSettings))["block_length"].unit == "s"
    assert list(list_thresholds(Threshold)) == []


def test_the_settings_hold_one_value_of_each_group():
    settings = DiagnosisSettings()
    assert [type(group) for group in settings] == list(GROUPS)
    assert all(group == type(group)() for group in settings)
    hints = get_type_hints(DiagnosisSettings)
    assert [hints[name] for name in settings._fields] == list(GROUPS)


def test_nothing_is_changed_in_place():
    settings = DiagnosisSettings()
    with pytest.raises(AttributeError):
        settings.fit = FitSettings()
    for group in settings:
        for name in group._fields:
            with pytest.raises(AttributeError):
                setattr(group, name, 0.0)
            hash(getattr(group, name))
    changed = settings._replace(fit=settings.fit._replace(most_steps=3))
    assert changed.fit.most_steps == 3 and settings.fit.most_steps == DiagnosisSettings().fit.most_steps == 6
    assert changed.noise is settings.noise


@pytest.mark.parametrize("group", GROUPS)
def test_the_thresholds_are_those_that_the_documented_figures_were_measured_with(group):
    assert tuple(group()) == OF_RECORD[group]


def test_the_prior_is_that_of_a_uniform_distribution_over_the_tolerance():
    assert FitSettings().prior_std == pytest.approx(1 / 3**0.5, abs=0.005)


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
