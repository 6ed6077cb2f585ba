"""Reads a record of `eclss-rt hil --record DIR` with the reference reader of MCAP and with pandas.

    python3 -m venv venv && venv/bin/pip install mcap pandas
    venv/bin/python host-sim/tests/check_record.py DIR
"""

import json
import sys

import pandas
from mcap.reader import make_reader

folder = sys.argv[1]
table = pandas.read_csv(f"{folder}/record.csv")
with open(f"{folder}/record.mcap", "rb") as file:
    reader = make_reader(file, validate_crcs=True)
    attached = {part.name: len(part.data) for part in reader.iter_attachments()}
    run = {record.name: record.metadata for record in reader.iter_metadata()}["run"]
    rows = [json.loads(message.data) for _, _, message in reader.iter_messages(topics=["/plant"])]

assert set(attached) == {"network.toml", "start.eckp"}, attached
assert len(rows) == len(table), (len(rows), len(table))
assert table["tick"].tolist() == [row["tick"] for row in rows]
names = [name for name in table.columns if name.endswith("_max")]
assert names, "no figures, or a row for every tick"
for maximum in names:
    name = maximum.removesuffix("_max")
    values = table[[f"{name}_min", name, maximum]].dropna()
    assert (values[f"{name}_min"] <= values[name]).all() and (values[name] <= values[maximum]).all(), name
    for cell, row in zip(table[name], rows):
        assert row[name] is None if pandas.isna(cell) else row[name] == cell, (name, row["tick"])
print(f"{len(rows)} rows of {run['rows']} ticks, {run['rows_dropped']} dropped, state hash {run['state_hash']}: good")
