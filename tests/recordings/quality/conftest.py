"""A run under test made of arrays at hand."""

from pathlib import Path

import pytest

from seatsim.recordings.quality.issue import RunUnderTest
from seatsim.recordings.recording import SEAT_CHANNELS, ChannelEntry, Header, Recording, RunEntry
from seatsim.scenario.loading import single


@pytest.fixture
def under_test(kept_seat_file):
    """A function from channels, their noise and the rate to a run of a seat with its nominal scenario."""
    nominal = single(kept_seat_file)

    def build(table, rate=250.0, noise=None, name="run-a", repeat_of=None):
        stated = noise or {}
        channels = {channel: ChannelEntry(SEAT_CHANNELS[channel], stated.get(channel, 0.0)) for channel in table}
        runs = {name: RunEntry(name, f"{name}.csv", repeat_of)}
        recording = Recording(Path("nowhere"), Header("seat", rate, "nominal.yaml"), runs, channels, None)
        return RunUnderTest(name, table, recording, nominal)

    return build
