"""What a screen reader, a keyboard and weak eyes need of every kind of report, as axe-core asks for it."""

import re
from itertools import pairwise

import pytest

from seatsim.report.rendering import STYLES, read_asset

from .kinds import KINDS, render
from .outline import Parser, text_of

NAMED = ("a", "button", "summary", "caption", "h1", "h2", "h3", "th", "legend")
"""Elements that are nothing without a text."""


@pytest.fixture(scope="module", params=KINDS)
def page(request):
    text = render(request.param)
    return text, Parser(text).root


def words(element):
    return " ".join(text_of(element).split())


def test_a_report_can_be_heard_and_used_without_a_mouse(page):
    text, root = page
    assert len(text.encode()) < 700_000 and root.get("lang") == "en" and words(root.find("head/title"))
    assert "user-scalable" not in text and len(root.findall(".//main")) == 1
    levels = [int(each.tag[1]) for each in root.iter() if re.fullmatch("h[1-6]", each.tag)]
    assert levels[0] == 1 and levels.count(1) == 1
    assert all(below - above <= 1 for above, below in pairwise(levels))
    identities = [each.get("id") for each in root.iter() if each.get("id")]
    assert len(identities) == len(set(identities))
    for each in root.iter():
        assert each.tag not in NAMED or words(each) or each.get("aria-label"), each.attrib
        assert each.tag != "img" or each.get("alt").strip(" .")
        assert each.tag != "svg" or each.get("aria-hidden") == "true" or each.get("aria-label")
        assert each.tag != "th" or each.get("scope") in ("col", "row")
        assert each.tag != "a" or each.get("href").removeprefix("#") in identities
        assert each.get("role") not in ("region", "img", "group") or each.get("aria-label")
        assert "scroll" not in each.get("class", "") or each.get("tabindex") == "0"
        assert each.get("aria-labelledby") is None or each.get("aria-labelledby") in identities
    labelled = {id(control) for label in root.iter("label") for control in label.iter()}
    controls = [each for each in root.iter() if each.tag in ("input", "select", "textarea")]
    assert all(id(each) in labelled or each.get("aria-label") for each in controls)
    landmarks = [(each.tag, each.get("aria-label")) for each in root.iter()
                 if each.get("role") == "region" or each.tag in ("nav", "form")]  # fmt: skip
    assert len(landmarks) == len(set(landmarks)), landmarks


def luminance(colour):
    code = colour * 2 if len(colour) == 3 else colour
    parts = [int(code[k : k + 2], 16) / 255 for k in (0, 2, 4)]
    linear = [part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(one, other):
    low, high = sorted((luminance(one), luminance(other)))
    return (high + 0.05) / (low + 0.05)


@pytest.mark.parametrize("scheme", ["light", "dark", "print"])
def test_every_text_stands_out_from_its_paper(scheme):
    style = read_asset(STYLES)
    blocks = re.findall(r"(@media [^{]*)?\{? ?:root \{([^}]*)\}", style)
    names = {"light": "", "dark": "dark", "print": "print"}
    colours = {}
    for media, content in blocks:
        if not media or (names[scheme] and names[scheme] in media):
            colours |= dict(re.findall(r"--(\w+): #([0-9a-f]{3,6})\b", content))
    for ink in ("ink", "soft", "link", "alarm"):
        for paper in ("paper", "shade"):
            assert contrast(colours[ink], colours[paper]) >= 4.5, (ink, paper)
    badges = re.findall(r"\.badge[^{]*\{[^}]*background: #([0-9a-f]{3,6})", style)
    assert len(badges) == 5 and all(contrast("fff", each) >= 4.5 for each in badges)
