#!/usr/bin/env python3
"""Checks that every path of the repository that the documents name exists.

Looked at are README.md, CONTRIBUTING.md, docs/**/*.md and gallery/**/*.md, outside of their code blocks; a path is a
word that begins with one of the repository's folders.
"""

import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
PATH = re.compile(r"(?<![\w/.-])((?:src|library|gallery|tests|docs|scripts|include|cmake|bench)/[\w./-]*[\w/])")
LINK = re.compile(r"\]\(([^)#:]+)\)")


def missing_in(document):
    """Paths named in one document that do not exist."""
    inside = False
    for number, line in enumerate(document.read_text().splitlines(), 1):
        if line.startswith("```"):
            inside = not inside
        if inside or line.startswith("    "):
            continue
        for match in PATH.finditer(line):
            if not (ROOT / match.group(1)).exists():
                yield f"{document.relative_to(ROOT)}:{number}: {match.group(1)} does not exist"
        for match in LINK.finditer(line):
            if not (document.parent / match.group(1)).exists():
                yield f"{document.relative_to(ROOT)}:{number}: the link {match.group(1)} leads nowhere"


def main():
    documents = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *ROOT.glob("docs/**/*.md"), *ROOT.glob("gallery/**/*.md")]
    missing = [line for document in documents for line in missing_in(document)]
    for line in missing:
        print(line)
    print(f"check_docs: {len(documents)} documents, {len(missing)} missing paths")
    return 1 if missing else 0


if __name__ == "__main__":
    sys.exit(main())
