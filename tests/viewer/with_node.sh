#!/bin/sh
# with_node.sh FOLDER COMMAND...: runs the command there; ends with 77, which ctest takes for skipped, where Node or its packages are missing.
skip() {
  echo "skipped: $*"
  exit 77
}
cd "$1" || exit 1
shift
command -v node >/dev/null && command -v npm >/dev/null || skip "there is no Node.js here"
[ "$(node -p 'parseInt(process.versions.node)')" -ge 18 ] || skip "Node.js is older than 18: $(node --version)"
[ -d node_modules/esbuild ] || skip "the packages of viewer/ are not installed: npm ci there, or ./taut view"
exec "$@"
