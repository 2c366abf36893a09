"""Which reader a file needs, chosen by its first bytes and else by its ending, and one error where it fails."""

import io
import re
import zipfile
from collections import Counter
from collections.abc import Iterable
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import NamedTuple

import numpy as np

from seatsim.importing.signals import DataFile, Group, Signal
from seatsim.schema.bounds import TooMuchError, check_made
from seatsim.schema.errors import InputError
from seatsim.schema.fields import read_packaged
from seatsim.schema.guarded import is_there, nearest_beside, read_bytes
from seatsim.schema.tables import LARGEST_FILE, UNPACKING_ERRORS, unpack
from seatsim.schema.text import make_printable

_LONGEST_REASON = 200
"""Letters of what a library says that an error repeats."""
_SNIFFED = 4096
"""Bytes from which a format is recognised."""
USER_BLOCK, HDF5 = 512, b"\x89HDF\r\n\x1a\n"
"""Bytes that may stand before an HDF5 file, and how it begins."""
_LEAST_ROWS = 2
_LOWEST_RATE, _HIGHEST_RATE, _LATEST_START = 1e-6, 1e9, 1e10
"""Rates in Hz and starts in s, 300 years apart, beyond which a file is damaged."""
_LARGEST_NUMBER = 1e100
"""What is larger, or infinite, was never measured and counts as a row without a number: its square overflows."""


class TextLayout(NamedTuple):
    """What `map.yaml` states of a text table; None leaves it to be found.

    `header` counts the lines above the first row of numbers.
    """

    delimiter: str | None = None
    decimal: str | None = None
    header: int | None = None
    encoding: str | None = None


class _Format(NamedTuple):
    """A format: the function that reads it, with its module, a pattern of how its files begin, and how they may end."""

    name: str
    reader: str
    begins: str | None = None
    endings: tuple[str, ...] = ()


_FORMATS = read_packaged(Path(__file__).with_name("formats.yaml"), tuple[_Format, ...])
"""Formats in the order in which they are tried."""
_KNOWN = ", ".join(each.name for each in _FORMATS)
_OLD_EXCEL = b"\xd0\xcf\x11\xe0"
_MARKUP = {
    re.compile(rb"\s*[{\[]\s*(?:[\[{\"}\]]|-?\d)"): "a JSON file",
    re.compile(rb"\s*<(?:\?xml|!doctype|html|[a-z]+[ >])", re.IGNORECASE): "an XML or HTML file",
}
"""How texts begin that are no tables."""
_ZIP = b"PK\x03\x04"


def read_file(path: Path, layout: TextLayout | None = None) -> DataFile:
    """Return the channels of a file.

    Raises:
        InputError: there is no such file, its format is none of those known, its library is not installed, or it is
            empty, truncated or damaged.
    """
    content = _content(path)
    found = _recognise(path, content)
    module, _, function = found.reader.partition(".")
    read = getattr(import_module(f"seatsim.importing.readers.{module}"), function)
    try:
        file: DataFile = read(path, content, layout or TextLayout())
    except InputError:
        raise
    except TooMuchError as error:
        raise InputError(f"{path}: {error}") from error
    except RecursionError as error:
        raise InputError(f"{path}: its parts lie too deep in each other, or hold themselves") from error
    except Exception as error:  # libraries raise whatever a damaged file makes them stumble over
        reason = str(error).strip().split("\n")[0][:_LONGEST_REASON] or type(error).__name__
        problem = f"cannot be read as {found.name} ({reason}); it is truncated, damaged, or of a kind that is not read"
        raise InputError(f"{path}: {problem}") from error
    return _checked(file._replace(format=found.name))


def need(module: str, kind: str) -> ModuleType:
    """Return an imported library of the extra `formats`.

    Raises:
        InputError: it is not installed; the sentence names the command that installs it.
    """
    try:
        return import_module(module)
    except ImportError as error:
        problem = f'{kind} is read by {module.partition(".")[0]}; install it with: pip install "seatsim[formats]"'
        raise InputError(problem) from error


def _content(path: Path) -> bytes:
    """Return the bytes of a file, unpacked where it is packed."""
    if not is_there(path):
        raise InputError(f"{path}: cannot be read: no such file{nearest_beside(path)}")
    content = read_bytes(path, LARGEST_FILE, "a file of measured data")
    # An XLSX is a _ZIP itself, and its reader unpacks it.
    if not content.startswith(_ZIP):
        content = unpack(content, path)
    if not content.strip(b"\0 \r\n\t"):
        raise InputError(f"{path}: is empty; export it again")
    return content


def _recognise(path: Path, content: bytes) -> _Format:
    head, names = content[:_SNIFFED], {each.name: each for each in _FORMATS}
    if head.startswith(_OLD_EXCEL):
        raise InputError(f"{path}: is an Excel file of the old kind (.xls): save it as .xlsx; permitted: {_KNOWN}")
    for pattern, what in _MARKUP.items():
        if pattern.match(head.removeprefix(b"\xef\xbb\xbf")):
            raise InputError(f"{path}: is {what}; export its channels as a table; permitted: {_KNOWN}")
    if head.startswith(_ZIP):
        _check_unpacked(path, content)
        return names["XLSX"]
    if head[USER_BLOCK:].startswith(HDF5):
        return names["MAT v7.3" if head.startswith(b"MATLAB") else "HDF5"]
    for each in _FORMATS:
        if each.begins is not None and re.match(each.begins, head.decode("latin-1")):
            return each
    ending = next((each for each in _FORMATS if path.name.lower().endswith(each.endings)), None)
    if ending is not None and ending.name != "CSV":
        version = ", of version 4 (save it by -v7)" if ending.name == "MAT v5" else ""
        raise InputError(f"{path}: does not begin as {ending.name} does; it is damaged{version}, or has a wrong ending")
    if not _is_text(head):
        raise InputError(f"{path}: is no table in a known format; permitted: {_KNOWN}")
    return names["CSV"]


def _check_unpacked(path: Path, content: bytes) -> None:
    """Raise InputError where the parts of a ZIP are too large together, before any is unpacked."""
    try:
        parts = zipfile.ZipFile(io.BytesIO(content)).infolist()
    except UNPACKING_ERRORS as error:
        raise InputError(f"{path}: cannot be unpacked ({error}); it is truncated or damaged: copy it again") from error
    try:
        check_made(sum(each.file_size for each in parts), len(content), "what it unpacks to")
    except TooMuchError as error:
        raise InputError(f"{path}: {error}") from error


def _is_text(head: bytes) -> bool:
    """Say whether bytes are text: without control characters, or UTF-16, whose every other byte is 0 in a table."""
    if head.startswith((b"\xff\xfe", b"\xfe\xff")) or not (any(head[::2]) and any(head[1::2])):
        return True
    return not any(byte < 9 or 13 < byte < 32 for byte in head)


def _checked(file: DataFile) -> DataFile:
    """Return a file whose groups have rows, a rate and a start that may be, and distinct names."""
    groups = tuple(group for group in file.groups if group.signals and group.rows >= _LEAST_ROWS)
    if not groups:
        said = "".join(f"; {note}" for note in file.notes)
        raise InputError(f"{file.path}: holds no channel with at least {_LEAST_ROWS} rows of numbers{said}")
    for group in groups:
        if group.rate is not None and not _LOWEST_RATE <= group.rate <= _HIGHEST_RATE:
            raise InputError(f"{file.path}: states a sample rate of {group.rate:g} Hz, which no logger has; correct it")
        if group.start is not None and not abs(group.start) <= _LATEST_START:
            raise InputError(f"{file.path}: states that channels begin at {group.start:g} s; correct that")
    names = _name_once(group.name for group in groups)
    return file._replace(groups=tuple(_check_group(group, name) for group, name in zip(groups, names, strict=True)))


def _check_group(group: Group, title: str) -> Group:
    """Return a group whose channels hold finite numbers and have distinct names that can be printed."""
    names = _name_once(re.sub(r"\s", " ", signal.name) for signal in group.signals)
    signals = []
    for name, signal in zip(names, group.signals, strict=True):
        values = np.asarray(signal.values, dtype=np.float64)
        values = np.where(np.abs(values) <= _LARGEST_NUMBER, values, np.nan)
        signals.append(Signal(name, make_printable(signal.unit), values))
    return group._replace(name=title, signals=tuple(signals))


def _name_once(names: Iterable[str]) -> list[str]:
    """Return names that can be printed; a second `force` is `force#2`."""
    seen: Counter[str] = Counter()
    found = []
    for name in map(make_printable, names):
        seen[name] += 1
        found.append(f"{name}#{seen[name]}" if seen[name] > 1 else name)
    return found
