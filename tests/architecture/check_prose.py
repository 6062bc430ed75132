"""Rules for what people read: width of lines, length of a header's opening, names of files.

Each function returns a list of (line, rule). check_architecture.py runs them over the tree.
"""
import re

MAX_COLUMNS = 100
MAX_OPENING = 15
RAW_STRING = re.compile(r'R"([^()\s\\]{0,16})\(.*?\)\1"', re.DOTALL)
# A file of the project: words with slashes between them, and one of the endings of its sources.
FILE_NAME = re.compile(
    r"(?<![\w./<*{}-])((?:[\w-]+/)*[\w-]+\.(?:h|cpp|inl|py|cmake|md))(?![\w/*{]|\.\w)")
PLACEHOLDER = re.compile(r"(^|[_/])[A-Z]{3,}")  # a word in capitals stands for any name
SCENE_NAME = re.compile(r"(?<![\w./])(scenes/[\w-]+\.toml)")
LINK = re.compile(r"\]\(([^)#\s]+)[^)]*\)")
COMMENT = {".h": "//", ".cpp": "//", ".inl": "//", ".py": "#", ".cmake": "#"}


def is_code_block(lines):
    """For each line of a Markdown text, whether it belongs to a fenced or an indented block."""
    result, fenced, indented, in_list = [], False, False, False
    for k, line in enumerate(lines):
        fence = line.lstrip().startswith("```")
        if fence:
            fenced = not fenced
        begins = line.startswith("    ") and (k == 0 or not lines[k - 1].strip()) and not in_list
        indented = line.startswith("    ") and (indented or begins)
        if line.strip() and not line.startswith(" "):
            in_list = re.match(r"([-*]|\d+[.)]) ", line) is not None
        result.append(fenced or fence or indented)
    return result


def long_lines_of_prose(lines):
    """Markdown: tables, headings, code and what has no blank to break at may be longer.

    So may a page that a program has written, and says so.
    """
    result = []
    if any(line.startswith("<!-- Generated") for line in lines[:5]):
        return result
    for number, (line, is_code) in enumerate(zip(lines, is_code_block(lines)), 1):
        text = re.sub(r"^\s*([-*]|\d+[.)])?\s*", "", line)
        breakable = " " in text[:MAX_COLUMNS - (len(line) - len(text)) + 1]
        if not is_code and breakable and not text.startswith(("|", "#")):
            result.append((number, line))
    return result


def long_lines(suffix, text):
    """Lines of more than 100 characters. In C++ only a raw string may go on beyond that column."""
    lines = text.split("\n")
    if suffix == ".md":
        candidates = long_lines_of_prose(lines)
    else:
        candidates = list(enumerate(lines, 1))
    raw = [m.span() for m in RAW_STRING.finditer(text)] if COMMENT.get(suffix) == "//" else []
    starts = [0]
    for line in lines:
        starts.append(starts[-1] + len(line) + 1)
    result = []
    for number, line in candidates:
        border = starts[number - 1] + MAX_COLUMNS
        if len(line) > MAX_COLUMNS and not any(a < border < b for a, b in raw):
            result.append((number, f"{len(line)} columns: a line has at most {MAX_COLUMNS}"))
    return result


def long_opening(lines):
    """A header opens with a contract; what is longer belongs on a page of docs."""
    first = next((k for k, line in enumerate(lines) if line.startswith("//")), None)
    if first is None or any(line.startswith("#include") for line in lines[:first]):
        return []
    end = next((k for k in range(first, len(lines)) if not lines[k].startswith("//")), len(lines))
    if end - first <= MAX_OPENING:
        return []
    return [(first + MAX_OPENING + 1,
             f"the opening comment has {end - first} lines: a contract has at most {MAX_OPENING}, "
             "derivations and reasons go to a page of docs/design")]


def comment_of(suffix, line):
    """What a line says to people: in a source what follows the mark of a comment, else all."""
    mark = COMMENT.get(suffix)
    if mark is None:
        return line
    place = line.find(mark)
    while place >= 0:
        before = line[:place]
        is_quoted = before.count('"') % 2 or suffix == ".py" and before.count("'") % 2
        if not is_quoted and not before.endswith(":"):
            return line[place + len(mark):]
        place = line.find(mark, place + 1)
    return ""


def missing_files(suffix, lines, folder, project_files):
    """Names and links of files that are not there. `room/name.h` counts from any folder above."""
    result = []
    for number, line in enumerate(lines, 1):
        text = comment_of(suffix, line)
        if "." not in text:
            continue
        names = FILE_NAME.findall(text) + SCENE_NAME.findall(text)
        if suffix == ".md":
            linked = [n for n in LINK.findall(line) if "://" not in n]
            result += [(number, f"links to {n}, but there is no such file") for n in linked
                       if not (folder / n).exists()]
            names = [n for n in names if n not in linked]
        result += [(number, f"names {n}, but there is no such file") for n in names
                   if n not in project_files.endings and not PLACEHOLDER.search(n)]
    return result


class ProjectFiles:
    """All files under a folder but those that are built or fetched."""
    SKIPPED = {".git", "build", "out", "node_modules", "__pycache__", "dist"}

    def __init__(self, root):
        self.endings = set()
        self._collect(root, ())

    def _collect(self, folder, parts):
        for path in folder.iterdir():
            here = parts + (path.name,)
            if path.is_dir() and not path.is_symlink():
                if path.name not in self.SKIPPED:
                    self._collect(path, here)
            else:
                self.endings.update("/".join(here[k:]) for k in range(len(here)))
