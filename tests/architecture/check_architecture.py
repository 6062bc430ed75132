#!/usr/bin/env python3
"""Checks the rules that the source tree keeps.

check_architecture.py ROOT prints each breach as FILE:LINE: rule, and ends with 1 if there is any.

The rooms, what each may include and which of its headers are private are read from the
taut_room(NAME ROOMS ... PRIVATE_HEADERS ...) lines of src/taut/CMakeLists.txt. Other folders of
src, and apps, stand above all rooms: they may include any room, no room may include them.
check_prose.py has the rules about what people read.
"""
import re
import sys
import typing
from pathlib import Path

sys.dont_write_bytecode = True
import check_prose  # noqa: E402

MAX_LINES = 500
SOURCES = {".h", ".cpp", ".py", ".cmake"}
SOURCE_FOLDERS = ["src", "apps", "tests", "bench", "tools", "python", "cmake"]
# Folders of tests that test the whole project; each other one mirrors a room, a folder of src or a
# program of apps.
PROJECT_TESTS = {"apps", "architecture", "install", "viewer"}
INCLUDE = re.compile(r'^\s*#\s*include\s*(["<])([^">]+)[">]')
# Libraries that a program which uses Taut's headers must have too. The C++ library's own headers
# have neither a dot nor a slash.
PUBLIC_LIBRARIES = ("Eigen/", "fmt/", "tbb/")


class Room(typing.NamedTuple):
    line: int  # where it is declared
    may_include: set
    private_headers: set


def read_lines(path):
    return path.read_text(encoding="utf-8").splitlines()


def read_rooms(cmake_file):
    """The declared rooms, in order: name -> Room."""
    text = re.sub(r"#.*", "", cmake_file.read_text(encoding="utf-8"))
    rooms = {}
    for match in re.finditer(r"taut_room\(([^)]*)\)", text):
        name, *words = match.group(1).split()
        room = Room(text.count("\n", 0, match.start()) + 1, set(), set())
        keyword = None
        for word in words:
            if word in ("ROOMS", "LIBRARIES", "PRIVATE_LIBRARIES", "PRIVATE_HEADERS"):
                keyword = word
            elif keyword == "ROOMS":
                room.may_include.add(word)
            elif keyword == "PRIVATE_HEADERS":
                room.private_headers.add(f"taut/{name}/{word}")
        rooms[name] = room
    return rooms


class Checker:
    def __init__(self, root):
        self.root = Path(root)
        self.rooms_file = self.root / "src/taut/CMakeLists.txt"
        self.rooms = read_rooms(self.rooms_file)
        self.private_headers = set().union(*(room.private_headers for room in self.rooms.values()))
        self.breaches = []

    def report(self, path, line, rule):
        self.breaches.append(f"{path.relative_to(self.root)}:{line}: {rule}")

    def files(self, folder, *suffixes):
        return sorted(p for p in (self.root / folder).rglob("*")
                      if p.suffix in suffixes and p.is_file())

    def check_room_lists(self):
        if not self.rooms:
            self.report(self.rooms_file, 1, "no taut_room(...) found: the rooms are declared here")
        above = set(self.rooms)
        for name, room in self.rooms.items():
            for other in sorted(room.may_include & above):
                self.report(self.rooms_file, room.line,
                            f"room {name} names {other}, which is not declared above it: "
                            "rooms look downwards only")
            for other in sorted(room.may_include - set(self.rooms)):
                self.report(self.rooms_file, room.line,
                            f"room {name} names {other}, which is no room")
            for header in sorted(room.private_headers):
                if not (self.root / "src" / header).is_file():
                    self.report(self.rooms_file, room.line,
                                f"{header} is named a private header, but there is no such file")
            above.discard(name)
        for folder in sorted(p for p in (self.root / "src/taut").iterdir() if p.is_dir()):
            if folder.name not in self.rooms:
                self.report(self.rooms_file, 1,
                            f"src/taut/{folder.name} is not declared here with taut_room(...)")

    def check_rooms_page(self):
        """The table of docs/architecture.md has a row for each room."""
        page = self.root / "docs/architecture.md"
        text = page.read_text(encoding="utf-8") if page.is_file() else ""
        for name in self.rooms:
            if f"\n| `{name}` | " not in text:
                self.report(page, 1, f"the table of rooms has no row for {name}")

    def find(self, path, target):
        """The project's file that an include names, or None.

        A program may write its own files from its own folder; a room writes all from src.
        """
        folders = [self.root / "src" / name for name in ("", "taut_cholmod", "taut_pardiso")]
        if self.room_of(path) is None:
            program = self.root.joinpath(*path.relative_to(self.root).parts[:2])
            folders += [path.parent, program]
        return next((f / target for f in folders if (f / target).is_file()), None)

    def room_of(self, path):
        parts = path.relative_to(self.root).parts
        return parts[2] if parts[:2] == ("src", "taut") and len(parts) > 3 else None

    def check_include(self, path, line, target):
        """Checks the include of one of our own files; returns that file, or None."""
        found = self.find(path, target)
        if found is None:
            self.report(path, line, f'no file of this project is called "{target}": '
                        'write includes from src, as "taut/ROOM/FILE.h"')
            return None
        room, other = self.room_of(path), self.room_of(found)
        if room in self.rooms and other is None:
            self.report(path, line,
                        f'room {room} includes "{target}", which stands above all rooms')
        elif room in self.rooms and other not in self.rooms[room].may_include | {room}:
            names = " ".join(sorted(self.rooms[room].may_include)) or "none"
            self.report(path, line, f'room {room} includes "{target}", but may include only these '
                        f"rooms: {names} (src/taut/CMakeLists.txt)")
        if self.is_public(path) and target in self.private_headers:
            self.report(path, line, f'a public header includes "{target}", which is private and '
                        "not installed (src/taut/CMakeLists.txt)")
        return found

    def is_public(self, path):
        if path.suffix != ".h" or self.room_of(path) is None:
            return False
        return str(path.relative_to(self.root / "src")) not in self.private_headers

    def check_library_include(self, path, line, target):
        is_library = re.search(r"[./]", target) and not target.startswith(PUBLIC_LIBRARIES)
        if self.is_public(path) and is_library:
            self.report(path, line, f"a public header includes <{target}>; only headers of "
                        f"{', '.join(PUBLIC_LIBRARIES)} may be. Keep it in a source file, or name "
                        "this header under PRIVATE_HEADERS in src/taut/CMakeLists.txt")

    def check_includes(self):
        graph = {}
        for folder in ("src", "apps"):
            for path in self.files(folder, ".h", ".cpp"):
                edges = graph.setdefault(path, [])
                for number, text in enumerate(read_lines(path), 1):
                    match = INCLUDE.match(text)
                    if match and match.group(1) == "<":
                        self.check_library_include(path, number, match.group(2))
                    elif match:
                        found = self.check_include(path, number, match.group(2))
                        edges += [(number, found)] if found else []
        self.check_circles(graph)

    def check_circles(self, graph):
        done, trail = set(), []

        def visit(path):
            trail.append(path)
            for line, found in graph.get(path, []):
                if found in trail:
                    circle = trail[trail.index(found):] + [found]
                    names = " -> ".join(str(p.relative_to(self.root)) for p in circle)
                    self.report(path, line, f"circular include: {names}")
                elif found not in done:
                    visit(found)
            trail.pop()
            done.add(path)

        for path in graph:
            if path not in done:
                visit(path)

    def check_files(self):
        for folder in SOURCE_FOLDERS:
            for path in self.files(folder, *SOURCES):
                lines = read_lines(path)
                if len(lines) > MAX_LINES:
                    self.report(path, MAX_LINES + 1,
                                f"{len(lines)} lines: a source file has at most {MAX_LINES}")
                if path.suffix == ".h" and "#pragma once" not in lines:
                    self.report(path, 1, "a header begins with #pragma once")

    def check_tests_mirror_rooms(self):
        known = set(self.rooms) | PROJECT_TESTS
        for parent in ("src", "apps"):
            if (self.root / parent).is_dir():
                known |= {p.name for p in (self.root / parent).iterdir() if p.is_dir()}
        for folder in sorted(p for p in (self.root / "tests").iterdir() if p.is_dir()):
            if folder.name not in known:
                self.report(folder, 1, "a folder of tests mirrors a room of src/taut or a folder "
                            "of src or apps")

    def check_portable_build(self):
        """Instruction sets are chosen at run time (base/simd.h): a binary starts on any machine."""
        build_files = [self.root / "CMakeLists.txt", self.root / "CMakePresets.json"]
        for folder in SOURCE_FOLDERS:
            build_files += [p for p in self.files(folder, ".txt", ".cmake")]
        for path in build_files:
            for number, text in enumerate(read_lines(path) if path.is_file() else [], 1):
                if re.search(r"-m(arch|cpu)=native", text):
                    self.report(path, number, "no -march=native: instruction sets are chosen at "
                                "run time (base/simd.h)")

    def check_prose(self):
        """What people read: width, headers' openings, and names of files."""
        paths = self.files("docs", ".md") + sorted(self.root.glob("*.md"))
        for folder in SOURCE_FOLDERS:
            paths += self.files(folder, *SOURCES, ".inl", ".md")
        project_files = check_prose.ProjectFiles(self.root)
        for path in paths:
            text = path.read_text(encoding="utf-8")
            lines = text.split("\n")
            name = path.relative_to(self.root).as_posix()
            found = check_prose.long_lines(path.suffix, text)
            found += check_prose.missing_files(path.suffix, lines, path.parent, project_files)
            if path.suffix == ".h" and name.startswith(("src/", "apps/")):
                found += check_prose.long_opening(lines)
            for line, rule in found:
                self.report(path, line, rule)

    def run(self):
        self.check_room_lists()
        self.check_rooms_page()
        self.check_includes()
        self.check_files()
        self.check_tests_mirror_rooms()
        self.check_portable_build()
        self.check_prose()
        return self.breaches


def main():
    if len(sys.argv) != 2 or not (Path(sys.argv[1]) / "src/taut/CMakeLists.txt").is_file():
        print("usage: check_architecture.py ROOT, where ROOT/src/taut/CMakeLists.txt declares the "
              "rooms", file=sys.stderr)
        return 2
    breaches = Checker(sys.argv[1]).run()
    for breach in breaches:
        print(breach)
    return 1 if breaches else 0


if __name__ == "__main__":
    sys.exit(main())
