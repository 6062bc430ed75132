#!/usr/bin/env bash
# What ./taut builds, and when it lets the program start at once: in a folder that has only the
# launcher, with stand-ins for the program, CMake, ninja and dpkg that note down that they were asked.
#   launcher_test.sh LAUNCHER WORK
set -euo pipefail
launcher=$1 work=$2

rm -rf "$work"
mkdir -p "$work"/{src,apps,cmake,tools,bin,build/release/apps/taut}
cp "$launcher" "$work/taut"
touch "$work"/{src/a.cpp,tools/packages.txt,CMakeLists.txt,CMakePresets.json}
stand_in() { # FILE COMMANDS
  printf '#!/bin/sh\n%s\n' "$2" >"$1"
  chmod +x "$1"
}
stand_in "$work/bin/cmake" "echo cmake \$* >>'$work/asked'; touch '$work/build/release/build.ninja'"
stand_in "$work/bin/ninja" "echo ninja \$* >>'$work/asked'; [ ! -f '$work/broken' ]"
stand_in "$work/bin/dpkg-query" ":"
stand_in "$work/build/release/apps/taut/taut" 'echo "ran $*"'
export PATH=$work/bin:$PATH
unset TAUT_BUILD

expect() { # ASKED ARGUMENT ...   what was built, as a pattern, before the program ran with these
  local asked=$1 out
  shift
  rm -f "$work/asked"
  touch "$work/asked"
  out=$("$work/taut" "$@" 2>"$work/err") || true
  # shellcheck disable=SC2053
  if [[ $(cat "$work/asked") != $asked || $out != "$ran" ]]; then
    printf 'taut %s: expected to ask for "%s" and print "%s", but asked for "%s" and printed "%s"\n' \
      "$*" "$asked" "$ran" "$(cat "$work/asked")" "$out"
    cat "$work/err"
    exit 1
  fi
}

ran='ran run --help' && expect '' run --help
ran='ran --help' && expect '' --help
ran='ran ' && expect ''
ran='ran run a.toml' && expect 'cmake*-DTAUT_UNITY=ON*ninja*taut_app' run a.toml
exec 9>"$work/build/.lock"
flock 9 # from here on, another launcher builds
ran='ran run a.toml' && expect '' run a.toml
ran='ran check b.toml' && expect '' check b.toml
exec 9>&-
touch -d '+1 minute' "$work/src/b.cpp"
ran='ran run --help' && expect '' run --help
ran='ran run a.toml' && expect 'ninja*taut_app' run a.toml
touch "$work/broken"
ran='' && expect 'ninja*taut_app' run a.toml
