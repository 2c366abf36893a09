"""What each command prints with `--json`: one object, whose JSON Schema `seatsim schema COMMAND` prints.

An object may have more keys than stand here. Numbers that do not exist are null.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import cast

from pydantic import TypeAdapter

from seatsim.cli.outputs.answers.common import ErrorAnswer
from seatsim.cli.outputs.answers.files import CheckAnswer, DescriptionAnswer, ExploreAnswer, NewAnswer, ReproduceAnswer
from seatsim.cli.outputs.answers.measurement import (
    BlindMakeAnswer,
    BlindPowerAnswer,
    BlindScoreAnswer,
    CharacterisationAnswer,
    ComfortAnswer,
    DiagnosisAnswer,
    GapAnswer,
    IdentificationAnswer,
    ImportAnswer,
    InspectionAnswer,
    LeagueAnswer,
)
from seatsim.cli.outputs.answers.simulation import (
    ExportAnswer,
    RunAnswer,
    SeatTestAnswer,
    SlurmAnswer,
    SweepAnswer,
    SweepReportAnswer,
    SynthesisAnswer,
)

ANSWERS: Mapping[str, object] = {
    "run": RunAnswer, "compare": RunAnswer, "sweep": SweepAnswer | SlurmAnswer, "sweep-report": SweepReportAnswer,
    "synthesise": SynthesisAnswer, "gap": GapAnswer,
    "diagnose": DiagnosisAnswer, "characterise": CharacterisationAnswer,
    "identify": IdentificationAnswer | LeagueAnswer, "describe": DescriptionAnswer, "new": NewAnswer,
    "check": CheckAnswer, "import": ImportAnswer, "inspect": InspectionAnswer, "comfort": ComfortAnswer,
    "seat-test": SeatTestAnswer, "export": ExportAnswer, "blind-make": BlindMakeAnswer, "blind-score": BlindScoreAnswer,
    "blind-power": BlindPowerAnswer, "explore": ExploreAnswer, "reproduce": ReproduceAnswer,
    "error": ErrorAnswer,
}  # fmt: skip
"""What each command prints; `error` is what any of them prints where it fails."""


def answer_schema(command: str) -> dict[str, object]:
    """Return the JSON Schema of what a command prints with `--json`."""
    return {"title": f"seatsim {command} --json", **TypeAdapter(cast("type", ANSWERS[command])).json_schema()}
