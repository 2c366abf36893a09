"""The channels of one run, as the metrics ask for them."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike

from seatsim.metrics.arrays import as_signal, require_finite, require_positive
from seatsim.metrics.weighting import can_weight, weight
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError


class MissingInput(Exception):  # noqa: N818 - not an error: the metric that asked is left out
    """What a metric asked for is not in the record."""


class RunChannels:
    """Channels of one run, all of one length, sampled every `step` s; the first `settle` seconds are its start-up.

    Raises:
        InputError: step or settle is out of range, or the channels differ in length.
    """

    def __init__(self, channels: Mapping[str, ArrayLike], step: float, settle: float) -> None:
        self.sample_rate = 1 / require_positive(step, "step")
        self._channels = {name: as_signal(values, name) for name, values in channels.items()}
        self._weighted: dict[str, Array] = {}
        self._check(settle)
        self._start = round(settle * self.sample_rate)

    def whole(self, name: str) -> Array:
        """Return a channel over the whole record; one that holds nothing but NaN counts as absent.

        Raises:
            MissingInput: the channel is not there.
        """
        # A channel of NaN is how a history says that a law wants no force: there is nothing to average.
        values = self._channels.get(name)
        if values is None or (math.isnan(values[0]) and np.isnan(values).all()):
            raise MissingInput(name)
        return values

    def settled(self, name: str) -> Array:
        """Return a channel without the start of the record.

        Raises:
            MissingInput: the channel is not there.
        """
        return self.whole(name)[self._start :]

    def weighted(self, name: str) -> Array:
        """Return a channel weighted with Wk over the whole record, then without the start-up; worked out once.

        The weighting comes first: its high-pass takes 2 s to forget where the record begins, so that cutting
        before it would add a transient to what is kept.

        Raises:
            MissingInput: the channel is not there, or its sample rate is too low for the weighting.
            InputError: a sample is not finite.
        """
        if name not in self._weighted:
            if not can_weight(self.sample_rate):
                raise MissingInput(name)
            self._weighted[name] = weight(require_finite(self.whole(name), name), self.sample_rate)
        return self._weighted[name][self._start :]

    def _check(self, settle: float) -> None:
        lengths = {name: values.size for name, values in self._channels.items()}
        if len(set(lengths.values())) > 1:
            raise InputError(f"channels: have different numbers of samples, {lengths}; must all be the same")
        samples = min(lengths.values(), default=math.inf)
        # Half a sample short of the record, so that rounding leaves at least one sample to average.
        if not 0 <= settle * self.sample_rate < samples - 0.5:
            lasts = samples / self.sample_rate
            raise InputError(f"settle: is {settle} s; must be 0 or more and less than the record's {lasts:g} s")
