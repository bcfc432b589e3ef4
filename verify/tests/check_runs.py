#!/usr/bin/env python3
"""Reads the tables of `mtled runs export` by pandas, Arrow and DuckDB without options and compares
them with each other and with the records. Usage: check_runs.py FOLDER, which has runs.csv,
runs.parquet and runs.json, the output of `mtled runs list --format json`."""

import json
import pathlib
import sys

import duckdb
import pandas
import pyarrow.parquet


def same(one, other, name):
    both = (one == other) | (one.isna() & other.isna())
    assert both.all(), f"{name}: {one[~both].iloc[0]!r} and {other[~both].iloc[0]!r}"


def main():
    folder = pathlib.Path(sys.argv[1])
    csv, parquet = (str(folder / name) for name in ("runs.csv", "runs.parquet"))
    table, lines = pandas.read_parquet(parquet), pandas.read_csv(csv)
    assert list(table.columns) == list(lines.columns)
    for name in table.columns:
        same(table[name], lines[name], name)
    file = pyarrow.parquet.ParquetFile(parquet)
    assert file.metadata.num_rows == len(table) > 0
    for read in (f"read_csv('{csv}')", f"'{parquet}'"):
        [(count, total)] = duckdb.sql(f"select count(*), sum(value) from {read}").fetchall()
        assert count == len(table) and abs(total / table["value"].sum() - 1) < 1e-12, read

    records = json.loads((folder / "runs.json").read_text())
    assert sorted(table["key"].unique()) == sorted(record["key"] for record in records)
    numbers = 0
    for record in records:
        rows = table[table["key"] == record["key"]]
        done = record["outcome"].get("done", {"quantities": [], "values": []})
        for quantity, values in zip(done.get("quantities", []), done["values"]):
            given = rows[rows["quantity"] == quantity["name"]]["value"]
            assert list(given) == values, f"{record['key']}: {quantity['name']}"
            numbers += len(values)
    assert numbers > 0
    print(f"{len(table)} rows of {len(records)} runs, {numbers} numbers of quantities, are the same")


main()
