"""Write `reference.md`, the pages under `reference` and the pictures of the dampers, from the code.

The pages have every name that can stand in a scenario.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import NamedTuple

from equations import convert_equations
from loops import draw_loops

from seatsim.dampers.base import CONFIDENCE, find_confidence
from seatsim.scenario.describe import KINDS, Page, find_page
from seatsim.scenario.sections import RECORDS
from seatsim.schema import registry
from seatsim.schema.fields import SLIGHTLY, FieldSpecification, bounds, choices

FOLDER = Path(__file__).parent
LOOPS = "images/loops"
"""Folder of the pictures of the dampers."""
HEAD = """# Models, laws, floors and effects

Every name that can stand in a scenario; each leads to its equation, parameters, source and range, which `seatsim
describe NAME` prints in a terminal. Built from the code by `python docs/build_reference.py`. Which to take:
[Which damper, which law, which file?](choose.md)
"""

SHOWN = """
The pictures show the force in a sine test with the default parameters, at no current, half and the whole current of the
model's range. Defaults of UTFSM are fitted to measured sine tests of the damper in the public repository
DanielMaurelE/vRTHS_AMBC_MRdamper (MIT).
"""
FITTED = re.compile(r"defaults fitted by us to measured sine tests of the damper of UTFSM \(Chile, [^)]*\)")


class Chapter(NamedTuple):
    """One page of the reference: its file, its title, and the names on it."""

    file: str
    title: str
    names: list[str]

    def link(self, name: str) -> str:
        """Return the link to the section of a name."""
        return f"[{name}]({self.file}#{name.replace('.', '')})"


FAMILIES = {
    "bingham": ("Bingham and bi-viscous dampers", ("bingham", "biviscous")),
    "bouc_wen": ("Bouc-Wen dampers", ("bouc_wen", "bouc_wen_current", "bouc_wen_variants")),
    "friction": ("Dahl and LuGre dampers", ("friction",)),
    "curves": ("Dampers by a curve over velocity", ("s_curves", "sigmoid_gaussian", "yu")),
    "fluid": ("Visco-elastic and hydraulic dampers", ("fluid", "series", "viscoelastic_plastic")),
}
"""Page, title and modules of `seatsim.dampers` of each family."""


def pages() -> dict[str, str]:
    """Return the text of every page by its file."""
    chapters = {kind: list(list_chapters(kind)) for kind in (*KINDS, "section")}
    texts = {chapter.file: write_chapter(chapter) for each in chapters.values() for chapter in each}
    return {"reference.md": HEAD + "".join(write_index(kind, each) for kind, each in chapters.items()), **texts}


def list_chapters(kind: str) -> Iterator[Chapter]:
    """Yield the pages of a kind: dampers by family, of the other kinds one."""
    names = list(RECORDS) if kind == "section" else registry.names(kind)
    if kind != "damper":
        yield Chapter(f"reference/{kind}s.md", f"{kind.capitalize()}s", names)
        return
    family_of = {module: family for family, (_, modules) in FAMILIES.items() for module in modules}
    home = {name: family_of[registry.find(kind, name).__module__.rpartition(".")[2]] for name in names}
    for family, (title, _) in FAMILIES.items():
        yield Chapter(f"reference/dampers_{family}.md", title, [name for name in names if home[name] == family])


def write_index(kind: str, chapters: list[Chapter]) -> str:
    """Return the section of a kind: of dampers a table for each family, of the other kinds the links to their page."""
    lines = [f"\n## {kind.capitalize()}s\n"]
    if kind != "damper":
        return "\n".join([*lines, *(", ".join(map(chapter.link, chapter.names)) for chapter in chapters)]) + "\n"
    lines += ["Confidence says how far a model's equation is that of its source:\n"]
    lines += [f"- {word}: {meaning}" for word, meaning in CONFIDENCE.items()]
    for chapter in chapters:
        lines += [f"\n### {chapter.title}\n", "| name | is | confidence |", "|---|---|---|"]
        for name in chapter.names:
            confidence = find_confidence(registry.find(kind, name))
            lines.append(f"| {chapter.link(name)} | {cell(find_page(name).title)} | {confidence} |")
    return "\n".join(lines) + "\n"


def write_chapter(chapter: Chapter) -> str:
    """Return the text of one page."""
    head = f"# {chapter.title}\n"
    if chapter.file.startswith("reference/dampers"):
        head += SHOWN
    return head + "".join(write_entry(find_page(name)) for name in chapter.names)


def write_entry(page: Page) -> str:
    """Return the section of one name: words and equations, parameters, source and range."""
    parts = [f"\n## {page.name}\n", *write_text(page)]
    if page.kind == "damper":
        parts.append(f"![loops of {page.name}](../{LOOPS}/{page.name}.svg)\n")
    cls = RECORDS[page.name] if page.kind == "section" else registry.find(page.kind, page.name)
    parts.append("\n".join(write_parameters(cls, page.keys)) if page.keys else "No parameters.\n")
    facts = [f"Source: {FITTED.sub('defaults of UTFSM', page.source)}"] * bool(page.source) + page.facts
    return "\n".join([*parts, *(f"- {shorten(escape(fact))}" for fact in facts), ""])


def shorten(fact: str) -> str:
    """Return a fact in fewer words: a link in place of what a word for confidence means, ranges by dots."""
    fact = re.sub(r"^(Confidence: )(\w+);.*", r"\1[\2](../reference.md#dampers)", fact)
    return re.sub(r"(?<=\d) to (?=-?\d)", "..", fact) if fact.startswith("Range of the data") else fact


def write_text(page: Page) -> Iterator[str]:
    """Yield the paragraphs of a docstring; those that are indented are equations of a damper, or stay as they are."""
    for paragraph in page.text.split("\n\n"):
        if not paragraph.startswith("    "):
            yield escape(paragraph) + "\n"
        elif page.kind == "damper":
            yield f"```math\n{convert_equations(paragraph)}\n```\n"
        else:
            yield f"```text\n{paragraph}\n```\n"


def write_parameters(cls: type, keys: list[FieldSpecification]) -> Iterator[str]:
    """Yield the lines of the table of parameters."""
    yield "| parameter | unit | default (a fit's start) | range | meaning |\n|---|---|---|---|---|"
    for key in keys:
        default = show(key.default)
        if key.required:
            default = "required" if key.default is None else f"required ({default})"
        yield f"| {' | '.join([f'`{key.name}`', key.unit, default, show_range(cls, key.name), cell(key.meaning)])} |"
    yield ""


def show(value: object) -> str:
    """Return a default as a table shows it."""
    if isinstance(value, float):
        return f"{value:g}"
    if isinstance(value, tuple):
        return ", ".join(map(show, value))
    return f"{len(value)} keys" if isinstance(value, Mapping) else cell(str(value))


def show_range(cls: type, name: str) -> str:
    """Return what is permitted: words, or the bounds of a number."""
    words = choices(cls, name)
    if words and all(isinstance(word, str) for word in words):
        return ", ".join(words)
    low, high = bounds(cls, name)
    if math.isinf(low):
        return "any" if math.isinf(high) else f"<= {high:g}"
    open_below = low - round(low, 8) == SLIGHTLY
    least = f"> {round(low, 8):g}" if open_below else f">= {low:g}"
    if math.isinf(high):
        return least
    return f"{least}, <= {high:g}" if open_below else f"{low:g}..{high:g}"


def cell(text: str) -> str:
    """Return a text as a cell of a table."""
    return escape(" ".join(text.split())).replace("|", r"\|")


def escape(text: str) -> str:
    """Return a text in which no character outside a piece of code is taken for a mark of Markdown."""
    pieces = re.split(r"(`[^`]*`)", text)
    return "".join(
        piece if piece.startswith("`") else re.sub(r"([*$\[\]]|<(?=[\w/!]))", r"\\\1", piece) for piece in pieces
    )


if __name__ == "__main__":
    (FOLDER / "reference").mkdir(exist_ok=True)
    for file, text in pages().items():
        (FOLDER / file).write_text(text, encoding="utf-8")
    (FOLDER / LOOPS).mkdir(parents=True, exist_ok=True)
    for name in registry.names("damper"):
        (FOLDER / LOOPS / f"{name}.svg").write_text(draw_loops(name), encoding="utf-8")
