"""The channels of one run, as the metrics ask for them."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike

from seatsim.metrics.arrays import Array, as_signal, finite, positive
from seatsim.metrics.weighting import can_weight, weight
from seatsim.schema.errors import InputError


class Absent(Exception):  # noqa: N818 - not an error: the metric that asked is left out
    """What a metric asked for is not in the record."""


class Record:
    """Channels of one length, sampled every `step` s; the first `settle` seconds count as starting up."""

    def __init__(self, channels: Mapping[str, ArrayLike], step: float, settle: float) -> None:
        self.sample_rate = 1 / positive(step, "step")
        self._channels = {name: as_signal(values, name) for name, values in channels.items()}
        self._weighted: dict[str, Array] = {}
        self._check(settle)
        self._start = round(settle * self.sample_rate)

    def whole(self, name: str) -> Array:
        """Return a channel over the whole record; one that holds nothing but NaN counts as absent.

        Raises:
            Absent: the channel is not there.
        """
        values = self._channels.get(name)
        if values is None or np.isnan(values).all():
            raise Absent(name)
        return values

    def settled(self, name: str) -> Array:
        """Return a channel without the start of the record.

        Raises:
            Absent: the channel is not there.
        """
        return self.whole(name)[self._start :]

    def weighted(self, name: str) -> Array:
        """Return a channel weighted with Wk over the whole record, then without the start; worked out once.

        Raises:
            Absent: the channel is not there, or its sample rate is too low for the weighting.
            InputError: a sample is not finite.
        """
        if name not in self._weighted:
            if not can_weight(self.sample_rate):
                raise Absent(name)
            self._weighted[name] = weight(finite(self.whole(name), name), self.sample_rate)
        return self._weighted[name][self._start :]

    def _check(self, settle: float) -> None:
        lengths = {name: values.size for name, values in self._channels.items()}
        if len(set(lengths.values())) > 1:
            raise InputError(f"channels: have different numbers of samples, {lengths}; must all be the same")
        samples = min(lengths.values(), default=math.inf)
        if not 0 <= settle * self.sample_rate < samples - 0.5:
            lasts = samples / self.sample_rate
            raise InputError(f"settle: is {settle} s; must be 0 or more and less than the record's {lasts:g} s")
