#!/usr/bin/env python3
"""Prints the entities of a Rerun recording as JSON, read by the PyPI package rerun-sdk.

    read_recording.py FILE.rrd

Each entity has the numbers of its static rows and of its rows on a timeline, the times in ns, and its positions and scalars.
"""

import json
import sys
import warnings

from rerun.chunk import RrdReader

# The reader warns that the file has no footer.
warnings.simplefilter("ignore")
reader = RrdReader(sys.argv[1])
(recording,) = reader.recordings()
(blueprint,) = reader.blueprints()
entities = {}
for store, timeline in [(recording, "time"), (blueprint, "blueprint")]:
    assert store.application_id == "resect"
    for chunk in reader.stream(store=store):
        assert chunk.timeline_names == ([] if chunk.is_static else [timeline]), chunk
        entity = entities.setdefault(
            chunk.entity_path, {"static": 0, "rows": 0, "times": [], "positions": [], "scalars": []}
        )
        entity["static" if chunk.is_static else "rows"] += chunk.num_rows
        batch = chunk.to_record_batch()
        if timeline == "time" and not chunk.is_static:
            entity["times"] += batch.column("time").cast("int64").to_pylist()
        for name in ["Points3D:positions", "Scalars:scalars"]:
            if name in batch.schema.names:
                for cell in batch.column(name).to_pylist():
                    entity[name.split(":")[1]] += cell
print(json.dumps(entities))
