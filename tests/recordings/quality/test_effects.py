"""What an effect of the library does to sound data is no fault of theirs, however large it is."""

import dataclasses

import numpy as np
import pytest

from seatsim.effects.base import EFFECTS
from seatsim.recordings.quality.examination import examine
from seatsim.recordings.recording import Recording, load_recording
from seatsim.recordings.replay import recorded_inputs
from seatsim.simulation.augment import read_sensors
from seatsim.simulation.respond import respond

from ...faulty_recordings import rewrite, scaled
from ...text import beside, parse

LARGE = parse(beside(__file__, "large_effects.yaml"))
"""Effects at the upper end of what is plausible, in several forms."""
ON_A_CHANNEL = {"sensor.gain": ({"error": 1.0}, {"error": -0.5}), "sensor.lag": ({"time": 0.1},)}
ON_A_CHANNEL |= {"sensor.bias": ({"share": 5.0}, {"share": -5.0})}
OF_A_SEAT = ("suspension.", "cushion.", "driver.", "floor.")
CHANNELS = parse("""
    seat: [floor_acceleration, frame_acceleration, driver_acceleration, suspension_displacement, damper_force,
        coil_current]
    bench: [displacement, damper_force, coil_current]
""")
LISTED = [(rig, name, several) for rig in CHANNELS for name, several in LARGE.items()]
LISTED = [each for each in LISTED if each[0] == "seat" or not each[1].startswith(OF_A_SEAT)]
for rig, channels in CHANNELS.items():
    for name, several in ON_A_CHANNEL.items():
        LISTED += [(rig, name, [{"channel": channel, **values} for values in several]) for channel in channels]
CASES = [
    pytest.param(rig, name, values, marks=pytest.mark.slow if k else ())
    for rig, name, several in LISTED
    for k, values in enumerate(several)
]
"""Every form and sign; the first of each is in the fast suite."""


def with_effect(recording, name, values):
    """Return the tables of a recording as a rig with an effect would have given them."""
    effect, nominal = EFFECTS.find(name)(**values), recording.nominal
    on_sensor = (effect,) if name.startswith("sensor.") else ()
    rig = dataclasses.replace(nominal, effects=() if on_sensor else (effect,))
    interval, tables = 1.0 / recording.header.sample_rate, {}
    for run in recording.runs:
        table, generator = recording.table(run), np.random.default_rng(3)
        outputs = respond(rig, recorded_inputs(recording, table, rig.solver.step))
        driving = {} if "current_command" in table else {"coil_current": table["coil_current"]}
        read = read_sensors(on_sensor, interval, {c: ({**table, **outputs} | driving)[c] for c in table})
        noise = {c: e.noise_rms * (c in outputs and c not in driving) for c, e in recording.channels.items()}
        tables[run] = {c: v + noise[c] * generator.standard_normal(len(v)) for c, v in read.items()}
    return tables


@dataclasses.dataclass(frozen=True)
class Held(Recording):
    """A recording whose tables are at hand."""

    tables: dict = dataclasses.field(default_factory=dict, kw_only=True)

    def table(self, run):
        return self.tables[run]


def examined(recording, tables):
    """Return the examination of a recording with other tables."""
    fields = {each.name: getattr(recording, each.name) for each in dataclasses.fields(recording)}
    return examine(Held(**fields, tables=tables))


def refusals(recording, tables):
    return [issue.sentence for issue in examined(recording, tables).errors]


@pytest.mark.parametrize(("rig", "name", "values"), CASES)
def test_an_effect_is_no_fault(sound, bench, rig, name, values):
    recording = load_recording(sound if rig == "seat" else bench)
    assert refusals(recording, with_effect(recording, name, values)) == []


@pytest.mark.parametrize("steps", [0.5, 5.0])
@pytest.mark.parametrize("rig", ["seat", "bench"])
def test_coarse_converters_are_no_fault_though_more_noise_is_stated(sound, bench, rig, steps):
    recording = load_recording(sound if rig == "seat" else bench)
    sizes = {name: steps * entry.noise_rms for name, entry in recording.channels.items()}
    tables = {
        run: {c: np.round(v / sizes[c]) * sizes[c] if sizes[c] else v for c, v in recording.table(run).items()}
        for run in recording.runs
    }
    louder = {c: e._replace(noise_rms=2.0 * max(1.0, steps) * e.noise_rms) for c, e in recording.channels.items()}
    assert refusals(dataclasses.replace(recording, channels=louder), tables) == []


def test_a_force_that_play_makes_late_is_a_doubt_that_says_so(bench):
    recording = load_recording(bench)
    tables = with_effect(recording, "damper.free_play", {"gap": 0.002, "stiffness": 1e5})
    (doubt,) = [issue for issue in examined(recording, tables).issues if issue.kind == "late"]
    assert doubt.severity == "warning" and "an effect may do this too" in doubt.sentence


@pytest.mark.parametrize(("factor", "severity"), [(1e-3, "error"), (0.1, "warning")])
def test_a_unit_is_a_fault_where_it_is_beyond_what_a_lost_current_does_to_a_force(copy, factor, severity):
    rewrite(copy, scaled("damper_force", factor))
    found = [issue for issue in examine(load_recording(copy)).issues if issue.channel == "damper_force"]
    assert {issue.severity for issue in found if issue.kind == "unit"} == {severity}
