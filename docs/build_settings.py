"""Write `settings.md`: every threshold of a diagnosis, as `seatsim.diagnosis.settings` states it."""

from __future__ import annotations

import ast
import inspect
import itertools
import re
from collections.abc import Iterator
from pathlib import Path

from seatsim.diagnosis.settings import DiagnosisSettings

PAGE = Path(__file__).with_name("settings.md")
HEAD = """# Settings of a diagnosis

Every threshold on which a [diagnosis](diagnosis_theory.md) rests. What is lost where it is raised or lowered, and how
it was chosen, stands beside it in `seatsim/diagnosis/settings`. Built by `python docs/build_settings.py`. Another value
is asked for in Python:

<!-- not run -->
```python
import seatsim
from seatsim.diagnosis.settings import DiagnosisSettings

usual = DiagnosisSettings()
stricter = usual._replace(decision=usual.decision._replace(explained=0.06))
diagnosis = seatsim.diagnose("recording_folder", settings=stricter)
```
"""


def show(value: object) -> str:
    """Return a value as the page shows it: numbers short, several of them in a row."""
    if isinstance(value, tuple):
        return ", ".join(show(each) for each in value)
    return f"{value:g}" if isinstance(value, float) else str(value)


def stated(cls: type) -> dict[str, list[str]]:
    """Return unit and meaning of each field of a group of settings, whose docstring also has trade-off and origin."""
    _, *body = ast.parse(inspect.getsource(cls)).body[0].body  # type: ignore[attr-defined]
    found = {}
    for field, text in itertools.pairwise(body):
        if isinstance(field, ast.AnnAssign) and isinstance(text, ast.Expr):
            said = " ".join(ast.literal_eval(text.value).split())
            parts = re.fullmatch(r"(.+?)(?: \[(.+?)\])?\.(?: Trades off: (.+)\.)? Chosen: (.+)\.", said)
            assert parts, f"{cls.__name__}: {said}"
            meaning, unit, *_ = parts.groups(default="")
            found[ast.unparse(field.target)] = [unit, meaning]
    return found


def tables() -> Iterator[str]:
    """Yield a section for each group of settings."""
    for group, settings in DiagnosisSettings()._asdict().items():
        cls = type(settings)
        yield f"\n## `{group}`\n\n{inspect.getdoc(cls)}\n"
        for name, (unit, meaning) in stated(cls).items():
            yield f"- `{name}` = {show(getattr(settings, name))}{unit and f' {unit}'}: {meaning}"


def pages() -> dict[str, str]:
    """Return the text of the page by its file."""
    return {PAGE.name: HEAD + "\n".join(tables()) + "\n"}


if __name__ == "__main__":
    PAGE.write_text(pages()[PAGE.name], encoding="utf-8")
