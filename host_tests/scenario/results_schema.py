"""firmware/desk/results.schema.json: a check of files against it, and its table for the README beside it.

usage: results_schema.py           prints the table
       results_schema.py FILE      checks a results.json
"""

import json
import pathlib
import sys

DESK = pathlib.Path(__file__).resolve().parents[2] / "firmware" / "desk"
SCHEMA = json.loads((DESK / "results.schema.json").read_text(encoding="ascii"))

TYPES = {
    "object": lambda value: isinstance(value, dict),
    "array": lambda value: isinstance(value, list),
    "string": lambda value: isinstance(value, str),
    "boolean": lambda value: isinstance(value, bool),
    "null": lambda value: value is None,
    "number": lambda value: isinstance(value, (int, float)) and not isinstance(value, bool),
    "integer": lambda value: isinstance(value, int) and not isinstance(value, bool),
}
LIMITS = {
    "minimum": lambda value, limit: value >= limit,
    "maximum": lambda value, limit: value <= limit,
    "exclusiveMinimum": lambda value, limit: value > limit,
    "exclusiveMaximum": lambda value, limit: value < limit,
    "minItems": lambda value, limit: len(value) >= limit,
    "maxItems": lambda value, limit: len(value) <= limit,
    "enum": lambda value, limit: value in limit,
}
LIMITS_OF_NUMBERS = ("minimum", "maximum", "exclusiveMinimum", "exclusiveMaximum")
# All that the schema may use: what is not known here would not be checked.
WORDS = {"$schema", "title", "description", "type", "properties", "required", "additionalProperties", "items"}


def faults(value, schema=None, path="results") -> list[str]:
    """What of `value` is not as the schema says, each with its place; an empty list if all is well."""
    schema = SCHEMA if schema is None else schema
    unknown = set(schema) - WORDS - set(LIMITS)
    if unknown:
        raise ValueError(f"{path}: the schema says {sorted(unknown)}, which is not checked")
    types = schema["type"] if isinstance(schema["type"], list) else [schema["type"]]
    if not any(TYPES[name](value) for name in types):
        return [f"{path}: {str(value)[:40]} is not of type {' or '.join(types)}"]
    if value is None:
        return []
    found = []
    for name, holds in LIMITS.items():
        is_meant = name not in LIMITS_OF_NUMBERS or TYPES["number"](value)
        if name in schema and is_meant and not holds(value, schema[name]):
            found.append(f"{path}: {str(value)[:40]} is outside of {name} {schema[name]}")
    if isinstance(value, dict):
        members = schema["properties"]
        found += [f"{path}: no {name}" for name in schema["required"] if name not in value]
        others = schema["additionalProperties"]
        for name in value:
            if name in members or others is not False:
                found += faults(value[name], members.get(name, others), f"{path}.{name}")
            else:
                found.append(f"{path}: {name} is not in the schema")
    if isinstance(value, list):
        for number, element in enumerate(value):
            found += faults(element, schema["items"], f"{path}[{number}]")
    return found


def no_constant(name: str):
    raise ValueError(f"{name} is no JSON")


def faults_of_text(text) -> list[str]:
    """The same for a file's content, which must be JSON without NaN and Infinity."""
    try:
        return faults(json.loads(text, parse_constant=no_constant))
    except ValueError as error:
        return [str(error)]


def rows(schema, path=""):
    """(name, what it may be in the place of a value, description) of every member, in order."""
    for name, member in schema["properties"].items():
        types = member["type"] if isinstance(member["type"], list) else [member["type"]]
        others = ", or null" * ("null" in types) + ", or missing" * (name not in schema["required"])
        yield path + name, others, member["description"]
        inner = member.get("items", member)
        if "properties" in inner:
            yield from rows(inner, f"{path}{name}{'[]' if inner is not member else ''}.")


def table() -> str:
    lines = ["| field | unit; meaning |", "|---|---|"]
    lines += [f"| `{name}`{others} | {text.replace('|', chr(92) + '|')} |" for name, others, text in rows(SCHEMA)]
    return "\n".join(lines) + "\n"


def main() -> int:
    if len(sys.argv) == 1:
        print(table(), end="")
        return 0
    found = faults_of_text(pathlib.Path(sys.argv[1]).read_text(encoding="utf-8"))
    print("\n".join(found) or "as the schema says")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
