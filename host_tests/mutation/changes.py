"""Small changes of C++ source text: where a file can be changed, and what it becomes."""

import re
from typing import Iterator, NamedTuple


class Change(NamedTuple):
    """One small change within one line."""

    kind: str
    line: int  # From 1.
    column: int  # From 0.
    before: str
    after: str


COMPARISONS = {"<": "<=", "<=": "<", ">": ">=", ">=": ">", "==": "!=", "!=": "=="}
NEGATIONS = {"<": ">=", "<=": ">", ">": "<=", ">=": "<"}
SUMS = {"+": "-", "-": "+", "*": "/", "/": "*", "+=": "-=", "-=": "+=", "*=": "/=", "/=": "*="}
LOGIC = {"&&": "||", "||": "&&"}
RETURNS = {"true": "false", "false": "true", "Status::kOk": "Status::kHardwareFault"}

# clang-format sets a blank at both sides of a binary operator, and of nothing else.
BINARY = re.compile(r"(?<=[\w)\]\"'] )(<=|>=|==|!=|&&|\|\||[-+*/]=|[-<>+*/])(?= [\w(\-!*&~:\"'])")
STEP = re.compile(r"(?<=[\w)\]]) [-+] 1\b(?![.\w'])")
NUMBER = re.compile(r"(?<![\w.'])(0x[0-9a-fA-F.]+p[-+]?\d+|0x[0-9a-fA-F']+|\d[\d']*(?:\.\d*)?(?:e[-+]?\d+)?)([uUlL]*)(?![\w.'])")
CONDITION = re.compile(r"^(\s*(?:\} else )?if \()([^;{}]*)(?=\) \{$)")
RETURN = re.compile(r"(?<=\breturn )(true|false|Status::kOk)(?=;)")
CHOICE = re.compile(r"(?<= \? )([^?:;]+) : ([^?:;()]+)(?=;$)")
# A call or an assignment by itself; a declaration has two words before its "=" or "(".
STATEMENT = re.compile(r"^(\s*)((?:\(void\))?\*?[A-Za-z_][\w:]*(?:\.|->|\(|\[| [-+*/|&^]?= |\+\+|--).*;|(?:\+\+|--)[\w.>\[\]-]+;)$")
NO_STATEMENT = re.compile(r"\s*(return|break|continue|using|case|default|static_assert|friend|typedef|goto|delete)\b")


def masked(text: str) -> str:
    """The text with blanks for what is no code: comments, the inside of strings, preprocessor, static_assert."""
    pattern = re.compile(
        r'//[^\n]*|/\*.*?\*/|R"(\w*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"|(?<![0-9a-fA-F])\'(?:\\.|[^\'\\\n])+\''
        r"|^[ \t]*#(?:\\\n|[^\n])*|^[ \t]*static_assert\([^;]*;",
        re.DOTALL | re.MULTILINE,
    )

    def blank(match: "re.Match[str]") -> str:
        found = re.sub(r"[^\n]", " ", match[0])
        return match[0][0] + found[1:-1] + match[0][-1] if match[0][0] in "\"'" else found

    return pattern.sub(blank, text)


def changes_of(text: str) -> list[Change]:
    """All changes of a file that are worth a look, in the order of its lines."""
    lines = text.split("\n")
    found = []
    before = ""
    for number, code in enumerate(masked(text).split("\n"), 1):
        original = lines[number - 1]
        for kind, column, length, after in in_line(code, before):
            change = Change(kind, number, column, original[column : column + length], after(original))
            if change.before != change.after:
                found.append(change)
        before = code if code.strip() else before
    return found


def in_line(code: str, before: str) -> Iterator[tuple]:
    """Kind, column, length and new text of each change, the last as a function of the original line."""
    code = code.rstrip()
    if "template" in code or "#" in code:
        return
    for match in BINARY.finditer(code):
        operator = match[1]
        if code.lstrip().startswith(("operator", "using")):
            continue
        for kind, table in (("cmp", COMPARISONS), ("cmp", NEGATIONS), ("arith", SUMS), ("logic", LOGIC)):
            if operator in table:
                yield kind, match.start(), len(operator), lambda _, t=table, o=operator: t[o]
    for match in STEP.finditer(code):
        yield "off1", match.start(), len(match[0]), lambda _: ""
    for match in NUMBER.finditer(code):
        for kind, after in numbers(match[1]):
            yield kind, match.start(1), len(match[1]), lambda _, a=after: a
    if match := CONDITION.match(code):
        at, end = match.end(1), match.end(2)
        yield "neg", at, end - at, lambda line, a=at, e=end: f"!({line[a:e]})"
    for match in RETURN.finditer(code):
        yield "ret", match.start(), len(match[1]), lambda _, r=match[1]: RETURNS[r]
    if match := CHOICE.search(code):
        first, second = match.span(1), match.span(2)
        yield (
            *("choice", first[0], second[1] - first[0]),
            lambda line, f=first, s=second: f"{line[s[0]:s[1]]} : {line[f[0]:f[1]]}",
        )
    if (match := STATEMENT.match(code)) and is_statement(code, before):
        yield "del", len(match[1]), len(match[2]), lambda _: ";"


def is_statement(code: str, before: str) -> bool:
    begins = before.rstrip().endswith((";", "{", "}", ":"))
    return begins and code.count("(") == code.count(")") and not NO_STATEMENT.match(code)


def numbers(literal: str) -> list[tuple[str, str]]:
    """What else may stand for a number: one more for an integer, 10 % more for another one."""
    plain = literal.replace("'", "")
    if "p" in plain:
        head, exponent = plain.split("p")
        return [("int", f"{head}p{int(exponent) - 1:+d}")]
    if plain.lower().startswith("0x"):
        return [("int", hex(int(plain, 16) ^ 1))]
    if plain.isdigit():
        return [("int", str(int(plain) + 1))]
    value = float(plain)
    return [("const", "0.1" if value == 0.0 else repr(value * 1.1))]


def apply(text: str, change: Change) -> str:
    """The text with that change. Raises ValueError if it does not have there what is to be changed."""
    lines = text.split("\n")
    line = lines[change.line - 1]
    end = change.column + len(change.before)
    if line[change.column : end] != change.before:
        raise ValueError(f"line {change.line} has not {change.before!r} in column {change.column}")
    lines[change.line - 1] = line[: change.column] + change.after + line[end:]
    return "\n".join(lines)


def changed_line(text: str, change: Change) -> tuple[str, str]:
    """The line without and with the change, without its indentation."""
    before = text.split("\n")[change.line - 1]
    after = apply(text, change).split("\n")[change.line - 1]
    return before.strip(), after.strip()


def with_line(text: str, number: int, after: str) -> str:
    """The text with another line of that number, indented like it."""
    lines = text.split("\n")
    line = lines[number - 1]
    lines[number - 1] = line[: len(line) - len(line.lstrip())] + after
    return "\n".join(lines)
