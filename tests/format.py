# SPDX-License-Identifier: MIT
"""That C++ and OpenCL have the format of .clang-format, and that all lines are at most 100 columns
long, of documents and scripts, too. Prints what is not so.

usage: format.py CLANG_FORMAT ROOT
"""
import pathlib
import re
import subprocess
import sys

COLUMNS = 100
FOLDERS = ("host", "kernels", "tests", "scripts", "docs", "cmake")
FORMATTED = (".cpp", ".hpp", ".h", ".cl")
WRAPPED = (".md", ".py", ".sh", ".cmake")


def files_of(root):
    yield from (path for path in root.iterdir() if path.is_file())
    for folder in FOLDERS:
        yield from (path for path in (root / folder).rglob("*") if path.is_file())


def long_lines(path):
    """Numbers of the lines that are too long and could be broken; from 1."""
    markdown = path.suffix == ".md"
    fenced = False
    for number, line in enumerate(path.read_text().splitlines(), 1):
        fenced ^= markdown and line.lstrip().startswith("```")
        if len(line) <= COLUMNS or fenced:
            continue
        # Code, tables, headings and pictures.
        if markdown and re.match(r"    |\t|\||#|!\[", line):
            continue
        # One word, such as an address.
        if " " not in re.sub(r"^\s*(#+|//+|[-*]|\d+\.)?\s*", "", line):
            continue
        yield number


def main():
    clang_format, root = sys.argv[1], pathlib.Path(sys.argv[2])
    paths = sorted(files_of(root))
    sources = [path for path in paths if path.suffix in FORMATTED]
    texts = [path for path in paths
             if path.suffix in WRAPPED or path.name == "CMakeLists.txt"]
    if not sources or not texts:
        sys.exit(f"{root} holds nothing to check")
    failed = subprocess.run([clang_format, "--dry-run", "-Werror", *sources]).returncode != 0
    for path in sources + texts:
        for number in long_lines(path):
            print(f"{path}:{number}: more than {COLUMNS} columns")
            failed = True
    sys.exit(failed)


main()
