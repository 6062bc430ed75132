#pragma once
// The Python program that io/usd.cpp runs: `python3 -c SCRIPT FILE PRIM` prints a mesh as OBJ.

namespace taut {

extern const char* const usd_script;

}  // namespace taut
