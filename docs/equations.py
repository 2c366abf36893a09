"""LaTeX of the equations that docstrings state in plain text, such as `F = (c_a + c_b i) v + f0`."""

from __future__ import annotations

import re

FUNCTIONS = {"exp": r"\exp", "tanh": r"\tanh", "arctan": r"\arctan", "sgn": r"\operatorname{sgn}"}
GREEK = {"alpha", "beta", "gamma", "delta", "lambda", "mu", "pi", "rho", "sigma", "tau"}
SIGNS = {"<=": r"\le ", ">=": r"\ge ", "...": r"\ldots ", "{": r"\{", "}": r"\}"}
TOKEN = re.compile(
    r"`(?P<code>\w+)`"
    r"|(?P<words>\b(?:always|(?:pre|post)-yield|the same mirrored|limited to|as in|for|where|below|beyond)\b)"
    r"|(?P<unit>(?<=\d )(?:m/)?s\b)"
    r"|(?P<derivative>d[A-Z]/d[a-z])"
    r"|(?P<name>[A-Za-z]\w*)"
    r"|(?P<gap>:\s*|\s{3,})"
    r"|(?P<sign><=|>=|\.\.\.|.)"
)
ROOT = re.compile(r"sqrt\(([^()]*)\)")
POWER = re.compile(r"\^(\((?:[^()]|\([^()]*\))*\)|\w+)")
LEFT_SIDE = re.compile(r"[\w' |.`-]+(\([^()]*\))?\s*[=<>:]|.* as in ")


def convert_equations(text: str) -> str:
    """Return the LaTeX of lines of equations, an equation a row; `,   ` parts several on one line."""
    lines = [part for line in text.splitlines() for part in re.split(r"(?<=,) {2,}", line.strip())]
    rows = [("& " if LEFT_SIDE.match(line) else r"& \qquad ") + convert(line) for line in lines]
    return "\\begin{aligned}\n" + " \\\\\n".join(rows) + "\n\\end{aligned}"


def convert(line: str) -> str:
    """Return the LaTeX of one equation."""
    for pattern, mark in ((ROOT, r"\sqrt"), (POWER, "^")):
        found = pattern.search(line)
        if found:
            inner = found[1][1:-1] if found[1].startswith("(") else found[1]
            return f"{convert(line[: found.start()])}{mark}{{{convert(inner)}}}{convert(line[found.end() :])}"
    return "".join(_convert_token(match) for match in TOKEN.finditer(line))


def _convert_token(match: re.Match[str]) -> str:
    kind, text = match.lastgroup, match[0]
    if kind == "code":
        return r"\text{" + match["code"].replace("_", r"\_") + "}"
    if kind in {"words", "unit"}:
        return rf"\text{{ {text} }}"
    if kind == "derivative":
        return rf"\frac{{d{text[1]}}}{{d{text[-1]}}}"
    if kind == "name":
        return FUNCTIONS.get(text) or _convert_symbol(text)
    return text.strip() + r"\quad " if kind == "gap" else SIGNS.get(text, text)


def _convert_symbol(name: str) -> str:
    """Return a symbol: a Greek letter by its name, and as its index what stands behind the first letter."""
    if name == "eps":
        return r"\varepsilon "
    greek = next((letter for letter in GREEK if name.startswith(letter)), "")
    index = ",".join(part for part in name[len(greek) or 1 :].split("_") if part)
    symbol = rf"\{greek}" if greek else name[0]
    return symbol + (rf"_{{\mathrm{{{index}}}}}" if index else " " * bool(greek))
