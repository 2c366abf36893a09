"""Write `settings.md`: every threshold of a diagnosis, as `seatsim.diagnosis.settings` states it."""

from __future__ import annotations

import inspect
from collections.abc import Iterator
from pathlib import Path

from seatsim.diagnosis.settings.diagnosis_settings import DiagnosisSettings
from seatsim.diagnosis.settings.threshold import CONVENTION, NUMERICAL, SIMULATED_RIGS, Settings, list_thresholds

PAGE = Path(__file__).with_name("settings.md")
BAR = r"\|"
LETTERS = {SIMULATED_RIGS: "S", NUMERICAL: "N", CONVENTION: "C"}
"""How most values were chosen, as the last column of the tables says it."""
HEAD = f"""# Settings of a diagnosis

Every threshold on which a [diagnosis](diagnosis_theory.md) rests: value, unit, meaning, what is lost where it is raised
or lowered, and how it was chosen: {"; ".join(f"{letter}, {chosen}" for chosen, letter in LETTERS.items())}. Built by
`python docs/build_settings.py`. Another value is asked for in Python:

<!-- not run -->
```python
import seatsim
from seatsim.diagnosis.settings.diagnosis_settings import DiagnosisSettings

usual = DiagnosisSettings()
stricter = usual._replace(decision=usual.decision._replace(explained=0.06))
diagnosis = seatsim.diagnose("recording_folder", settings=stricter)
```
"""


def show(value: object) -> str:
    """Return a value as a table shows it: numbers short, several of them in a row."""
    if isinstance(value, tuple):
        return ", ".join(show(each) for each in value)
    return f"{value:g}" if isinstance(value, float) else str(value)


def tables() -> Iterator[str]:
    """Yield a section for each group of settings."""
    for group, settings in DiagnosisSettings()._asdict().items():
        cls: type[Settings] = type(settings)
        yield f"\n## `{group}`\n\n{inspect.getdoc(cls)}\n"
        yield "| name | value | unit | meaning | what it trades off | chosen |\n|---|---|---|---|---|---|"
        for name, threshold in list_thresholds(cls):
            chosen = LETTERS.get(threshold.chosen, threshold.chosen)
            cells = [f"`{name}`", show(getattr(settings, name)), *threshold[:3], chosen]
            yield f"| {' | '.join(cell.replace('|', BAR) for cell in cells)} |"


def pages() -> dict[str, str]:
    """Return the text of the page by its file."""
    return {PAGE.name: HEAD + "\n".join(tables()) + "\n"}


if __name__ == "__main__":
    PAGE.write_text(pages()[PAGE.name], encoding="utf-8")
