"""Write the JSON Schemas: of scenarios, recordings and sweeps beside the examples, of `--json` in `docs/schemas`."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

from seatsim.cli.outputs.answers import FILES, describe_answer, list_answers

ROOT = Path(__file__).resolve().parents[1]


def schemas() -> Mapping[str, str]:
    """Return the text of every file by its path from the root."""
    files = {f"scenarios/schema/{kind}.json": json.dumps(FILES[kind]()) for kind in ("scenario", "recording", "sweep")}
    answers = {f"docs/schemas/{name}.json": json.dumps(describe_answer(name), indent=1) for name in list_answers()}
    return {path: f"{text}\n" for path, text in (files | answers).items()}


if __name__ == "__main__":
    for path, text in schemas().items():
        (ROOT / path).parent.mkdir(exist_ok=True)
        (ROOT / path).write_text(text, encoding="utf-8")
