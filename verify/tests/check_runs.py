#!/usr/bin/env python3
"""Reads the tables of `mtled runs export` by pandas and DuckDB without options and compares
them with each other and with the records. Usage: check_runs.py FOLDER, which has runs.csv and
runs.json, the output of `mtled runs list --format json`."""

import json
import pathlib
import sys

import duckdb
import pandas


def main():
    folder = pathlib.Path(sys.argv[1])
    csv = str(folder / "runs.csv")
    table = pandas.read_csv(csv)
    query = f"select count(*), sum(value) from read_csv('{csv}')"
    [(count, total)] = duckdb.sql(query).fetchall()
    assert count == len(table) > 0 and abs(total / table["value"].sum() - 1) < 1e-12

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
