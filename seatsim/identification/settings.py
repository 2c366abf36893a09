"""What is asked of an identification, and which records, and parts of them, it may see."""

from collections.abc import Mapping, Sequence
from fnmatch import fnmatch
from typing import NamedTuple

from seatsim.recordings.bench_tables import LEAST_ROWS, BenchRecord, stem
from seatsim.schema.errors import InputError, nearest


class IdentificationSettings(NamedTuple):
    """What is asked of an identification.

    test: globs of the files to hold out. test_fraction: share of each of the other records, its last part, to hold out.
    fix: numbers of the model that keep a value, by name. ignore_temperature: whether the recorded temperature is no
    input. seed: of the global search.
    """

    test: Sequence[str] = ()
    test_fraction: float = 0.0
    fix: Mapping[str, float] = {}
    ignore_temperature: bool = False
    seed: int = 0


class Split(NamedTuple):
    """Records of which the first part is fitted to, those parts, and records of which nothing is."""

    train: list[BenchRecord]
    fitted: list[BenchRecord]
    held_out: list[BenchRecord]


def split_records(records: Sequence[BenchRecord], settings: IdentificationSettings) -> Split:
    """Return which records, and which rows of them, are fitted to.

    Raises:
        InputError: a pattern matches nothing, nothing is left, or the fraction is out of bounds.
    """
    share = settings.test_fraction
    if not 0.0 <= share < 1.0:
        raise InputError(f"--test-fraction {share:g} is not permitted; it must be at least 0 and below 1, such as 0.3")
    held_out = _match_records(records, settings.test)
    train = [record for k, record in enumerate(records) if k not in held_out]
    if not train:
        raise InputError(f"--test {' '.join(settings.test)} holds out every record; leave some to fit to")
    fitted = [record.part(0, round((1.0 - share) * len(record.force))) for record in train]
    for record, part in zip(train, fitted, strict=True):
        rows = len(part.force)
        least = min(rows, len(record.force) - rows) if share else rows
        if least < LEAST_ROWS:
            cut = f"--test-fraction {share:g} cuts off {least} rows of '{record.name}'"
            raise InputError(f"{cut}; a part has at least {LEAST_ROWS}")
    return Split(train, fitted, [*held_out.values()])


def _match_records(records: Sequence[BenchRecord], patterns: Sequence[str]) -> dict[int, BenchRecord]:
    """Return the records whose file, or whose own name, matches one of the globs, by their place.

    Raises:
        InputError: a pattern matches nothing.
    """
    chosen: dict[int, BenchRecord] = {}
    for pattern in patterns:
        names = {k: (r.file, stem(r.file), r.name) for k, r in enumerate(records)}
        found = {k: records[k] for k in names if any(fnmatch(name, pattern) for name in names[k])}
        if not found:
            known = list(dict.fromkeys(stem(record.file) for record in records))
            raise InputError(
                f"--test {pattern} matches no record{nearest(pattern, known)}; there are {', '.join(known)}"
            )
        chosen |= found
    return chosen
