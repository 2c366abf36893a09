"""Write `reference.md`: every name that can stand in a scenario, as `seatsim describe` tells it."""

from __future__ import annotations

from pathlib import Path

from seatsim import registry
from seatsim.describe import KINDS, SECTIONS, describe

PAGE = Path(__file__).with_name("reference.md")
HEAD = """# Everything that has a name

What `seatsim describe NAME` prints, for every name. Built by `python docs/build_reference.py`.
"""


def page() -> str:
    """Return the text of the page."""
    parts = [HEAD]
    for kind, names in {**{kind: registry.names(kind) for kind in KINDS}, "section": list(SECTIONS)}.items():
        parts.append(f"## {kind.capitalize()}s\n")
        parts += [f"### {name}\n\n```text\n{describe(name)}\n```\n" for name in names]
    return "\n".join(parts)


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
