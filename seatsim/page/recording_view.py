"""A recording on the page: its gap, effects that are switched on and off, and how far the gap shrinks with them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from seatsim.diagnosis.answer import write_augmented
from seatsim.diagnosis.objective import Parameters
from seatsim.diagnosis.trial import Trial, name_candidate
from seatsim.metrics.motion import rms
from seatsim.page.scenario_view import Choice, Slider, Switch, View, make_slider, read_number
from seatsim.report.formatting import describe_effect, format_noise, format_sentence, say_noise, show_table
from seatsim.report.packing import MEASURED, NOMINAL, QUICK, pack_traces
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError
from seatsim.schema.fields import describe
from seatsim.schema.printing import format_percent

REACH = 4.0
"""How far a slider reaches, in sizes of the effect as a fit would start with it."""


class RecordingView:
    """One recording, its nominal scenario replayed, and the effects that it could lack."""

    choices: Sequence[Choice] = ()
    sliders: Sequence[Slider] = ()

    def __init__(self, folder: Path) -> None:
        """Read a recording and replay its nominal scenario.

        Raises:
            InputError: the recording has a fault.
            RunError: the nominal scenario cannot be replayed.
        """
        self.name, self.trial = folder.resolve().name, Trial(folder)
        self.problem = problem = self.trial.problem
        self.before, self.floor = self.trial.measure(self.trial.nominal), problem.noise / problem.spread
        self.switches = list[Switch]()
        for name, candidate in self.trial.candidates.items():
            fields = {field.name: field for field in describe(candidate.cls)}
            ranges = zip(candidate.free, candidate.low, candidate.high, candidate.start, strict=True)
            sliders = [make_slider(fields[free], low, high, start, REACH) for free, low, high, start in ranges]
            meaning = format_sentence(describe_effect(candidate.effect))
            self.switches.append(Switch(name, name.replace(":", ", "), meaning, sliders))

    def show(self, request: Mapping[str, object]) -> View:
        """Return the gap with the effects of a request, at its values or, where it says so, fitted to the recording.

        Raises:
            InputError: there is no such effect, or a value is not permitted.
            RunError: a replay cannot be carried to its end.
        """
        parameters, fitted = self.choose(request), {}
        if request.get("fit") and parameters.terms:
            parameters = self.trial.fit(parameters)
            fitted = self._read_sliders(parameters)
        after = self.trial.simulate(parameters) if parameters.terms else self.trial.nominal
        gaps, rows = self.trial.measure(after), []
        for channel, old, new, noise in zip(self.problem.channels, self.before, gaps, self.floor, strict=True):
            first, second, shrink = map(format_percent, (old, new, 1 - new / old))
            rows.append([channel.replace("_", " "), first, second, format_noise(noise), shrink])
        lines = {"measured": ("measured", MEASURED), "nominal": ("nominal", NOMINAL), "after": ("with effects", 0)}
        signals = pack_traces(self.trial.list_traces(after), lines, QUICK)
        return View(self._say(len(parameters.terms), gaps), [*show_table("trial", rows)], signals, fitted=fitted)

    def choose(self, request: Mapping[str, object]) -> Parameters:
        """Return the effects of a request with their values."""
        wanted = request.get("effects", {})
        if not isinstance(wanted, dict):
            raise InputError("effects: a mapping of effects to the values of their parameters")
        found = Parameters(self.problem.nominal)
        sliders = {switch.name: switch.sliders for switch in self.switches}
        for name, values in wanted.items():
            if name not in sliders or not isinstance(values, dict):
                raise InputError(f"{name!r} is no effect that this recording can show")
            numbers = [read_number(values, slider) for slider in sliders[name]]
            found = found.add(self.trial.candidates[name], np.array(numbers))
        return found

    def encode(self, request: Mapping[str, object]) -> dict[str, object]:
        """Return the nominal scenario with the effects of a request, as the content of a file."""
        return write_augmented(self.problem, self.choose(request))

    def _read_sliders(self, parameters: Parameters) -> dict[str, dict[str, float]]:
        """Return where the sliders of the effects stand at these parameters."""
        sliders, found = {switch.name: switch.sliders for switch in self.switches}, {}
        for name, values in zip(map(name_candidate, parameters.terms), parameters.values, strict=True):
            moved = zip(sliders[name], values, strict=True)
            found[name] = {own.name: float(np.clip(own.factor * value, own.low, own.high)) for own, value in moved}
        return found

    def _say(self, effects: int, gaps: Array) -> str:
        before, now, floor = map(rms, (self.before, gaps, self.floor))
        if not effects:
            return f"The nominal simulation is off by {format_percent(before)}; {say_noise(floor)}."
        change = f"{'shrinks' if now < before else 'grows'} from {format_percent(before)} to {format_percent(now)}"
        return f"With {effects} effect{'s' * (effects > 1)} the gap {change}; {say_noise(floor)}."
