"""How a notebook shows a record: what it is as JSON, in tables."""

from __future__ import annotations

import html
from collections.abc import Iterable, Iterator, Mapping, Sequence

from seatsim.schema.content import to_content

SHOWN = 12
"""Rows of a list of records that are shown: the first ones are those that matter."""


def show_record(record: object, *keys: str) -> str:
    """Return in HTML what a record is as JSON, or some keys of it: its values, then each list of records as a table.

    Keys of what lies deeper have dots; of the records in a list their single values are shown. Numbers are rounded to
    four digits.
    """
    content = to_content(record)
    values = dict(_flatten({key: content[key] for key in keys or content}))
    lists = {key: value for key, value in values.items() if isinstance(value, list)}
    tables = {key: rows for key, value in lists.items() if (rows := [row for row in value if isinstance(row, dict)])}
    single = [{"": key, " ": value} for key, value in values.items() if key not in tables]
    return "".join([_show_table("", single), *(_show_table(key, rows) for key, rows in tables.items())])


def _flatten(content: Mapping[str, object], above: str = "") -> Iterator[tuple[str, object]]:
    for key, value in content.items():
        if isinstance(value, dict):
            yield from _flatten(value, f"{above}{key}.")
        else:
            yield f"{above}{key}", value


def _show_table(name: str, rows: Sequence[Mapping[str, object]]) -> str:
    shown = [{key: cell for key, cell in row.items() if not isinstance(cell, dict)} for row in rows]
    columns = list(dict.fromkeys(key for row in shown for key in row))
    lines = [_row("th", columns)] if name else []
    lines += [_row("td", (row.get(key) for key in columns)) for row in shown[: SHOWN if name else None]]
    heading = f"<p>{html.escape(name)}</p>" if name else ""
    return f"{heading}<table>{''.join(lines)}</table>"


def _row(tag: str, cells: Iterable[object]) -> str:
    return f"<tr>{''.join(f'<{tag}>{html.escape(_say(cell))}</{tag}>' for cell in cells)}</tr>"


def _say(value: object) -> str:
    if isinstance(value, list):
        return ", ".join(map(_say, value))
    return "" if value is None else f"{value:.4g}" if isinstance(value, float) else str(value)
