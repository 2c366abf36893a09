"""The open reference for semi-active seat suspensions."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from seatsim.diagnosis.diagnose import diagnose
    from seatsim.diagnosis.findings import Diagnosis
    from seatsim.errors import InputError, RunError, SeatsimError, SynthesisError
    from seatsim.identification.identify import Identification, identify
    from seatsim.loading import load
    from seatsim.recording import Recording, load_recording
    from seatsim.replay import Gap, gap
    from seatsim.result import Channel, Result, Run
    from seatsim.runs import compare, run
    from seatsim.scenario import Scenario

_HOME = {
    "Channel": "result",
    "Diagnosis": "diagnosis.findings",
    "Gap": "replay",
    "Identification": "identification.identify",
    "InputError": "errors",
    "Recording": "recording",
    "Result": "result",
    "Run": "result",
    "RunError": "errors",
    "Scenario": "scenario",
    "SeatsimError": "errors",
    "SynthesisError": "errors",
    "compare": "runs",
    "diagnose": "diagnosis.diagnose",
    "gap": "replay",
    "identify": "identification.identify",
    "load": "loading",
    "load_recording": "recording",
    "run": "runs",
}
__all__ = [
    "Channel",
    "Diagnosis",
    "Gap",
    "Identification",
    "InputError",
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
    "run",
]


def __getattr__(name: str) -> Any:
    """Import a public name when it is first asked for."""
    if name not in _HOME:
        raise AttributeError(f"module 'seatsim' has no attribute '{name}'")
    return getattr(import_module(f"seatsim.{_HOME[name]}"), name)
