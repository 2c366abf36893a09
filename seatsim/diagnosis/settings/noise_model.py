"""Settings of the noise model."""

from __future__ import annotations

from typing import Annotated, NamedTuple

from seatsim.diagnosis.settings.threshold import CONVENTION, NUMERICAL, SIMULATED_RIGS, Threshold


class NoiseSettings(NamedTuple):
    """What counts as noise in the residuals, by channel and frequency."""

    highest_frequency: Annotated[
        float,
        Threshold(
            "Hz",
            "content above it is not compared",
            "higher: broadband noise dilutes the evidence; lower: stops and clearances are seen less",
            "above what a seat transmits, below what 500 rows per second resolve",
        ),
    ] = 100.0
    model_error: Annotated[
        float,
        Threshold(
            "-",
            "share of a channel's local amplitude spectrum that a right model may miss",
            "higher: small effects stay unseen; lower: the form of the nominal model is taken for an effect",
            SIMULATED_RIGS,
        ),
    ] = 0.01
    smoothing: Annotated[
        float,
        Threshold(
            "-",
            "half-width, relative to the frequency, over which spectra are averaged",
            "wider: narrow resonances are smeared; narrower: the weights themselves are random",
            CONVENTION,
        ),
    ] = 0.15
    replicates: Annotated[
        int,
        Threshold(
            "-",
            "simulations with newly drawn input noise per run",
            "more: smoother spectra of the carried noise; fewer: less time",
            NUMERICAL,
        ),
    ] = 3
    least_power: Annotated[
        float,
        Threshold(
            "-",
            "least noise power, as a share of a channel's variance",
            "a lower one lets noiseless channels dominate all others",
            NUMERICAL,
        ),
    ] = 1e-6
    broadband_excess: Annotated[
        float,
        Threshold(
            "-",
            "factor on the stated noise power above `highest_frequency` from which a residual is broadband",
            "lower: understated sensor noise is taken for a broadband residual",
            SIMULATED_RIGS,
        ),
    ] = 2.0
    broadband_share: Annotated[
        float,
        Threshold(
            "-",
            "share of what the best set leaves from which a broadband residual is added to the noise",
            "lower: real effects are counted as noise; higher: a broadband residual makes a verdict unknown",
            SIMULATED_RIGS,
        ),
    ] = 0.5
