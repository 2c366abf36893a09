"""numba's cache on disk, checked: an entry that is not as it was written is discarded, and a full disk is no error.

numba unpickles what it finds, and hands the code in it to the processor: a truncated entry is a traceback, a damaged
one may end the process. Here every file begins with the SHA-256 of the rest. What an entry holds is as trustworthy as
whoever may write it, so that neither a folder nor a file is used that another user may have written.
"""

from __future__ import annotations

import hashlib
import os
import pickle
import stat
import warnings
from collections.abc import Callable
from pathlib import Path

from numba.core.caching import FunctionCache, IndexDataCacheFile

_DIGEST = hashlib.sha256().digest_size


class CheckedCache(FunctionCache):  # type: ignore[misc]  # numba has no types
    """The cache of one function."""

    def __init__(self, function: Callable[..., object]) -> None:
        super().__init__(function)
        locator = self._impl.locator
        self._cache_file = _CheckedFile(self._cache_path, self._impl.filename_base, locator.get_source_stamp())

    def save_overload(self, sig: object, data: object) -> None:
        """Keep a compiled function; where that fails it is compiled again by the next process."""
        try:
            super().save_overload(sig, data)
        except OSError as error:
            warnings.warn(f"compiled code cannot be kept in {self.cache_path}: {error.strerror}", stacklevel=2)


class _CheckedFile(IndexDataCacheFile):  # type: ignore[misc]  # numba has no types
    """The files of one function: an index of signatures, and the compiled code of each."""

    def _load_index(self) -> dict[object, str]:
        content = _read(Path(self._index_path))
        version, stamp, names = pickle.loads(content) if content else (None, None, {})
        return names if (version, stamp) == (self._version, self._source_stamp) else {}

    def _save_index(self, overloads: dict[object, str]) -> None:
        self._write(self._index_path, (self._version, self._source_stamp, overloads))

    def _load_data(self, name: str) -> object:
        content = _read(Path(self._data_path(name)))
        if content is None:
            raise FileNotFoundError(name)  # which numba takes for an entry that is not there
        return pickle.loads(content)

    def _save_data(self, name: str, data: object) -> None:
        self._write(self._data_path(name), data)

    def _write(self, path: str, value: object) -> None:
        content = self._dump(value)
        with self._open_for_write(path) as file:
            file.write(hashlib.sha256(content).digest() + content)


def _read(path: Path) -> bytes | None:
    """Return the content of an entry, None where there is none, where it is another's, or not as it was written."""
    try:
        with path.open("rb") as file:
            if not _is_own(os.fstat(file.fileno())):
                return None
            content = file.read()
    except OSError:
        return None
    if hashlib.sha256(content[_DIGEST:]).digest() == content[:_DIGEST]:
        return content[_DIGEST:]
    warnings.warn(f"{path} is damaged; it is discarded and compiled again", stacklevel=2)
    return None


def find_foreign(folder: Path) -> Path | None:
    """Return a folder, of one and those above it, in which another user may exchange files; None where there is none.

    It must belong to this user or the system, and neither its group nor all may write in it. Above the innermost one
    they may where each can remove only what is his own, as in `/tmp`.
    """
    if not hasattr(os, "getuid"):
        return None
    for innermost in (folder.absolute(), folder.resolve()):
        for level in (innermost, *innermost.parents):
            status = level.stat()
            shared = status.st_mode & (stat.S_IWGRP | stat.S_IWOTH)
            if not _is_own(status) or (shared and (level == innermost or not status.st_mode & stat.S_ISVTX)):
                return level
    return None


def _is_own(status: os.stat_result) -> bool:
    return not hasattr(os, "getuid") or status.st_uid in (os.getuid(), 0)
