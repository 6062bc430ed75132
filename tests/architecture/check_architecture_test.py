#!/usr/bin/env python3
"""Shows that check_architecture.py finds each kind of mistake.

One is planted in a copy of the real tree, and must be named by file and line.

    check_architecture_test.py ROOT
"""
import shutil
import sys
import tempfile
import unittest
from pathlib import Path

sys.dont_write_bytecode = True
import check_prose  # noqa: E402
from check_architecture import MAX_LINES, SOURCE_FOLDERS, Checker, Room, read_rooms  # noqa: E402

ROOT = Path(sys.argv.pop())


class PlantedMistakes(unittest.TestCase):
    before = []  # what the real tree is guilty of: found once, the same for all tests

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.root = Path(self.folder.name)
        for name in SOURCE_FOLDERS:
            if (ROOT / name).is_dir():
                shutil.copytree(ROOT / name, self.root / name)
        for name in ("docs", "scenes"):
            shutil.copytree(ROOT / name, self.root / name, ignore=shutil.ignore_patterns("*.png"))
        for name in ("CMakeLists.txt", "CMakePresets.json", "README.md", "CONTRIBUTING.md"):
            shutil.copy(ROOT / name, self.root / name)
        if not PlantedMistakes.before:
            PlantedMistakes.before = [set(Checker(self.root).run())]

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
        new = [b for b in Checker(self.root).run() if b not in self.before[0]]
        found = any(b.startswith(place + ": ") and all(w in b for w in words) for b in new)
        self.assertTrue(found, f"{place} {words} not among {new}")

    def expect_silence(self):
        new = [b for b in Checker(self.root).run() if b not in self.before[0]]
        self.assertEqual(new, [])

    def test_upward_include(self):
        place = self.append("src/taut/base/types.h", '#include "taut/mesh/grid.h"')
        self.expect(place, "room base", "may include only these rooms: none")

    def test_include_of_a_room_beside(self):
        self.append("src/taut/step/beside.h", "#pragma once")
        place = self.append("src/taut/contact/beside.cpp", '  #  include "taut/step/beside.h"')
        self.expect(place, "room contact", "only these rooms: base")

    def test_room_includes_what_stands_above(self):
        for library in ("taut_cholmod", "taut_pardiso"):
            self.append(f"src/{library}/{library}/above.h", "#pragma once")
            place = self.append(f"src/taut/solve/above_{library}.cpp",
                                f'#include "{library}/above.h"')
            self.expect(place, "stands above all rooms")

    def test_public_header_includes_a_private_library(self):
        place = self.append("src/taut/picture/image.h", "#include <cairo.h>")
        self.expect(place, "a public header includes <cairo.h>")

    def test_public_header_includes_a_private_header(self):
        rooms = self.root / "src/taut/CMakeLists.txt"
        rooms.write_text(rooms.read_text().replace("taut_room(base ",
                                                   "taut_room(base PRIVATE_HEADERS inner.h "))
        self.append("src/taut/base/inner.h", "#pragma once\n#include <cairo.h>")
        place = self.append("src/taut/base/types.h", '#include "taut/base/inner.h"')
        self.expect(place, "which is private and not installed")

    def test_circular_include_within_a_room(self):
        self.append("src/taut/base/one.h", '#pragma once\n#include "taut/base/two.h"')
        self.append("src/taut/base/two.h", '#pragma once\n#include "taut/base/one.h"')
        self.expect("src/taut/base/two.h:2", "circular include",
                    "one.h -> src/taut/base/two.h -> src/taut/base/one.h")

    def test_include_not_written_from_src(self):
        self.expect(self.append("src/taut/mesh/bare.cpp", '#include "grid.h"'),
                    'no file of this project is called "grid.h"')

    def test_room_list_that_looks_upwards(self):
        file = self.root / "src/taut/CMakeLists.txt"
        file.write_text("taut_room(ground ROOMS base)\n" + file.read_text())
        self.expect("src/taut/CMakeLists.txt:1", "room ground names base", "downwards only")

    def test_undeclared_room(self):
        self.append("src/taut/utils/all.h", "#pragma once")
        self.expect("src/taut/CMakeLists.txt:1", "src/taut/utils is not declared")

    def test_room_that_the_page_leaves_out(self):
        page = self.root / "docs/architecture.md"
        page.write_text(page.read_text().replace("| `mesh` |", "| `meshes` |"))
        self.expect("docs/architecture.md:1", "no row for mesh")

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
        place = self.append("cmake/TautCompiler.cmake", "add_compile_options(-march=native)")
        self.expect(place, "no -march=native")

    def test_room_lists_are_read_with_their_line_breaks_and_keywords(self):
        (self.root / "rooms.txt").write_text(
            "taut_room(base LIBRARIES fmt::fmt)\n# taut_room(old)\ntaut_room(mesh ROOMS base\n"
            "  PRIVATE_LIBRARIES a b\n  PRIVATE_HEADERS c.h)\n")
        expected = {"base": Room(1, set(), set()), "mesh": Room(3, {"base"}, {"taut/mesh/c.h"})}
        self.assertEqual(read_rooms(self.root / "rooms.txt"), expected)

    def test_long_line(self):
        for name in ("src/taut/base/wide.cpp", "tests/base/wide.py", "cmake/wide.cmake"):
            self.append(name, "# " + "x" * 98)
            self.expect(self.append(name, "# " + "x" * 99), "101 columns")

    def test_columns_are_characters(self):
        self.append("src/taut/base/greek.cpp", "// " + "ρ" * 97)
        self.expect_silence()

    def test_only_what_is_in_a_raw_string_may_be_long(self):
        self.append("src/taut/base/raw.cpp", 'auto a = R"(' + "x" * 200 + "\n" + "y" * 200 + ')";')
        self.expect_silence()
        place = self.append("src/taut/base/raw.cpp", 'f(R"(x)", "' + "y" * 100 + '");')
        self.expect(place, "columns")

    def test_long_paragraph(self):
        self.expect(self.append("docs/wide.md", "word " * 21), "105 columns")

    def test_tables_code_and_links_may_be_long(self):
        long = "word " * 30
        self.append("docs/wide.md", f"| a | {long} |\n\n    {long}\n\n```\n{long}\n```\n")
        self.append("docs/wide.md", f"- [solvers](solvers.md#{'x' * 100})")
        self.expect_silence()

    def test_generated_pages_may_be_wide(self):
        self.append("docs/wide.md", "# Title\n\n<!-- Generated by a program. -->\n" + "word " * 30)
        self.expect_silence()

    def test_long_continued_item_of_a_list(self):
        self.append("docs/wide.md", "- item\n    " + "word " * 25)
        self.expect("docs/wide.md:2", "columns")

    def test_long_opening(self):
        contract = "#pragma once\n" + "// line\n" * 15
        self.append("src/taut/base/essay.h", contract)
        self.expect_silence()
        self.append("src/taut/mesh/essay.h", contract + "//")
        self.expect("src/taut/mesh/essay.h:17", "the opening comment has 16 lines")

    def test_names_of_files_that_are_gone(self):
        for text in ("// see force/external.h", "x = 1;  // see docs/nowhere.md", "// of gone.cpp"):
            place = self.append("src/taut/base/names.cpp", text)
            self.expect(place, text.split()[-1], "no such file")
        self.expect(self.append("docs/names.md", "Look at `force/external.h`."), "force/external.h")
        self.expect(self.append("docs/names.md", "Run scenes/nothing.toml."), "scenes/nothing.toml")
        self.expect(self.append("tools/names.py", "# see tools/gone.py"), "tools/gone.py")

    def test_links_that_lead_nowhere(self):
        place = self.append("docs/links.md", "[here](architecture.md), [there](gone.md)")
        self.expect(place, "links to gone.md")

    def test_names_that_are_right(self):
        self.append("src/taut/base/names.cpp",
                    "// base/types.h, types.h, taut/base/types.h, docs/mathematics.md, README.md\n"
                    "// room/NAME.h, https://example.org/a.md, NAME.cpp\n"
                    'const char* name = "no/such.h";')
        self.append("docs/names.md", "[core](architecture.md#rooms) [web](https://a.org/b.md)")
        self.expect_silence()


if __name__ == "__main__":
    unittest.main()
