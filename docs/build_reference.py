"""Write `reference.md`: every name that can stand in a scenario, as `seatsim describe` tells it."""

from __future__ import annotations

from pathlib import Path

from seatsim.dampers.base import CONFIDENCE
from seatsim.scenario.describe import KINDS, SECTIONS, describe, find_page
from seatsim.schema import registry

PAGE = Path(__file__).with_name("reference.md")
HEAD = """# Everything that has a name

What `seatsim describe NAME` prints, for every name. Built by `python docs/build_reference.py`.
"""


def catalogue(names: list[str]) -> str:
    """Return the table of the damper models, with what their words of confidence mean."""
    lines = ["Confidence says how far a model's equation is that of its source:\n"]
    lines += [f"- {word}: {meaning}" for word, meaning in CONFIDENCE.items()]
    lines += ["", "| model | is | confidence | states | speed | current |", "|---|---|---|---|---|---|"]
    for name in names:
        specification = registry.specification_of(registry.find("damper", name))
        row = (
            name,
            find_page(name).title,
            specification.confidence,
            len(specification.initial),
            f"{specification.max_speed:g} m/s",
            f"{specification.max_current:g} A",
        )
        lines.append(f"| [{row[0]}](#{row[0]}) | {' | '.join(str(cell) for cell in row[1:])} |")
    return "\n".join([*lines, ""])


def page() -> str:
    """Return the text of the page."""
    parts = [HEAD]
    for kind, names in {**{kind: registry.names(kind) for kind in KINDS}, "section": list(SECTIONS)}.items():
        parts.append(f"## {kind.capitalize()}s\n")
        parts += [catalogue(names)] if kind == "damper" else []
        parts += [f"### {name}\n\n```text\n{describe(name)}\n```\n" for name in names]
    return "\n".join(parts)


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
