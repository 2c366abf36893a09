"""Run scenarios: one, several, or many side by side."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path

import numpy as np

from seatsim.compilation.messages import explain
from seatsim.metrics.table import Metric, summarise
from seatsim.scenario.loading import load
from seatsim.scenario.numbers import list_doubts
from seatsim.scenario.scenario import Scenario
from seatsim.schema.arrays import store_numbers, store_texts
from seatsim.schema.errors import InputError, RunError, SynthesisError
from seatsim.schema.files import write_whole
from seatsim.simulation.augment import augment_plant
from seatsim.simulation.result import UNITS, History, Result, Run
from seatsim.simulation.simulate import simulate
from seatsim.simulation.validity import explain_unweighted, list_reasons


def run(scenario: str | Path | Mapping[str, object] | Scenario, settings: Mapping[str, object] | None = None) -> Result:
    """Run a scenario, or the file of one (or a mapping with the keys of one) with all its variants and sweeps.

    Raises:
        InputError: the file is wrong. RunError: a run could not be carried to its end.
    """
    return _run_all([scenario] if isinstance(scenario, Scenario) else load(scenario, settings))


def compare(paths: Iterable[str | Path], settings: Mapping[str, object] | None = None) -> Result:
    """Run several files and return one result over all of them."""
    return _run_all([one for path in paths for one in load(path, settings)])


def _run_all(scenarios: Sequence[Scenario]) -> Result:
    carry_all = _share_a_loop(scenarios)
    return Result([run_one(one, carry_all) for one in scenarios])


def _share_a_loop(scenarios: Iterable[Scenario]) -> bool | None:
    """Return `carry_all_effects` of scenarios that run together: None where they differ in effects, else False.

    Loops for one set of effects are compiled in half the time that one takes which carries all.
    """
    kinds = {frozenset(map(type, scenario.effects)) for scenario in scenarios if scenario.effects}
    return None if len(kinds) > 1 else False


def run_one(scenario: Scenario, carry_all_effects: bool | None = False) -> Run:
    """Simulate one scenario and work out its metrics; `carry_all_effects` as for `simulate`."""
    history = simulate(scenario, carry_all_effects=carry_all_effects)
    metrics = measure_run(scenario, history)
    reasons = list_reasons(scenario, history, metrics)
    warnings = (*list_doubts(scenario), *reasons, *explain_unweighted(history.step, metrics))
    return Run(scenario, history, metrics, warnings, reasons)


def measure_run(scenario: Scenario, history: History) -> dict[str, Metric]:
    """Return the metrics of a run by name."""
    plant = scenario.plant
    return summarise(
        history.channels,
        history.step,
        travel=augment_plant(scenario.effects, plant).end_stops if plant else None,
        coil_resistance=scenario.coil.resistance,
    )


def run_many(
    scenarios: list[Scenario], done: Callable[[Scenario], None]
) -> Iterator[tuple[Scenario, Run | RunError | SynthesisError]]:
    """Run scenarios on all processors and yield each with its run or its failure, in order; `done` is called with each.

    Raises:
        InputError: a scenario turned out to be wrong.
    """
    carry_all = _share_a_loop(scenarios)

    def attempt(scenario: Scenario) -> Run | RunError | SynthesisError:
        try:
            return run_one(scenario, carry_all)
        except (RunError, SynthesisError) as error:
            return error
        except InputError:
            raise
        except Exception as error:  # a model of the user's own may raise anything, and is not to end the other runs
            return RunError(f"{scenario.title}: {explain(error)}")
        finally:
            done(scenario)

    pool = ThreadPoolExecutor(os.cpu_count())
    try:
        yield from zip(scenarios, pool.map(attempt, scenarios), strict=True)
    finally:
        # An interrupt does not wait for runs that have begun.
        pool.shutdown(wait=False, cancel_futures=True)


def write_histories(runs: Iterable[Run], path: Path) -> Path:
    """Write all runs below each other, in single precision but for the time; column `run` holds their titles."""
    return write_whole(path, partial(_write, runs))


def _write(runs: Iterable[Run], path: Path) -> None:
    import pyarrow as pa
    import pyarrow.parquet as pq

    fields = [pa.field("run", pa.dictionary(pa.int32(), pa.string()))]
    fields += [
        pa.field(name, pa.float64() if name == "time" else pa.float32(), metadata={"unit": unit})
        for name, unit in UNITS.items()
    ]
    schema = pa.schema(fields)
    # Hardly a number occurs twice: to look for equal ones took four times as long. Their first bytes are alike.
    split = {"use_dictionary": ["run"], "use_byte_stream_split": list(UNITS)}
    with pq.ParquetWriter(path, schema, compression="zstd", compression_level=1, **split) as writer:
        for run in runs:
            length = len(run.history["time"])
            titles = pa.DictionaryArray.from_arrays(
                store_numbers(np.zeros(length), pa.int32()), store_texts([run.scenario.title])
            )
            columns = [store_numbers(run.history[name], schema.field(name).type) for name in UNITS]
            writer.write_table(pa.Table.from_arrays([titles, *columns], schema=schema))
