"""Why numba cannot compile something is said in one sentence, by file, line and reason."""

import math
from pathlib import Path
from typing import NamedTuple

import numba
import pytest
from numba import njit
from numba.core.errors import TypingError

from seatsim.compilation.messages import explain, is_compilation
from seatsim.schema.modules import use

compiled = pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="nothing is compiled")


class Record(NamedTuple):
    a: float = 1.0
    b: float = 2.0


@njit
def asks_for_what_is_not_there(record):
    return record.a + record.c


@njit
def asks_within(record):
    return 1.0 + asks_for_what_is_not_there(record)


@njit
def takes_one(x):
    return x


@njit
def calls_with_one_more(x):
    return takes_one(x, x)


@njit
def adds_a_text(x):
    return x + "one"


def fail(function, *arguments):
    with pytest.raises(TypingError) as error:
        function(*arguments)
    return error.value


def line_of(function, text):
    lines = Path(__file__).read_text(encoding="utf-8").splitlines()
    begins = next(k for k, line in enumerate(lines) if f"def {function}" in line)
    return next(k + 1 for k in range(begins, len(lines)) if text in lines[k])


@compiled
@pytest.mark.parametrize("function", [asks_for_what_is_not_there, asks_within])
def test_an_unknown_attribute_is_named_where_it_is_asked_for(function):
    error = fail(function, Record())
    assert is_compilation(error)
    place = f"test_reasons.py, line {line_of('asks_for_what_is_not_there', 'record.c')}"
    # The types of all fields, which numba prints as well, are left out.
    assert explain(error) == f"{place}: cannot be compiled: unknown attribute 'c' of type Record"


@compiled
def test_a_function_that_is_called_with_others_is_shown_by_its_arguments():
    said = explain(fail(calls_with_one_more, 1.0))
    assert said.endswith("cannot be compiled: (x) is called with other arguments: too many positional arguments")


def test_of_an_error_in_own_code_the_line_is_said(tmp_path, forget_own_code):
    (tmp_path / "own.py").write_text("import math\n\n\ndef root(x):\n    return math.sqrt(x)\n")
    with pytest.raises(ValueError, match="math") as error:
        use(tmp_path / "own.py").root(-1.0)
    assert explain(error.value).startswith("own.py, line 5: ValueError: ")


@compiled
def test_what_cannot_be_added_is_said_with_its_line():
    place = f"test_reasons.py, line {line_of('adds_a_text', 'return')}"
    assert explain(fail(adds_a_text, 1.0)) == f"{place}: cannot be compiled: add takes no (float64, Literal[str](one))"


def test_of_other_errors_kind_and_first_line_are_said():
    assert explain(ValueError("no\nand more")) == "ValueError: no"
    assert explain(KeyError("damper")) == "KeyError: 'damper'"
    with pytest.raises(ValueError, match="math") as error:
        math.sqrt(-1.0)
    assert not is_compilation(error.value)
