#!/usr/bin/env python3
"""Shows that check_architecture.py finds each kind of mistake: one is planted in a copy of the real tree, and must be named by file and line.

check_architecture_test.py ROOT
"""
import shutil
import sys
import tempfile
import unittest
from pathlib import Path

sys.dont_write_bytecode = True
from check_architecture import MAX_LINES, SOURCE_FOLDERS, Checker, Room, read_rooms  # noqa: E402

ROOT = Path(sys.argv.pop())


class PlantedMistakes(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.root = Path(self.folder.name)
        for name in SOURCE_FOLDERS:
            if (ROOT / name).is_dir():
                shutil.copytree(ROOT / name, self.root / name)
        for name in ("CMakeLists.txt", "CMakePresets.json"):
            shutil.copy(ROOT / name, self.root / name)
        self.before = set(Checker(self.root).run())

    def tearDown(self):
        self.folder.cleanup()

    def append(self, file, text):
        """Adds a line at the end of a file (made if missing); returns its place as FILE:LINE."""
        path = self.root / file
        path.parent.mkdir(parents=True, exist_ok=True)
        old = path.read_text() if path.exists() else ""
        path.write_text(old + text + "\n")
        return f"{file}:{len(old.splitlines()) + 1}"

    def expect(self, place, *words):
        new = [b for b in Checker(self.root).run() if b not in self.before]
        self.assertTrue(any(b.startswith(place + ": ") and all(w in b for w in words) for b in new), f"{place} {words} not among {new}")

    def test_upward_include(self):
        self.expect(self.append("src/taut/base/types.h", '#include "taut/mesh/grid.h"'), "room base", "may include only these rooms: none")

    def test_include_of_a_room_beside(self):
        self.append("src/taut/step/beside.h", "#pragma once")
        self.expect(self.append("src/taut/contact/beside.cpp", '  #  include "taut/step/beside.h"'), "room contact", "only these rooms: base")

    def test_room_includes_what_stands_above(self):
        for library in ("taut_cholmod", "taut_pardiso"):
            self.append(f"src/{library}/{library}/above.h", "#pragma once")
            self.expect(self.append(f"src/taut/solve/above_{library}.cpp", f'#include "{library}/above.h"'), "stands above all rooms")

    def test_public_header_includes_a_private_library(self):
        self.expect(self.append("src/taut/picture/image.h", "#include <cairo.h>"), "a public header includes <cairo.h>")

    def test_public_header_includes_a_private_header(self):
        rooms = self.root / "src/taut/CMakeLists.txt"
        rooms.write_text(rooms.read_text().replace("taut_room(base ", "taut_room(base PRIVATE_HEADERS inner.h "))
        self.append("src/taut/base/inner.h", "#pragma once\n#include <cairo.h>")
        self.expect(self.append("src/taut/base/types.h", '#include "taut/base/inner.h"'), "which is private and not installed")

    def test_circular_include_within_a_room(self):
        self.append("src/taut/base/one.h", '#pragma once\n#include "taut/base/two.h"')
        self.append("src/taut/base/two.h", '#pragma once\n#include "taut/base/one.h"')
        self.expect("src/taut/base/two.h:2", "circular include", "one.h -> src/taut/base/two.h -> src/taut/base/one.h")

    def test_include_not_written_from_src(self):
        self.expect(self.append("src/taut/mesh/bare.cpp", '#include "grid.h"'), 'no file of this project is called "grid.h"')

    def test_room_list_that_looks_upwards(self):
        file = self.root / "src/taut/CMakeLists.txt"
        file.write_text("taut_room(ground ROOMS base)\n" + file.read_text())
        self.expect("src/taut/CMakeLists.txt:1", "room ground names base", "downwards only")

    def test_undeclared_room(self):
        self.append("src/taut/utils/all.h", "#pragma once")
        self.expect("src/taut/CMakeLists.txt:1", "src/taut/utils is not declared")

    def test_long_file(self):
        self.append("src/taut/base/long.cpp", "\n" * MAX_LINES)
        self.expect(f"src/taut/base/long.cpp:{MAX_LINES + 1}", f"{MAX_LINES + 1} lines")

    def test_header_without_pragma_once(self):
        self.append("src/taut/base/open.h", "// no guard")
        self.expect("src/taut/base/open.h:1", "#pragma once")

    def test_tests_without_a_room(self):
        self.append("tests/misc/some_test.cpp", "")
        self.expect("tests/misc:1", "mirrors a room")

    def test_native_instructions(self):
        self.expect(self.append("cmake/TautCompiler.cmake", "add_compile_options(-march=native)"), "no -march=native")

    def test_room_lists_are_read_with_their_line_breaks_and_keywords(self):
        (self.root / "rooms.txt").write_text(
            "taut_room(base LIBRARIES fmt::fmt)\n# taut_room(old)\ntaut_room(mesh ROOMS base\n  PRIVATE_LIBRARIES a b\n  PRIVATE_HEADERS c.h)\n")
        self.assertEqual(read_rooms(self.root / "rooms.txt"),
                         {"base": Room(1, set(), set()), "mesh": Room(3, {"base"}, {"taut/mesh/c.h"})})


if __name__ == "__main__":
    unittest.main()
