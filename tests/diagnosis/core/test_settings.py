"""Thresholds that belong together agree; that each is explained is checked by the page that lists them."""

import pytest

from seatsim.diagnosis.settings import DiagnosisSettings


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
