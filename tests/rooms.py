# SPDX-License-Identifier: MIT
"""That every folder of host/ includes only what docs/architecture.md's table of rooms says that it
may know, and that no room but those that make lights or hold their kinds asks for a kind by its
name. Prints what is not so.

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


def kinds(root):
    """Where a kind of light is compared with that has traits to ask for."""
    header = (root / "kernels/shared/light.h").read_text()
    names = re.findall(r"^    X\(\w+, (\w+), \d+, TRAIT_", header, re.MULTILINE)
    asks = re.compile(r"([!=]= *|\bcase )LIGHT_(%s)\b|HAS_(%s)\b" % (("|".join(names),) * 2))
    own = ("kernels/lights", "host/lights", "host/reference/lights", "host/scene", "host/verify")
    faults = [] if names else ["kernels/shared/light.h: no kinds of light"]
    for path in sorted([*root.glob("host/**/*.[ch]pp"), *root.glob("kernels/**/*.[ch]*")]):
        name = str(path.relative_to(root))
        if path.is_dir() or name.startswith(own):
            continue
        for number, line in enumerate(path.read_text().splitlines(), 1):
            if asks.search(line.split("//")[0]):
                faults.append(f"{name}:{number}: asks for a kind of light by its name")
    return faults


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
    faults += kinds(root)
    print("\n".join(faults))
    sys.exit(1 if faults or len(rooms) < 10 else 0)


if __name__ == "__main__":
    main()
