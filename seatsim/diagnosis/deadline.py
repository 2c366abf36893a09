"""The time that a search may take, asked between simulations, never within one."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass


class OutOfTimeError(Exception):
    """The time of a search is spent; who catches it goes on with the best found so far."""


@dataclass(frozen=True)
class Deadline:
    """The instant at which a search ends, in seconds of `time.monotonic`."""

    end: float = math.inf

    @classmethod
    def after(cls, seconds: float) -> Deadline:
        """Return the deadline that lies so many seconds ahead."""
        return cls(time.monotonic() + seconds)

    @property
    def is_past(self) -> bool:
        """Whether the time is spent."""
        return time.monotonic() >= self.end

    def check(self) -> None:
        """Raise OutOfTimeError where the time is spent."""
        if self.is_past:
            raise OutOfTimeError


NEVER = Deadline()
"""No limit."""
