"""Tables of tests as text: a mapping or rows, written as in a scenario."""

from pathlib import Path

from ruamel.yaml import YAML


def parse(text):
    """Return what a YAML text states."""
    return YAML(typ="safe", pure=True).load(text)


def words(text):
    """Return the words of a text."""
    return text.split()


def cases(text):
    """Return what is replaced, by what, and what an error must say, of lines `old => new => said | said`.

    A line that ends with a backslash goes on in the next one; \\n within a line stands for its end.
    """
    rows = (line.split(" => ") for line in text.replace("\\\n", "").strip("\n").splitlines())
    return [(*(part.replace("\\n", "\n") for part in (old, new)), said.split(" | ")) for old, new, said in rows]


def beside(file, name):
    """Return the text of a file that lies beside a module."""
    return Path(file).with_name(name).read_text(encoding="utf-8")
