#!/usr/bin/env python3
"""Follows every link of the built guide: pages, files and anchors must be there, and nothing that
a page shows may come from the network.

usage: check_links.py FOLDER
"""

import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote

SHOWN = {"img": "src", "script": "src", "link": "href", "iframe": "src", "source": "src"}


class Links(HTMLParser):
    def __init__(self):
        super().__init__()
        self.anchors, self.followed, self.shown = set(), [], []

    def handle_starttag(self, tag, attributes):
        found = dict(attributes)
        if "id" in found:
            if found["id"] in self.anchors:
                self.followed.append(f"two anchors {found['id']}")
            self.anchors.add(found["id"])
        if tag == "a" and "href" in found:
            self.followed.append(found["href"])
        elif tag in SHOWN and SHOWN[tag] in found:
            self.shown.append(found[SHOWN[tag]])


def main():
    folder = Path(sys.argv[1]).resolve()
    pages = {}
    for path in sorted(folder.glob("*.html")):
        pages[path] = Links()
        pages[path].feed(path.read_text(encoding="utf-8"))
    dead, followed, outside = [], 0, set()
    for path, links in pages.items():
        for link in links.shown:
            if "//" in link:
                dead.append(f"{path.name}: {link} comes from the network")
        for link in links.followed + links.shown:
            if link.startswith(("https:", "http:", "mailto:")):
                outside.add(link)
                continue
            followed += 1
            name, _, fragment = link.partition("#")
            target = (path.parent / unquote(name)).resolve() if name else path
            if not target.is_file():
                dead.append(f"{path.name}: no file {link}")
            elif fragment and target.suffix == ".html" and unquote(fragment) not in pages[target].anchors:
                dead.append(f"{path.name}: no anchor {link}")
    for line in dead:
        print(line, file=sys.stderr)
    print(f"{len(pages)} pages, {followed} links within the guide, {len(dead)} dead; "
          f"{len(outside)} addresses outside of it were not visited")
    return 1 if dead or not pages else 0


if __name__ == "__main__":
    sys.exit(main())
