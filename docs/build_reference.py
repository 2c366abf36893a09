"""Write `reference.md`, the pages under `reference` and the pictures of the dampers, from the code.

The pages have every name that can stand in a scenario.
"""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Iterator, Mapping, Set
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

DAMPERS = """
The pictures show the force in a sine test with the default parameters, at no current, half and the whole current of the
model's range. Defaults of UTFSM are fitted to measured sine tests, steady cycles of 2-25 mm and 0.5-5 Hz at 0-1 A with
the offset removed, of the damper in the public repository DanielMaurelE/vRTHS_AMBC_MRdamper (MIT). The word in brackets
says how far a model's equation is that of its source:
"""
SHOWN = "\nPictures, defaults of UTFSM, and how well each equation is known: [dampers](../reference.md#dampers).\n"
ONCE = (
    (r"; defaults fitted by us to measured sine tests of the damper of UTFSM \(Chile, [^)]*\)", ""),
    (r"derived by us \(see\s+`pieces.UTFSM`\)", "of UTFSM"),
    (r"derived by us from measurement, steady cycles of 2-25 mm and 0.5-5 Hz at 0-1 A, offset\s+removed", "UTFSM"),
    (r"\s*Valid\s+to [\d.]+ m/s(\s+and\s+[\d.]+\s+A)?\.", ""),
)
"""What the texts of many dampers say alike, and what a page says of it: `DAMPERS`, and each range of the data."""
RANGE = "Range of the data"
SEVERAL = 4
"""Number of entries of a page from which a parameter or range that they have alike is stated once, at its head."""


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
    """Return the section of a kind: the links to its names, those of dampers by family and with their confidence."""
    lines = [f"\n## {kind.capitalize()}s\n"]
    if kind != "damper":
        return "\n".join([*lines, *(", ".join(map(chapter.link, chapter.names)) for chapter in chapters)]) + "\n"
    lines += [DAMPERS.lstrip(), *(f"- {word}: {meaning}" for word, meaning in CONFIDENCE.items())]
    for chapter in chapters:
        known = [f"{chapter.link(name)} ({find_confidence(registry.find(kind, name))})" for name in chapter.names]
        lines += [f"\n### {chapter.title}\n", ", ".join(known)]
    return "\n".join(lines) + "\n"


def write_chapter(chapter: Chapter) -> str:
    """Return the text of one page; what several names have alike, parameters and a range, is stated before them."""
    entries = [find_page(name) for name in chapter.names]
    counted = Counter(line for page in entries for line in list_parameters(page).values())
    common = {line for line, count in counted.items() if count >= SEVERAL}
    ranges = Counter(fact for page in entries for fact in page.facts if fact.startswith(RANGE))
    usual = {fact for fact, count in ranges.most_common(1) if count >= SEVERAL}
    head = f"# {chapter.title}\n" + SHOWN * chapter.file.startswith("reference/dampers")
    if common:
        head += "\n" + "\n".join(["Parameters of several of them, which there stand by name:\n", *sorted(common), ""])
    head += "".join(f"\n{shorten(fact)}, where none is stated.\n" for fact in usual)
    return head + "".join(write_entry(page, common, usual) for page in entries)


def write_entry(page: Page, common: Set[str], usual: Set[str]) -> str:
    """Return the section of one name: words and equations, parameters, source, and facts that are not the usual."""
    parts = [f"\n## {page.name}\n", *write_text(page)]
    if page.kind == "damper":
        parts.append(f"![loops of {page.name}](../{LOOPS}/{page.name}.svg)\n")
    parameters = list_parameters(page)
    parts += [line for line in parameters.values() if line not in common] or ["No parameters.\n"] * (not parameters)
    if shared := [f"`{name}`" for name, line in parameters.items() if line in common]:
        parts.append(f"- {', '.join(shared)}")
    facts = [f"Source: {say_once(page.source)}"] * bool(page.source)
    # The index states the confidence of all, for comparison.
    facts += [shorten(fact) for fact in page.facts if fact not in usual and not fact.startswith("Confidence")]
    parts += ["", f"{'. '.join(map(escape, facts))}."] * bool(facts)
    return "\n".join([*parts, ""])


def say_once(text: str) -> str:
    """Return a text without what the pages say once for all dampers."""
    for said, instead in ONCE:
        text = re.sub(said, instead, text)
    return text


def shorten(fact: str) -> str:
    """Return a fact in fewer words: ranges by dots, a range of one value by this value."""
    if not fact.startswith(RANGE):
        return fact
    return re.sub(r"\b(\d+)\.\.\1\b", r"\1", re.sub(r"(?<=\d) to (?=-?\d)", "..", fact))


def write_text(page: Page) -> Iterator[str]:
    """Yield the paragraphs of a docstring; those that are indented are equations of a damper, or stay as they are."""
    for paragraph in say_once(page.text).split("\n\n"):
        if not paragraph.startswith("    "):
            yield escape(paragraph) + "\n"
        elif page.kind == "damper":
            yield f"```math\n{convert_equations(paragraph)}\n```\n"
        else:
            yield f"```text\n{paragraph}\n```\n"


def list_parameters(page: Page) -> dict[str, str]:
    """Return a line on each parameter: its name with its unit and default, what is permitted, and its meaning."""
    cls = RECORDS[page.name] if page.kind == "section" else registry.find(page.kind, page.name)
    return {key.name: write_parameter(cls, key) for key in page.keys}


def write_parameter(cls: type, key: FieldSpecification) -> str:
    """Return a line such as `- gap [m] = 0.01 (0..0.02): travel without force after a reversal`."""
    unit = f" [{key.unit}]" * (key.unit not in {"", "-"})
    default = show(key.default)
    if not key.required:
        value = f" = {default}" * bool(default)
    else:
        value = ", required" + f", a fit starts from {default}" * (key.default is not None)
    permitted = show_range(cls, key)
    said = escape(f" ({permitted})" * bool(permitted) + f": {key.meaning}" * bool(key.meaning))
    return f"- `{key.name}`{unit}{value}{said}"


def show(value: object) -> str:
    """Return a default as a page shows it."""
    if isinstance(value, float):
        return f"{value:g}"
    if isinstance(value, tuple):
        return ", ".join(map(show, value))
    return f"{len(value)} keys" if isinstance(value, Mapping) else str(value)


def show_range(cls: type, key: FieldSpecification) -> str:
    """Return what is permitted: words that the meaning does not state, or the bounds of a number; else nothing."""
    words = choices(cls, key.name)
    if words and all(isinstance(word, str) for word in words):
        return ", ".join(words) * any(word not in key.meaning for word in words)
    low, high = bounds(cls, key.name)
    if math.isinf(low):
        return "" if math.isinf(high) else f"<= {high:g}"
    open_below = low - round(low, 8) == SLIGHTLY
    least = f"> {round(low, 8):g}" if open_below else f">= {low:g}"
    if math.isinf(high):
        return least
    return f"{least}, <= {high:g}" if open_below else f"{low:g}..{high:g}"


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
