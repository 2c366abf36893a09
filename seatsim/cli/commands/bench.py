"""The command that measures what runs cost on this machine: bench."""

from __future__ import annotations

from typing import Annotated

import typer

from seatsim.cli.options import Json
from seatsim.cli.terminal import answer, say, show_progress, warn
from seatsim.schema.errors import InputError, nearest


def bench(
    parts: Annotated[
        list[str] | None,
        typer.Argument(metavar="[PART]...", help="dampers, length, cores, dask, c, scipy, numbalsoda, heyoka; or all."),
    ] = None,
    models: Annotated[
        list[str] | None, typer.Option("--model", metavar="NAME", help="Damper of the part 'dampers'; or all.")
    ] = None,
    as_json: Json = False,
) -> None:
    """Measure what runs cost on this machine, as ratios: dampers, lengths, processors, C, general solvers."""
    from seatsim.benchmark.parts import list_parts
    from seatsim.dampers.base import DAMPERS

    for name in models or []:
        DAMPERS.find(name)
    known = list_parts(models or DAMPERS.names())
    for name in parts or []:
        if name not in known:
            raise InputError(f"bench has no part '{name}'{nearest(name, known)}; permitted: {', '.join(known)}")
    costs, left_out = [], {}
    for name in parts or known:
        part = known[name]
        if part.lacks:
            warn([f"{name} is left out: {part.lacks}"])
            left_out[name] = part.lacks
            continue
        say(f"{name}: {part.title}")
        with show_progress() as show:
            show(f"measuring {name}")
            for cost in part.measure():
                say(f"  {cost.what:30} {cost.value:9.4g} {cost.unit:10} {cost.ratio:7.3g} x {cost.beside}")
                costs.append({"part": name, **cost._asdict()})
    answer({"costs": costs, "left_out": left_out})
