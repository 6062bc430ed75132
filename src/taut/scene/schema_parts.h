#pragma once
// The pieces that describe(SchemaVisitor&, Scene&) is made of.

#include "taut/scene/scene.h"
#include "taut/scene/schema.h"

namespace taut {

void describe_cloth(SchemaVisitor& v, Cloth& cloth);
void describe_solid(SchemaVisitor& v, Solid& solid);
void describe_contact(SchemaVisitor& v, ContactOptions& contact);
// Once all names are known.
void check_pairs(SchemaVisitor& v, const Scene& scene);
// translation and rotation.
void describe_pose(SchemaVisitor& v, Pose& pose, bool applies, const char* only_for);
void describe_key_frames(SchemaVisitor& v, std::vector<KeyFrame>& frames, const char* doc);

}  // namespace taut
