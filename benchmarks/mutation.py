"""Mutants of one module, and how many of them its tests find.

    python benchmarks/mutation.py MODULE TEST... [--only NAMES] [--most 15] [--seed 0] [--compiled]
    python benchmarks/mutation.py seatsim/kernel/inverse.py tests/kernel/test_inverse.py

A mutant differs from the module in one place: a sign or an operator of arithmetic, a comparison, a number, min for max,
or a factor that is left out. Each is written to a copy of the package in a temporary folder, against which the tests
run in a child process. What survives is printed with its line: a test is missing, or the change has no effect.
Without `--compiled` the functions run as plain Python (`NUMBA_DISABLE_JIT`), which starts sooner than compiling them.
"""

from __future__ import annotations

import argparse
import ast
import copy
import os
import random
import shutil
import signal
import sys
import tempfile
import time
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
COPIED = ("seatsim", "controllers", "scenarios", "tests", "benchmarks", "pyproject.toml")
LONGEST, MANY = 300, 10
"""Seconds that the tests may take; a mutant with which they take so many times as long hangs, and counts as found."""
OPERATORS: dict[type, type] = {ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult}
COMPARISONS: dict[type, type] = {ast.Lt: ast.GtE, ast.LtE: ast.Gt, ast.Gt: ast.LtE, ast.GtE: ast.Lt}
SWAPPED = {"min": "max", "max": "min", "sin": "cos", "exp": "tanh", "tanh": "sin", "copysign": "hypot"}


def list_mutants(node: ast.expr) -> Iterator[tuple[str, ast.expr]]:
    """Yield what an expression may be mutated to, each with the words for it."""
    new = copy.deepcopy(node)
    if isinstance(new, ast.BinOp) and type(new.op) in OPERATORS:
        new.op = OPERATORS[type(new.op)]()
        yield "operator", new
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Mult):
            yield "factor left out", node.left
    elif isinstance(new, ast.UnaryOp) and isinstance(new.op, ast.USub):
        yield "sign", new.operand
    elif isinstance(new, ast.Compare) and len(new.ops) == 1 and type(new.ops[0]) in COMPARISONS:
        new.ops = [COMPARISONS[type(new.ops[0])]()]
        yield "comparison", new
    elif isinstance(new, ast.Constant) and isinstance(new.value, float):
        yield "number", ast.Constant(1.5 * new.value or 1.0)
    elif isinstance(new, ast.Call):
        name = new.func
        if isinstance(name, ast.Name) and name.id in SWAPPED:
            yield "function", ast.Call(ast.Name(SWAPPED[name.id], ast.Load()), new.args, new.keywords)
        elif isinstance(name, ast.Attribute) and name.attr in SWAPPED:
            swapped = ast.Attribute(name.value, SWAPPED[name.attr], ast.Load())
            yield "function", ast.Call(swapped, new.args, new.keywords)


def list_places(tree: ast.Module) -> list[ast.expr]:
    """Return the expressions in the bodies of functions; defaults, decorators and annotations are not among them."""
    bodies = [part for part in ast.walk(tree) if isinstance(part, ast.FunctionDef)]
    return [node for body in bodies for part in body.body for node in ast.walk(part) if isinstance(node, ast.expr)]


def mutate(source: str) -> list[tuple[int, str, str]]:
    """Return every mutant of a source: line, words for the change, and the mutated source."""
    count = len(list_places(ast.parse(source)))
    found = []
    for place in range(count):
        for choice in range(2):
            tree = ast.parse(source)
            node = list_places(tree)[place]
            options = list(list_mutants(node))
            if choice < len(options):
                words, new = options[choice]
                text = f"{words}: {ast.unparse(node)} -> {ast.unparse(new)}"
                found.append((node.lineno, text, ast.unparse(_Replace(node, new).visit(tree))))
    return found


class _Replace(ast.NodeTransformer):
    """Replaces one node by another."""

    def __init__(self, old: ast.AST, new: ast.expr) -> None:
        self.old, self.new = old, new

    def generic_visit(self, node: ast.AST) -> ast.AST:
        if node is self.old:
            return ast.fix_missing_locations(ast.copy_location(self.new, self.old))
        return super().generic_visit(node)


def passes(folder: Path, arguments: list[str], longest: float = LONGEST) -> bool:
    """Return whether the tests pass on the copy in a folder, in a child of this process, which has loaded pytest.

    They fail where they take longer than `longest` in s.
    """
    child = os.fork()
    if child == 0:
        nothing = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nothing, 1)
        os.dup2(nothing, 2)
        os.chdir(folder)
        sys.path.insert(0, str(folder))
        signal.setitimer(signal.ITIMER_REAL, longest)
        os._exit(pytest.main(["-x", "-q", "-n", "0", "-p", "no:cacheprovider", *arguments]))
    return os.waitpid(child, 0)[1] == 0


def main() -> None:
    """Print the mutants that survive, and how many were found."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("module")
    parser.add_argument("tests", nargs="+")
    parser.add_argument("--only", default="", help="names of tests, as for pytest -k")
    parser.add_argument("--most", type=int, default=15)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--compiled", action="store_true")
    options = parser.parse_args()
    tests = ["-k", options.only, *options.tests]
    if not options.compiled:
        os.environ["NUMBA_DISABLE_JIT"] = "1"
    # Loaded once for all children: it takes longer than most tests.
    for heavy in ("numba", "scipy.integrate", "scipy.signal", "pydantic"):
        import_module(heavy)
    mutants = mutate((ROOT / options.module).read_text(encoding="utf-8"))
    chosen = random.Random(options.seed).sample(mutants, min(options.most, len(mutants)))
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        os.environ["SEATSIM_CACHE_DIR"] = str(folder / "cache")
        for part in COPIED:
            copied = shutil.copytree if (ROOT / part).is_dir() else shutil.copy2
            copied(ROOT / part, folder / part)
        start = time.monotonic()
        if not passes(folder, tests):
            sys.exit("the tests fail on the module as it is")
        longest, killed = MANY * (time.monotonic() - start), 0
        for line, words, source in chosen:
            (folder / options.module).write_text(source, encoding="utf-8")
            survived = passes(folder, tests, longest)
            killed += not survived
            if survived:
                print(f"{options.module}:{line}: survives: {words}", flush=True)
    print(f"{options.module}: {killed} of {len(chosen)} mutants found, of {len(mutants)} that there are")


if __name__ == "__main__":
    main()
