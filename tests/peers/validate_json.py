#!/usr/bin/env python3
"""Validates JSON outputs, a list for each command, against the schema of resect with the package jsonschema.

    validate_json.py SCHEMA OUTPUTS
"""

import json
import sys
from pathlib import Path

from jsonschema import Draft202012Validator

schema, outputs = (json.loads(Path(name).read_text()) for name in sys.argv[1:])
Draft202012Validator.check_schema(schema)
errors = 0
for command, values in outputs.items():
    own = {key: value for key, value in schema.items() if key != "anyOf"} | {"$ref": f"#/$defs/{command}"}
    for value in values:
        for error in Draft202012Validator(own).iter_errors(value):
            errors += 1
            print(f"{command}: {error.json_path}: {error.message[:200]}")
sys.exit(1 if errors else 0)
