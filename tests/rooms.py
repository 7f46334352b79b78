# SPDX-License-Identifier: MIT
"""That every folder of host/ includes only what docs/architecture.md's table of rooms says that it
may know. Prints what is not so.

usage: rooms.py ROOT
"""
import pathlib
import re
import sys


def table(text):
    """What each room may include, by the rows of the table: the last column's names in `code`."""
    rooms = {}
    for folder, knows in re.findall(r"^\| `host/(\w+)/` \|.*\| ([^|]*) \|$", text, re.MULTILINE):
        rooms[folder] = {name.rstrip("/") for name in re.findall(r"`([^`]*)`", knows)}
    return rooms


def main():
    root = pathlib.Path(sys.argv[1])
    rooms = table((root / "docs/architecture.md").read_text())
    faults = [f"docs/architecture.md: no row for host/{folder.name}/"
              for folder in (root / "host").iterdir()
              if folder.is_dir() and folder.name not in rooms]
    for room, knows in rooms.items():
        for path in sorted((root / "host" / room).rglob("*.[ch]pp")):
            for number, line in enumerate(path.read_text().splitlines(), 1):
                included = re.match(r'#include "(\w+)/', line)
                if included and included[1] not in knows | {room}:
                    faults.append(f"{path.relative_to(root)}:{number}: host/{room}/ may not know "
                                  f"{included[1]}/")
    print("\n".join(faults))
    sys.exit(1 if faults or len(rooms) < 10 else 0)


if __name__ == "__main__":
    main()
