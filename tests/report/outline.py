"""What a page says, for tests: its headings, texts, anchors, references and tables."""

from html.parser import HTMLParser
from urllib.parse import unquote
from xml.etree import ElementTree

VOID = ("img", "meta", "br", "input", "link")


class Outline(HTMLParser):
    """Text, headings, anchors and references of a page; every element has to be closed in its turn."""

    def __init__(self, text):
        super().__init__()
        self.open, self.anchors, self.references, self.headings, self.words = [], [], [], [], []
        self.captions, self.tables = [], []
        self.feed(text)
        assert not self.open

    def handle_starttag(self, tag, attrs):
        given = dict(attrs)
        if tag not in VOID:
            self.open.append(tag)
        if tag == "section":
            self.anchors.append(given["id"])
        if tag == "table":
            self.tables.append([])
            self.captions.append("")
        if tag == "tr":
            self.tables[-1].append([])
        if tag in ("th", "td"):
            self.tables[-1][-1].append("")
        if tag == "img":
            drawing = ElementTree.fromstring(unquote(given["src"].removeprefix("data:image/svg+xml,")))
            self.words += [each.text for each in drawing.iter("{http://www.w3.org/2000/svg}text") if each.text]
        self.references += [given[key] for key in ("src", "href") if key in given]
        assert tag not in ("link", "iframe") and not any(key.startswith("on") for key in given)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        inside = self.open[-1] if self.open else ""
        if inside in ("h1", "h2", "h3"):
            self.headings.append(data)
        if inside in ("th", "td"):
            self.tables[-1][-1][-1] += data
        if inside == "caption":
            self.captions[-1] += data
        if inside not in ("style", "script"):
            self.words.append(data)

    def rows(self, caption):
        """Return the cells of the table whose caption begins so, by the first cell of each row."""
        index = next(k for k, text in enumerate(self.captions) if text.startswith(caption))
        return {row[0]: row[1:] for row in self.tables[index]}
