"""What a page says, for tests: its tree of elements, and of that headings, texts, anchors, references and tables."""

from html.parser import HTMLParser
from urllib.parse import unquote
from xml.etree import ElementTree

VOID = ("img", "meta", "br", "input", "link")


class Parser(HTMLParser):
    """Makes a tree of a page; every element has to be closed in its turn."""

    def __init__(self, text):
        super().__init__()
        self.builder = ElementTree.TreeBuilder()
        self.feed(text)
        self.root = self.builder.close()

    def handle_starttag(self, tag, attrs):
        assert tag not in ("link", "iframe") and not any(key.startswith("on") for key, _ in attrs)
        self.builder.start(tag, {key: value or "" for key, value in attrs})
        if tag in VOID:
            self.builder.end(tag)

    def handle_endtag(self, tag):
        assert self.builder.end(tag).tag == tag

    def handle_data(self, data):
        self.builder.data(data)


def text_of(element):
    return "".join(element.itertext())


class Outline:
    """Text, headings, anchors and references of a page."""

    def __init__(self, text):
        elements = list(Parser(text).root.iter())
        self.anchors = [each.get("id") for each in elements if each.tag == "section"]
        self.headings = [text_of(each) for each in elements if each.tag in ("h1", "h2", "h3")]
        self.references = [each.get(key) for each in elements for key in ("src", "href") if each.get(key)]
        self.tables = [each for each in elements if each.tag == "table"]
        pieces = [each.tail for each in elements]
        pieces += [each.text for each in elements if each.tag not in ("style", "script")]
        for image in (each for each in elements if each.tag == "img"):
            drawing = ElementTree.fromstring(unquote(image.get("src").removeprefix("data:image/svg+xml,")))
            pieces += [each.text for each in drawing.iter("{http://www.w3.org/2000/svg}text")]
        self.words = list(filter(None, pieces))

    def rows(self, caption):
        """Return the cells of the table whose caption begins so, by the first cell of each row."""
        table = next(each for each in self.tables if text_of(each.find("caption")).startswith(caption))
        cells = ([text_of(cell) for cell in row] for row in table.iter("tr"))
        return {first: rest for first, *rest in cells}
