"""The open reference for semi-active seat suspensions."""

from __future__ import annotations

from importlib import import_module

# As in `seatsim.cli.begin`: type checkers know the name, and `typing` is not loaded for it.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from seatsim.diagnosis.diagnose import diagnose
    from seatsim.diagnosis.result import Diagnosis
    from seatsim.identification.identify import Identification, identify
    from seatsim.plots.notebook import plot
    from seatsim.recordings.gap import Gap, gap
    from seatsim.recordings.prediction import Prediction, predict_gap
    from seatsim.recordings.recording import Recording, load_recording
    from seatsim.scenario.loading import load
    from seatsim.scenario.scenario import Scenario
    from seatsim.schema.errors import InputError, RunError, SeatsimError, SynthesisError
    from seatsim.schema.modules import use
    from seatsim.simulation.result import Channel, Result, Run
    from seatsim.simulation.runs import compare, run
    from seatsim.standards.comfort import Comfort, comfort
    from seatsim.standards.seat_rows import SeatTest
    from seatsim.standards.seat_test import seat_test
    from seatsim.sweeps.read import read_sweep

_HOME = {
    "Channel": "simulation.result",
    "Comfort": "standards.comfort",
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
    "SeatTest": "standards.seat_rows",
    "SeatsimError": "schema.errors",
    "SynthesisError": "schema.errors",
    "comfort": "standards.comfort",
    "compare": "simulation.runs",
    "diagnose": "diagnosis.diagnose",
    "gap": "recordings.gap",
    "identify": "identification.identify",
    "load": "scenario.loading",
    "load_recording": "recordings.recording",
    "plot": "plots.notebook",
    "predict_gap": "recordings.prediction",
    "read_sweep": "sweeps.read",
    "run": "simulation.runs",
    "seat_test": "standards.seat_test",
    "use": "schema.modules",
}
__all__ = [
    "Channel",
    "Comfort",
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
    "SeatTest",
    "SeatsimError",
    "SynthesisError",
    "comfort",
    "compare",
    "diagnose",
    "gap",
    "identify",
    "load",
    "load_recording",
    "plot",
    "predict_gap",
    "read_sweep",
    "run",
    "seat_test",
    "use",
]


def __getattr__(name: str) -> Any:
    """Import a public name when it is first asked for."""
    if name == "__version__":
        return import_module("importlib.metadata").version("seatsim")
    if name not in _HOME:
        raise AttributeError(f"module 'seatsim' has no attribute '{name}'")
    return getattr(import_module(f"seatsim.{_HOME[name]}"), name)
