"""What tells whether two results may be read with the same scales."""

from __future__ import annotations

import hashlib
import json

from sculler_model.design.design import Design


def scales_hash(design: Design) -> int:
    """The first 32 bits of a SHA-256 over all that turns a result's integers into rad and m/s.

    The digest is that of the text that `json.dumps(..., sort_keys=True)` gives of an object with
    `accel` and `gyro` (m/s and rad a count), `columns` (the result's), `samples_per_major` and
    `table` (the tap table as the manifest has it).

    Args:
        design: the design.
    """
    said = {
        "accel": design.accel_scale,
        "gyro": design.gyro_scale,
        "columns": list(design.columns),
        "samples_per_major": design.samples_per_major,
        "table": design.table.as_json(),
    }
    digest = hashlib.sha256(json.dumps(said, sort_keys=True).encode()).digest()
    return int.from_bytes(digest[:4], "big")
