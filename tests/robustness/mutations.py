"""Random changes of valid files: bytes, words, packed content; each by a generator of its own."""

from __future__ import annotations

import gzip
import io
import random
import re
import zipfile
import zlib

from seatsim.schema.tables import UNPACKING_ERRORS

AWKWARD = r"""~ true -1 0 1e400 -.inf .nan 1e-320 0x1 ''' "\0" [] {} !!bool !!python/name:os.system !own &a *a <<
    é ../../escaped /etc/passwd /dev/zero nowhere.csv :X os:system evil.py:X | > --- ... # @ ` 1_0 1,5 " ' nan inf x
    2024-05-01 12:30""".split()  # noqa: SIM905 - so that quotation marks and backslashes stand as they are
WORDS = (*AWKWARD, "", "\t", "\r", "\x00", "\ufeff", "9" * 5000, "[" * 50, "{a: " * 40, "a" * 70_000, "&a [*a]")
"""What a word of a text is replaced by."""
NUMBERS = (0, 1, 2, 255, 2**15, 2**16 - 1, 2**24, 2**31 - 1, 2**32 - 1, 2**40, 2**63)
"""What a size, a dimension or an address is replaced by."""


def mutate(content: bytes, generator: random.Random) -> bytes:
    """Return content with one change, which may lie within what is packed."""
    if generator.random() < 0.5:
        try:
            if content.startswith(b"\x1f\x8b"):
                return gzip.compress(mutate(gzip.decompress(content), generator), 1)
            if content.startswith(b"PK\x03\x04"):
                return _change_member(content, generator)
        except (*UNPACKING_ERRORS, RuntimeError, OSError, EOFError, zlib.error):  # an earlier change has damaged it
            return _damage(content, generator)
    try:
        text = content.decode()
    except UnicodeDecodeError:
        return generator.choice((_damage, _lie))(content, generator)
    return _damage(content, generator) if generator.random() < 0.3 else _replace_word(text, generator).encode()


def _replace_word(text: str, generator: random.Random) -> str:
    """Replace a word, or a cell of a table, by an awkward one or another of the text; the first lines hold names."""
    end = len(text) if generator.random() < 0.5 else min(len(text), 400)
    words = list(re.finditer(r"[^\s,\[\]{}:]+", text[: min(end, 100_000)]))
    if not words:
        return text + generator.choice(WORDS)
    chosen = generator.choice(words)
    return text[: chosen.start()] + generator.choice((*WORDS, generator.choice(words)[0])) + text[chosen.end() :]


def _change_member(content: bytes, generator: random.Random) -> bytes:
    """Change a file within a ZIP."""
    changed = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(content)) as old, zipfile.ZipFile(changed, "w", zipfile.ZIP_DEFLATED) as new:
        chosen = generator.choice(["", *old.namelist()])
        for name in old.namelist():
            new.writestr(name, mutate(old.read(name), generator) if name == chosen else old.read(name))
    return changed.getvalue()


def _lie(content: bytes, generator: random.Random) -> bytes:
    """Replace a whole number by an awkward one, or by another of the file: a size, a dimension, an address."""
    size = generator.choice((1, 2, 4, 8))
    # Most of a file is numbers that were measured; what describes them lies at its ends, in whole words.
    reach = generator.choice((64, 1024, 16384, len(content)))
    at = generator.randrange(max(1, min(reach, len(content))))
    at = size * ((len(content) - at if generator.random() < 0.3 else at) // size)
    other = size * (generator.randrange(len(content) + 1) // size)
    number: int = generator.choice((*NUMBERS, other))
    new = (number % (1 << 8 * size)).to_bytes(size, generator.choice(("little", "little", "big")))
    new = content[other : other + size] if generator.random() < 0.3 else new
    return content[:at] + new + content[at + len(new) :]


def _damage(content: bytes, generator: random.Random) -> bytes:
    """Flip, cut out, double or put in bytes."""
    at, size = generator.randrange(len(content) + 1), generator.choice((1, 1, 2, 8, 64, 1000))
    middle = generator.choice((b"", content[at : at + size] * 2, generator.randbytes(size)))
    return content[:at] + (middle + content[at + size :] if generator.random() < 0.75 else b"")
