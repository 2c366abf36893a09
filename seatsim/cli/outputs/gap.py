"""Files of a gap: `gap.json`, and `report.html` where outputs were measured."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from seatsim.provenance.manifest import write_documented
from seatsim.recordings.gap import Gap, replay_every_run
from seatsim.report.credibility.evidence import collect_gap
from seatsim.report.gap import report_gap
from seatsim.report.rendering import write_html
from seatsim.schema.files import write_json


def write_gap(
    content: Mapping[str, object], found: Gap | None, scenario: str, recording: Path, folder: Path
) -> list[Path]:
    """Write `gap.json`, and the report of a gap that was measured; return their paths.

    Args:
        content: of `gap.json`.
        found: the gap, None where the recording holds inputs alone.
        scenario: file or name of the scenario that was replayed.
        recording: folder of the recording.
        folder: where the files go.
    """
    report = None
    if found is not None:
        pairs = replay_every_run(scenario, recording)
        name = f"{Path(scenario).stem} against {recording.resolve().name}"
        report = report_gap(
            name,
            found,
            pairs,
            collect_gap(scenario, recording, found),
            f"seatsim gap {Path(scenario).name} {recording.name}",
        )
    return write_documented(
        folder,
        lambda part: [
            write_json(part / "gap.json", content),
            *([write_html(report, part / "report.html")] if report else []),
        ],
    )
