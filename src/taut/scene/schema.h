#pragma once
// The scene format, made of the declarations of sim/describe.h and of what only a file has: shapes
// by their parameters, files, names of nodes. A new key is one line in a describe function: reader,
// writer and reference page follow.

#include "taut/sim/schema.h"

namespace taut {

struct Scene;

void describe(SchemaVisitor& v, Scene& scene);

}  // namespace taut
