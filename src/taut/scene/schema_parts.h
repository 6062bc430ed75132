#pragma once
// The pieces that describe(SchemaVisitor&, Scene&) is made of, beside those of sim/describe.h.

#include "taut/scene/scene.h"
#include "taut/scene/schema.h"
#include "taut/sim/describe.h"

namespace taut {

void describe_cloth(SchemaVisitor& v, Cloth& cloth);
void describe_solid(SchemaVisitor& v, SolidEntry& solid);

}  // namespace taut
