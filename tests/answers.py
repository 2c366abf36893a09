"""What a command prints with `--json` is of the documented form."""

import json

import jsonschema

from seatsim.cli.outputs.answers import describe_answer, list_answers
from seatsim.schema.json_schema import answer_schema


def check_answer(name, text):
    """Return the one object of a command, which has the keys of its schema and no others (a design has more)."""
    found = json.loads(text)
    jsonschema.validate(found, describe_answer(name))
    if name != "synthesise":
        record = answer_schema(list_answers()[name])
        jsonschema.validate({key: value for key, value in found.items() if key != "files"}, close(record))
    return found


def close(schema):
    """Return a schema under which objects have the keys that it names, and no others."""
    if isinstance(schema, list):
        return [close(each) for each in schema]
    if not isinstance(schema, dict):
        return schema
    closed = {"additionalProperties": False} if "properties" in schema else {}
    return {**{key: close(value) for key, value in schema.items()}, **closed}
