"""A small recording without faults, and faults that its data may have.

A fault takes the table of a run, as a pandas frame, and returns it faulty; it is done to every run.
"""

import numpy as np
import pandas as pd
from ruamel.yaml import YAML

import seatsim
from seatsim.recordings.writer import save_recording

from .text import parse, words

RATE = 250.0
NOISE = parse("""
    {floor_acceleration: 0.01, frame_acceleration: 0.03, driver_acceleration: 0.015,
     suspension_displacement: 5e-05, damper_force: 2.5, current_command: 0.0, coil_current: 0.003,
     damper_temperature: 0.1}
""")
DECIMALS = {"suspension_displacement": 6, "damper_force": 2, "damper_temperature": 2}
G = 9.81
QUICK = {"method": "gzip", "compresslevel": 1}
FEEDBACK = {"excitation.duration": 8.0, "controller.sample_time": 0.008}
"""Settings of the first run: the samples of the controller are every second row."""


def record_sound_rig(scenario, folder):
    """Simulate two runs of a seat scenario, 8 s at 250 Hz each, and save them as a recording with noise."""
    switched = {"excitation.duration": 8.0, "controller": {"law": "on_off_skyhook", "on": 0.6}}
    runs = {"feedback": FEEDBACK, "switched": switched}
    result = seatsim.run(scenario, {"variants": runs, "solver": {"step": 1.0 / RATE}})
    save_recording(result, folder, list(NOISE))
    generator = np.random.default_rng(5)
    rewrite(folder, lambda frame: noisy(frame, generator))
    edit(folder, lambda header: [header["channels"][c].update(noise_rms=n) for c, n in NOISE.items()])
    return folder


def noisy(frame, generator):
    columns = {c: frame[c] + n * generator.standard_normal(len(frame)) for c, n in NOISE.items()}
    return frame.assign(**{c: values.round(DECIMALS.get(c, 4)) for c, values in columns.items()})


def rewrite(folder, fault, files=None):
    """Hand the tables of a recording through a fault."""
    for path in files or sorted(folder.glob("*.csv.gz")):
        fault(pd.read_csv(path)).to_csv(path, index=False, float_format="%.7g", compression=QUICK)


def edit(folder, change):
    """Change what `recording.yaml` says."""
    path, yaml = folder / "recording.yaml", YAML(typ="safe")
    header = yaml.load(path)
    change(header)
    yaml.dump(header, path)


def scaled(channel, factor):
    return lambda frame: frame.assign(**{channel: factor * frame[channel]})


def shifted(channel, offset):
    return lambda frame: frame.assign(**{channel: frame[channel] + offset})


def exchanged(first, second):
    return lambda frame: frame.assign(**{first: frame[second], second: frame[first]})


def late(seconds, *channels):
    """Delay channels, held before their first row."""
    rows = round(seconds * RATE)
    return lambda f: f.assign(**{c: f[c].shift(rows).bfill().ffill() for c in channels})


def clipped(channel, share):
    """Cut a channel at a share of its largest value."""
    return lambda f: f.assign(**{channel: f[channel].clip(*(f[channel].abs().max() * np.array([-share, share])))})


def blurred(faulty):
    """Let the accelerometer of the floor show what a fault makes of its values, and its noise."""
    noise = NOISE["floor_acceleration"]
    return lambda f: louder("floor_acceleration", noise)(f.assign(floor_acceleration=faulty(f.floor_acceleration)))


def stepped(values):
    return 0.8 * (values / 0.8).round()


def limited(values):
    return values.clip(-2.0, 2.0)


def with_play(values):
    """Follow at a distance of 0.5 m/s^2 at most, and rest within it."""
    followed = [0.0]
    for value in values:
        followed.append(min(max(followed[-1], value - 0.5), value + 0.5))
    return np.array(followed[1:])


def constant(channel, value=0.0):
    return lambda frame: frame.assign(**{channel: value})


def spiked(channel):
    """Let five rows jump by 50 standard deviations."""

    def spoil(frame):
        values = frame[channel].to_numpy(copy=True)
        values[[402, 690, 1001, 1313, 1755]] += 50.0 * values.std() * np.array([1, -1, 1, -1, 1])
        return frame.assign(**{channel: values})

    return spoil


def doubled(frame):
    return frame.iloc[np.sort([*range(len(frame)), *range(700, 705)])]


def halved(frame):
    return frame.iloc[::2]


def without_time(fault):
    return lambda frame: fault(frame).drop(columns="time")


def stuck(channel, start, end):
    """Hold a channel between two instants."""
    return lambda f: f.assign(**{channel: f[channel].mask((f.time > start) & (f.time <= end)).ffill()})


def dropped(channel, start, end):
    """Let a channel read zero between two instants."""
    return lambda f: f.assign(**{channel: f[channel].mask((f.time > start) & (f.time <= end), 0.0)})


def without(start, end):
    """Leave out the rows between two instants."""
    return lambda frame: frame[(frame.time <= start) | (frame.time > end)]


def holed(channel):
    return lambda frame: frame.assign(**{channel: frame[channel].mask(frame.time.between(3.0, 3.1))})


def louder(channel, rms):
    """Add noise to a channel."""
    return lambda f: f.assign(**{channel: f[channel] + rms * np.random.default_rng(1).standard_normal(len(f))})


def at_rest(frame):
    """Leave nothing but noise in all channels that move."""
    moving = [c for c in NOISE if c.endswith(("acceleration", "displacement", "force"))]
    generator = np.random.default_rng(2)
    return frame.assign(**{c: (NOISE[c] * generator.standard_normal(len(frame))).round(7) for c in moving})


def upside_down(frame):
    return frame.assign(**{c: -frame[c] for c in frame if c.endswith("_acceleration")})


SIGNS = words("""
    floor_acceleration frame_acceleration driver_acceleration suspension_displacement damper_force current_command
    coil_current
""")
FAULTS = {f"sign of {c}": (scaled(c, -1.0), c, "sign is swapped") for c in SIGNS} | {
    "no rows": (lambda frame: frame.iloc[:0], None, "holds 0 rows"),
    "holes": (holed("frame_acceleration"), "frame_acceleration", "line 752, frame_acceleration: 'nan' (and 25 more"),
    "no column": (lambda frame: frame.drop(columns="coil_current"), "coil_current", "is missing"),
    "missing rows": (without(3.0, 3.4), "time", "rows are missing"),
    "another rate": (halved, "time", "rows are 0.008 s apart"),
    "half a second": (lambda frame: frame.iloc[:125], None, "its first second is left out"),
    "two seconds": (lambda frame: frame.iloc[:500], None, "2 s remain to compare"),
    "clipped force": (clipped("damper_force", 0.7), "damper_force", "is clipped"),
    "dead": (constant("driver_acceleration"), "driver_acceleration", "throughout"),
    "dead floor": (constant("floor_acceleration"), "floor_acceleration", "does not move while"),
    "stuck": (stuck("suspension_displacement", 4.0, 5.0), "suspension_displacement", "is stuck from 4 to 5"),
    "at rest": (at_rest, None, "nothing moves"),
    "driver in mm/s^2": (scaled("driver_acceleration", 1000.0), "driver_acceleration", "in mm/s^2"),
    "command in mA": (scaled("current_command", 1000.0), "current_command", "in mA"),
    "travel in mm": (scaled("suspension_displacement", 1000.0), "suspension_displacement", "in mm"),
    "travel in inch": (scaled("suspension_displacement", 1 / 0.0254), "suspension_displacement", "in inch"),
    "floor in g": (scaled("floor_acceleration", 1 / G), "floor_acceleration", "in g"),
    "force in kN": (scaled("damper_force", 1e-3), "damper_force", "in kN"),
    "accelerations upside down": (upside_down, "driver_acceleration", "signs are swapped"),
    "frame for driver": (exchanged("frame_acceleration", "driver_acceleration"), "frame_acceleration", "exchanged"),
    "floor for frame": (exchanged("floor_acceleration", "frame_acceleration"), "floor_acceleration", "exchanged"),
    "late displacement": (late(0.1, "suspension_displacement"), "suspension_displacement", "s late"),
}
"""Faults for which diagnosis and gap must refuse: what is done, the channel named, and words of the sentence."""
WARNINGS = {
    "noisier than stated": (louder("driver_acceleration", 0.1), "driver_acceleration", "noise_rms is stated as 0.015"),
    "too large a current": (shifted("coil_current", 0.8), "coil_current", "outside 0 to 1 A"),
    "floor with play": (blurred(with_play), "floor_acceleration", "steps or play"),
    "gravity upside down": (shifted("driver_acceleration", -9.7), "driver_acceleration", "is gravity"),
    "half a metre per square second": (shifted("floor_acceleration", 0.5), "floor_acceleration", "an offset"),
    "a travel of another zero": (shifted("suspension_displacement", 0.1), "suspension_displacement", "sensor's zero"),
    "a dropout": (dropped("damper_force", 3.0, 3.2), "damper_force", "a dropout"),
    "halved command": (scaled("current_command", 0.5), "coil_current", "the scale of one of both is wrong"),
    "no command at all": (constant("current_command"), "current_command", "is 0 throughout while coil_current changes"),
    "doubled rows": (without_time(doubled), None, "hold in every channel what a row before holds"),
    "lost rows": (without_time(without(2.8, 2.88)), "suspension_displacement", "rows were lost"),
    "a rate that is twice too low": (without_time(halved), "suspension_displacement", "or the sample rate"),
    "spikes of the floor": (spiked("floor_acceleration"), "floor_acceleration", "spikes of up to"),
    "spikes of the force": (spiked("damper_force"), "damper_force", "spikes of up to"),
}
"""Faults that are said while diagnosis and gap go on."""
