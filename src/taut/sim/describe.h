#pragma once
// The declarations of everything that can be set in a World or a Simulation: meaning, unit, range.
// scene/ makes scene files of them, sim/validator.h judges values that a program has set.

#include "taut/contact/contact_options.h"
#include "taut/contact/solid.h"
#include "taut/element/external.h"
#include "taut/element/spring_material.h"
#include "taut/sim/schema.h"
#include "taut/sim/simulation_options.h"

namespace taut {

// What a cloth is made of and how it starts, besides its shape.
struct ClothValues {
  double &node_mass, &density;
  SpringMaterial& material;
  double &drag, &wind_pressure;
  Vec3& velocity;
  // its nodes' masses are given one by one, and neither node_mass nor density
  bool has_masses = false;
};
void describe_cloth_name(SchemaVisitor& v, std::string& name);
void describe_cloth_values(SchemaVisitor& v, ClothValues cloth);

void describe_solid_shape(SchemaVisitor& v, Solid& solid);
// Friction, thickness, motion.
void describe_solid_motion(SchemaVisitor& v, Solid& solid);
// translation and rotation.
void describe_pose(SchemaVisitor& v, Pose& pose, bool applies, const char* only_for);
void describe_key_frames(SchemaVisitor& v, std::vector<KeyFrame>& frames, const char* doc);
// pivot, release, key_frames of a pin.
void describe_pin_path(SchemaVisitor& v, Vec3& pivot, double& release,
                       std::vector<KeyFrame>& frames);

void describe_contact(SchemaVisitor& v, ContactOptions& contact);
// Once all names are known.
void check_pairs(SchemaVisitor& v, std::span<const ContactPair> pairs,
                 std::span<const std::string> cloths, std::span<const std::string> solids);
// Two of the same name would overwrite each other's files.
void check_names(SchemaVisitor& v, const char* key, std::span<const std::string> names);

void describe_gravity(SchemaVisitor& v, Vec3& gravity);
void describe_wind(SchemaVisitor& v, WindOptions& wind);
void describe_solver(SchemaVisitor& v, SolverOptions& solver);
void describe_step(SchemaVisitor& v, double& step);
void describe_integration(SchemaVisitor& v, IntegratorKind& integrator, NewtonOptions& newton,
                          double& overshoot_limit, int& max_halvings);

}  // namespace taut
