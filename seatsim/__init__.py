"""The open reference for semi-active seat suspensions."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from seatsim.diagnosis.diagnose import diagnose
    from seatsim.diagnosis.result import Diagnosis
    from seatsim.identification.identify import Identification, identify
    from seatsim.recordings.gap import Gap, gap
    from seatsim.recordings.prediction import Prediction, predict_gap
    from seatsim.recordings.recording import Recording, load_recording
    from seatsim.scenario.loading import load
    from seatsim.scenario.scenario import Scenario
    from seatsim.schema.errors import InputError, RunError, SeatsimError, SynthesisError
    from seatsim.schema.modules import use
    from seatsim.simulation.result import Channel, Result, Run
    from seatsim.simulation.runs import compare, run

_HOME = {
    "Channel": "simulation.result",
    "Diagnosis": "diagnosis.result",
    "Gap": "recordings.gap",
    "Identification": "identification.identify",
    "InputError": "schema.errors",
    "Prediction": "recordings.prediction",
    "Recording": "recordings.recording",
    "Result": "simulation.result",
    "Run": "simulation.result",
    "RunError": "schema.errors",
    "Scenario": "scenario.scenario",
    "SeatsimError": "schema.errors",
    "SynthesisError": "schema.errors",
    "compare": "simulation.runs",
    "diagnose": "diagnosis.diagnose",
    "gap": "recordings.gap",
    "identify": "identification.identify",
    "load": "scenario.loading",
    "load_recording": "recordings.recording",
    "predict_gap": "recordings.prediction",
    "run": "simulation.runs",
    "use": "schema.modules",
}
__all__ = [
    "Channel",
    "Diagnosis",
    "Gap",
    "Identification",
    "InputError",
    "Prediction",
    "Recording",
    "Result",
    "Run",
    "RunError",
    "Scenario",
    "SeatsimError",
    "SynthesisError",
    "compare",
    "diagnose",
    "gap",
    "identify",
    "load",
    "load_recording",
    "predict_gap",
    "run",
    "use",
]


def __getattr__(name: str) -> Any:
    """Import a public name when it is first asked for."""
    if name not in _HOME:
        raise AttributeError(f"module 'seatsim' has no attribute '{name}'")
    return getattr(import_module(f"seatsim.{_HOME[name]}"), name)
