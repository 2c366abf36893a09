"""The text of a `map.yaml`, with a line for each channel, to be edited."""

from __future__ import annotations

from pathlib import Path

from seatsim.importing.import_map import ChannelMap, ImportMap
from seatsim.schema.files import write_text


def write_map(path: Path, stated: ImportMap) -> Path:
    """Write a map as it is read, with a line for each channel and the comments behind them."""
    return write_text(path, render_map(stated))


def render_map(stated: ImportMap) -> str:
    """Return the text of a map."""
    lines = [f"rig: {stated.rig}"]
    for name, axis in (("time", stated.time), ("distance", stated.distance)):
        if axis is not None:
            lines.append(f"{name}: {{column: {_text(axis.column)}, unit: {_text(axis.unit)}}}")
    rates = {"sample_rate": stated.sample_rate, "resample": stated.resample}
    lines += [f"{key}: {value:.10g}" for key, value in rates.items() if value is not None]
    lines.append("channels:")
    for name, channel in stated.channels.items():
        comment = f"   # {stated.comments[name]}" if name in stated.comments else ""
        lines.append(f"  {name}: {{{', '.join(_entries(channel))}}}{comment}")
    lines += _blocks(stated)
    return "\n".join(lines) + "\n"


def _entries(channel: ChannelMap) -> list[str]:
    """Return the keys of a channel that are stated, and those that a user edits."""
    shown = {"column", "unit", "sign"} if channel.value is None else {"value", "unit"}
    kept = [(key, value) for key, value in channel._asdict().items()
            if key in shown or value != ChannelMap._field_defaults[key]]  # fmt: skip
    return [f"{key}: {_text(value)}" for key, value in kept]


def _blocks(stated: ImportMap) -> list[str]:
    lines = []
    layout = {key: value for key, value in stated.csv._asdict().items() if value is not None}
    if layout:
        lines.append(f"csv: {{{', '.join(f'{key}: {_text(value)}' for key, value in layout.items())}}}")
    if stated.gaps is not None:
        lines.append(f"gaps: {stated.gaps}")
    if stated.actuator is not None:
        lines.append(f"actuator: {{gain: {stated.actuator.gain:.10g}}}")
    if stated.align:
        lines.append(f"align: {{{', '.join(f'{_text(key)}: {value:.7g}' for key, value in stated.align.items())}}}")
    if stated.repeats:
        lines.append(f"repeats: {{{', '.join(f'{_text(run)}: {_text(of)}' for run, of in stated.repeats.items())}}}")
    if stated.runs:
        lines.append("runs:")
        lines += [
            f"  {_text(name)}: [{', '.join(_text(file) for file in files)}]" for name, files in stated.runs.items()
        ]
    return lines


def _text(value: object) -> str:
    """Return a value as YAML has it in one line; a text is quoted unless it is a plain word."""
    if value is None:
        return "null"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int | float):
        return f"{value:.10g}"
    text = str(value)
    plain = text.replace("_", "").replace("-", "").replace(".", "").replace("/", "").replace("^", "")
    is_word = (
        plain.isalnum()
        and plain[0].isalpha()
        and text.lower() not in ("y", "n", "yes", "no", "on", "off", "true", "false", "null")
    )
    escaped = text.replace("\\", "\\\\").replace('"', '\\"').replace("\t", "\\t")
    return text if is_word and text[0].isalnum() else f'"{escaped}"'
