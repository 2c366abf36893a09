"""Tables of tests as text: a mapping or rows, written as in a scenario."""

from ruamel.yaml import YAML


def parse(text):
    """Return what a YAML text states."""
    return YAML(typ="safe", pure=True).load(text)


def words(text):
    """Return the words of a text."""
    return text.split()
