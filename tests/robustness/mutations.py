"""Random changes of valid files: bytes, words, cells, lines, packed content; each by a generator of its own."""

from __future__ import annotations

import gzip
import io
import random
import re
import zipfile
import zlib

from seatsim.schema.tables import UNPACKING_ERRORS

WORDS = (
    "~", "true", "-1", "0", "1e400", "-.inf", ".nan", "1e-320", "9" * 5000, "0x" + "f" * 300, "'" * 3, '"\\0"', "[]",
    "{}", "!!bool x", "!!python/name:os.system", "!own {a: 1}", "&a [*a]", "*a", "<<", "[" * 50, "{a: " * 40,
    "a" * 70_000, "é", "../../escaped", "/etc/passwd", "/dev/zero", "nowhere.csv", ":X", "os:system", "evil.py:X",
    "{1: 2, [a]: 3}", "- - -", "? x", "|", ">", "%YAML 1.1", "---", "...", "#", "@", "`", "\t", "\x00", "\ufeff",
    "1_0", "1,5", "2024-05-01", "12:30",
)  # fmt: skip
"""What a word of a YAML file is replaced by."""
CELLS = ("", "nan", "inf", "-1e400", "x", "1,5", '"', "'", "1 2", "\x00", "9" * 400, "é", "#", ",", ",,", "\r", "0x1")
"""What a cell of a table is replaced by."""


def mutate(content: bytes, generator: random.Random) -> bytes:
    """Return content with one change."""
    if content.startswith(b"\x1f\x8b"):
        if generator.random() < 0.5:
            return _damage(content, generator)
        try:
            return gzip.compress(mutate(gzip.decompress(content), generator), 1)
        except (OSError, EOFError, zlib.error):  # an earlier change has damaged it
            return _damage(content, generator)
    if content.startswith(b"PK\x03\x04") and generator.random() < 0.5:
        return _change_member(content, generator)
    try:
        text = content.decode()
    except UnicodeDecodeError:
        return generator.choice((_damage, _lie))(content, generator)
    choices = (_replace_word, _replace_word, _change_lines, _damage_text)
    return generator.choice(choices)(text, generator).encode("utf-8", "surrogateescape")


def _replace_word(text: str, generator: random.Random) -> str:
    """Replace a word, or a cell of a table, by an awkward one."""
    is_table = text[:400].count(",") > 8 and ":" not in text[:400]
    # Most of a table is rows; its first lines hold the names.
    end = len(text) if not is_table or generator.random() < 0.5 else min(len(text), 400)
    words = list(re.finditer(r"[^\s,\[\]{}:]+", text[:end])) if end < 100_000 else []
    if not words:
        return text + generator.choice(CELLS)
    chosen = generator.choice(words)
    new = generator.choice(CELLS if is_table else (*WORDS, generator.choice(words)[0]))
    return text[: chosen.start()] + new + text[chosen.end() :]


def _change_lines(text: str, generator: random.Random) -> str:
    """Drop, double, exchange or indent lines."""
    lines = text.splitlines(keepends=True)
    if len(lines) < 2:
        return text * 2
    first, second = generator.randrange(len(lines)), generator.randrange(len(lines))
    how = generator.randrange(4)
    if how == 0:
        del lines[first]
    elif how == 1:
        lines.insert(second, lines[first])
    elif how == 2:
        lines[first], lines[second] = lines[second], lines[first]
    else:
        lines[first] = "  " + lines[first]
    return "".join(lines)


def _damage_text(text: str, generator: random.Random) -> str:
    return _damage(text.encode(), generator).decode("utf-8", "surrogateescape")


def _change_member(content: bytes, generator: random.Random) -> bytes:
    """Change a file within a ZIP."""
    changed = io.BytesIO()
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as old, zipfile.ZipFile(changed, "w", zipfile.ZIP_DEFLATED) as new:
            chosen = generator.choice(["", *old.namelist()])
            for name in old.namelist():
                new.writestr(name, mutate(old.read(name), generator) if name == chosen else old.read(name))
    except (*UNPACKING_ERRORS, RuntimeError):  # an earlier change has damaged it
        return _damage(content, generator)
    return changed.getvalue()


def _lie(content: bytes, generator: random.Random) -> bytes:
    """Replace a whole number by an awkward one, or by another of the file: a size, a dimension, an address."""
    size = generator.choice((1, 2, 4, 8))
    # Most of a file is numbers that were measured; what describes them lies at its ends, in whole words.
    reach = generator.choice((64, 1024, 16384, len(content)))
    at = generator.randrange(max(1, min(reach, len(content))))
    at = size * ((len(content) - at if generator.random() < 0.3 else at) // size)
    other = size * (generator.randrange(len(content) + 1) // size)
    number: int = generator.choice((0, 1, 2, 255, 2**15, 2**16 - 1, 2**24, 2**31 - 1, 2**32 - 1, 2**40, 2**63, other))
    new = (number % (1 << 8 * size)).to_bytes(size, generator.choice(("little", "little", "big")))
    if generator.random() < 0.3:
        new = content[other : other + size]
    return content[:at] + new + content[at + len(new) :]


def _damage(content: bytes, generator: random.Random) -> bytes:
    """Flip, cut out, double or put in bytes."""
    at = generator.randrange(len(content) + 1)
    size = generator.choice((1, 1, 2, 8, 64, 1000))
    how = generator.randrange(4)
    if how == 0:
        return content[:at] + content[at + size :]
    if how == 1:
        return content[:at] + content[at : at + size] * generator.choice((2, 3)) + content[at + size :]
    if how == 2:
        return content[:at]
    return content[:at] + generator.randbytes(generator.choice((1, 2, 8))) + content[at + size :]
