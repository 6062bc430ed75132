#!/bin/sh
# Sources compiled for a newer instruction set than the rest may define nothing that the linker could take for the generic code: no weak symbols (inline
# functions, templates), only the tables that they are there for.
#   kernel_symbols.sh NM OBJECT...
nm=$1
shift
for object; do
  bad=$("$nm" -C --defined-only "$object" | grep -v -E ' [rtbd] | [DR] taut::kernels_')
  if [ -n "$bad" ]; then
    echo "$object defines more than kernel tables:"
    echo "$bad"
    exit 1
  fi
done
[ $# -gt 0 ] || { echo "no object was given"; exit 1; }
