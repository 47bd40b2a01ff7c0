#!/usr/bin/env python3
"""Writes arrow_schema_language.bin: an Arrow schema of only the two columns of language, as pyarrow serialises it.

The names, types and nullability are those that `language_type` (columns.rs) writes into Parquet, so that the two
schemas of a file agree. LeRobot's own type (lerobot/datasets/language.py) differs from it in words only: it calls a
list's entries `item`, lets them be null, and marks the texts of `tool_calls` as JSON, which are texts all the same.

Run it with any pyarrow, beside the file: python arrow_schema_language.py
"""

from pathlib import Path

import pyarrow as pa


def language_field(name: str, has_time: bool) -> pa.Field:
    row = [
        pa.field("role", pa.string(), nullable=False),
        pa.field("content", pa.string()),
        pa.field("style", pa.string()),
        *([pa.field("timestamp", pa.float32(), nullable=False)] if has_time else []),
        pa.field("camera", pa.string()),
        pa.field("tool_calls", pa.list_(pa.field("element", pa.string()))),
    ]
    return pa.field(name, pa.list_(pa.field("element", pa.struct(row), nullable=False)), nullable=False)


FIELDS = [language_field("language_persistent", True), language_field("language_events", False)]

if __name__ == "__main__":
    Path(__file__).with_suffix(".bin").write_bytes(pa.schema(FIELDS).serialize().to_pybytes())
