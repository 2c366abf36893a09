"""The public names: what type checkers know of them, and from which module each is imported."""

from seatsim.characterisation.summary import characterise as characterise
from seatsim.cli.outputs.simulated import sweep_report as sweep_report
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

__version__: str
