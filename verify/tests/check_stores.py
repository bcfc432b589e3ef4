"""Two run stores have the same records but for their times, and for the checksums that cover those:
check_stores.py ONE OTHER."""

import json
import pathlib
import sys


def records(folder):
    found = {}
    for file in sorted(pathlib.Path(folder).glob("??/*.json")):
        record = json.loads(file.read_text())
        assert record.pop("timings"), f"{file} has no timings"
        assert record.pop("checksum"), f"{file} has no checksum"
        found[file.name] = json.dumps(record, sort_keys=True)
    return found


one, other = map(records, sys.argv[1:])
assert one, f"{sys.argv[1]} has no records"
assert one.keys() == other.keys(), f"{len(one.keys() ^ other.keys())} records are in one store only"
different = [name for name in one if one[name] != other[name]]
assert not different, f"{len(different)} records differ, such as {different[0]}"
print(f"{len(one)} records are the same in {sys.argv[1]} and {sys.argv[2]}")
