#!/usr/bin/env python3
"""Builds the guide as a folder of HTML pages that need no network.

usage: build.py FOLDER

The pages are those of src/SUMMARY.md, anywhere in the repository. Links between them become
links between pages; other files of the repository that a page names are copied beside them.
A link to nothing ends the build.
"""

import html
import os
import re
import shutil
import sys
from pathlib import Path
from urllib.parse import unquote

from pages import GUIDE, ROOT, contents, options_of, reader

CAPTIONS = {"file": "{}", "exit": "exit code {}", "not-run": "not run by the tests: {}"}


def anchor(text, taken):
    """The anchor of a heading, as on GitHub."""
    slug = re.sub(r"[^\w\- ]", "", text.strip().lower()).replace(" ", "-")
    count = taken.get(slug, -1) + 1
    taken[slug] = count
    return f"{slug}-{count}" if count else slug


def plain(token):
    """The text of a heading without its marks."""
    return "".join(child.content for child in token.children if child.type in ("text", "code_inline"))


class Site:
    def __init__(self, out):
        self.out = out
        self.parts = contents()
        self.pages = [page for part in self.parts for page in part.pages]
        self.by_source = {page.source: page for page in self.pages}
        self.missing = []

    def target(self, page, link):
        """Where a link of a page leads in the site."""
        path, mark, fragment = link.partition("#")
        if not path or re.match(r"[a-z]+:", link):
            return link
        source = (page.source.parent / unquote(path)).resolve()
        if source in self.by_source:
            return f"{self.by_source[source].name}.html{mark}{fragment}"
        if not source.is_file() or ROOT not in source.parents:
            self.missing.append(f"{page.source.relative_to(ROOT)}: no file {link}")
            return link
        copy = Path("files") / source.relative_to(ROOT)
        (self.out / copy).parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(source, self.out / copy)
        return f"{copy.as_posix()}{mark}{fragment}"

    def fence(self, renderer, tokens, index, options, env):
        token = tokens[index]
        language, found = options_of(token.info)
        notes = [CAPTIONS[key].format(value) for key, value in found.items() if key in CAPTIONS]
        caption = f"<figcaption>{html.escape('; '.join(notes))}</figcaption>" if notes else ""
        code = html.escape(token.content)
        if language == "sh":
            code = re.sub(r"(?m)((?:^|\s)#.*)$", r"<i>\1</i>", code)
        return (f'<figure class="code">{caption}<pre tabindex="0"><code class="language-{language}">'
                f"{code}</code></pre></figure>\n")

    def body(self, page):
        """A page as HTML, and its sections for the contents."""
        markdown, taken, sections = reader(), {}, []
        markdown.renderer.rules["fence"] = lambda *a: self.fence(markdown.renderer, *a)
        markdown.renderer.rules["table_open"] = lambda *a: '<div class="table" tabindex="0"><table>\n'
        markdown.renderer.rules["table_close"] = lambda *a: "</table></div>\n"
        tokens = markdown.parse(page.source.read_text(encoding="utf-8"))
        for index, token in enumerate(tokens):
            if token.type == "heading_open":
                text = plain(tokens[index + 1])
                token.attrSet("id", anchor(text, taken))
                if token.tag == "h2":
                    sections.append((text, token.attrGet("id")))
            for child in token.children or []:
                if child.type in ("link_open", "image"):
                    key = "href" if child.type == "link_open" else "src"
                    child.attrSet(key, self.target(page, child.attrGet(key)))
                elif child.type == "html_inline" and not child.content.startswith("<!--"):
                    self.missing.append(f"{page.source}: {child.content} is read as HTML")
        return markdown.renderer.render(tokens, markdown.options, {}), sections

    def navigation(self, here, sections):
        lines = []
        for part in self.parts:
            if part.title and part.pages:
                lines.append(f"<h2>{html.escape(part.title)}</h2>")
            lines.append("<ul>")
            for page in part.pages:
                current = ' aria-current="page"' if page is here else ""
                lines.append(f'<li><a href="{page.name}.html"{current}>{html.escape(page.title)}</a>')
                if page is here and 1 < len(sections) <= 30:
                    links = (f'<li><a href="#{i}">{html.escape(t)}</a></li>' for t, i in sections)
                    lines.append(f"<ul>{''.join(links)}</ul>")
                lines.append("</li>")
            lines.append("</ul>")
        return "\n".join(lines)

    def write(self):
        template = (GUIDE / "page.html").read_text(encoding="utf-8")
        for number, page in enumerate(self.pages):
            body, sections = self.body(page)
            around = [(self.pages[number + step] if 0 <= number + step < len(self.pages) else None, word)
                      for step, word in ((-1, "Before"), (1, "Next"))]
            steps = "".join(f'<a href="{other.name}.html">{word}: {html.escape(other.title)}</a>'
                            for other, word in around if other)
            text = template
            for key, value in (("title", html.escape(page.title)), ("steps", steps), ("body", body),
                               ("navigation", self.navigation(page, sections))):
                text = text.replace("{{" + key + "}}", value)
            (self.out / f"{page.name}.html").write_text(text, encoding="utf-8")
        shutil.copyfile(GUIDE / "style.css", self.out / "style.css")


def main():
    out = Path(sys.argv[1]).resolve()
    os.makedirs(out, exist_ok=True)
    site = Site(out)
    site.write()
    for line in site.missing:
        print(line, file=sys.stderr)
    print(f"{len(site.pages)} pages in {out}")
    return 1 if site.missing else 0


if __name__ == "__main__":
    sys.exit(main())
