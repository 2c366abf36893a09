"""The open reference for semi-active seat suspensions.

Three name spaces are for users:

    seatsim                                   what the commands do: run, compare, sweep, gap, diagnose, identify, ...
    controllers                               design of control laws: synthesise
    seatsim.dampers, seatsim.effects,
    seatsim.laws                              what the writer of a damper, an effect or a control law needs

`docs/python.md` shows an example of each task. A name is imported when it is first asked for.
"""

from __future__ import annotations

from importlib import import_module

# As in `seatsim.cli.begin`: type checkers know the name, and `typing` is not loaded for it.
TYPE_CHECKING = False
if TYPE_CHECKING:
    __version__: str

    from seatsim.characterisation.summary import characterise as characterise
    from seatsim.cli.outputs.simulated import write_sweep_report
    from seatsim.diagnosis.diagnose import diagnose as diagnose
    from seatsim.diagnosis.result import Diagnosis as Diagnosis
    from seatsim.exchange.export import export as export
    from seatsim.identification.identify import Identification as Identification
    from seatsim.identification.identify import identify as identify
    from seatsim.plots.notebook import plot as plot
    from seatsim.recordings.gap import Gap as Gap
    from seatsim.recordings.gap import gap as gap
    from seatsim.recordings.prediction import Prediction as Prediction
    from seatsim.recordings.prediction import predict_gap as predict_gap
    from seatsim.recordings.recording import Recording as Recording
    from seatsim.recordings.recording import load_recording as load_recording
    from seatsim.scenario.loading import load as load
    from seatsim.scenario.scenario import Scenario as Scenario
    from seatsim.schema.errors import InputError as InputError
    from seatsim.schema.errors import RunError as RunError
    from seatsim.schema.errors import SeatsimError as SeatsimError
    from seatsim.schema.errors import SynthesisError as SynthesisError
    from seatsim.schema.modules import use as use
    from seatsim.simulation.result import Channel as Channel
    from seatsim.simulation.result import Result as Result
    from seatsim.simulation.result import Run as Run
    from seatsim.simulation.runs import compare as compare
    from seatsim.simulation.runs import run as run
    from seatsim.standards.comfort import Comfort as Comfort
    from seatsim.standards.comfort import comfort as comfort
    from seatsim.standards.seat_rows import SeatTest as SeatTest
    from seatsim.standards.seat_test import seat_test as seat_test
    from seatsim.sweeps.execute import sweep as sweep
    from seatsim.sweeps.parts import read_sweep as read_sweep

    sweep_report = write_sweep_report

_HOMES = {
    "characterisation.summary": "characterise",
    "cli.outputs.simulated": "sweep_report=write_sweep_report",
    "diagnosis.diagnose": "diagnose",
    "diagnosis.result": "Diagnosis",
    "exchange.export": "export",
    "identification.identify": "Identification identify",
    "plots.notebook": "plot",
    "recordings.gap": "Gap gap",
    "recordings.prediction": "Prediction predict_gap",
    "recordings.recording": "Recording load_recording",
    "scenario.loading": "load",
    "scenario.scenario": "Scenario",
    "schema.errors": "InputError RunError SeatsimError SynthesisError",
    "schema.modules": "use",
    "simulation.result": "Channel Result Run",
    "simulation.runs": "compare run",
    "standards.comfort": "Comfort comfort",
    "standards.seat_rows": "SeatTest",
    "standards.seat_test": "seat_test",
    "sweeps.execute": "sweep",
    "sweeps.parts": "read_sweep",
}
"""The public names of each module; `public=own` of one that is called otherwise in its module."""
_HOME = {name.partition("=")[0]: (home, name.rpartition("=")[2]) for home in _HOMES for name in _HOMES[home].split()}
__all__ = sorted(_HOME)  # noqa: PLE0605  # the names above, stated once


def __getattr__(name: str) -> object:
    """Import a public name when it is first asked for."""
    if name == "__version__":
        return import_module("importlib.metadata").version("seatsim")
    if name not in _HOME:
        raise AttributeError(f"module 'seatsim' has no attribute '{name}'")
    home, own = _HOME[name]
    return getattr(import_module(f"seatsim.{home}"), own)


def __dir__() -> list[str]:
    """List the public names."""
    return __all__
