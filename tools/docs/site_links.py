# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Follow every link inside the built site: `python -m tools.docs.site_links docs/_build/html`."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import dataclass, field
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit


@dataclass
class Page:
    """Names that can be jumped to, and what the page refers to."""

    names: set[str] = field(default_factory=set)
    targets: list[str] = field(default_factory=list)


class _Reader(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.page = Page()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Collect names and references."""
        for key, value in attrs:
            if key == "id" and value:
                self.page.names.add(value)
            elif key in ("href", "src") and value:
                self.page.targets.append(value)


def read_page(file: Path) -> Page:
    """The names and references of a page."""
    reader = _Reader()
    reader.feed(file.read_text("utf-8"))
    return reader.page


@dataclass
class Report:
    """Links that were followed, those that lead nowhere, and those that leave the site."""

    followed: int = 0
    broken: list[str] = field(default_factory=list)
    outside: set[str] = field(default_factory=set)


def _problem(site: Path, file: Path, target: str, pages: dict[Path, Page]) -> str | None:
    parts = urlsplit(target)
    path = (file.parent / unquote(parts.path)).resolve() if parts.path else file
    if path.is_dir():
        path = path / "index.html"
    if not path.is_file() or not path.is_relative_to(site):
        return "no such file"
    if parts.fragment and path in pages and unquote(parts.fragment) not in pages[path].names:
        return "no such place on the page"
    return None


def check_site(site: Path) -> Report:
    """Every reference of every page."""
    site = site.resolve()
    pages = {file: read_page(file) for file in sorted(site.rglob("*.html"))}
    report = Report()
    for file, page in pages.items():
        for target in _inside(page, report):
            report.followed += 1
            problem = _problem(site, file, target, pages)
            if problem:
                report.broken.append(f"{file.relative_to(site)}: {target}: {problem}")
    return report


def _inside(page: Page, report: Report) -> Iterator[str]:
    for target in page.targets:
        scheme = urlsplit(target).scheme
        if scheme in ("http", "https"):
            report.outside.add(target)
        elif not scheme and target != "#":
            yield target


def main(folder: str) -> int:
    """Print what is broken; 1 when something is."""
    report = check_site(Path(folder))
    for line in report.broken:
        print(line)
    print(f"{report.followed} links followed, {len(report.outside)} lead outside")
    return 1 if report.broken else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
