#pragma once
// What touches each node at the end of the last step, as the simulation has it (not measured
// afterwards): one byte a node, bits
//
//   1  a solid     the node is in the set of contacts that the step was solved with
//                  (contact/solid_contact.h), or a solid, analytic or a mesh, pushed it when the
//                  positions were corrected
//   2  cloth       another part of the cloth, or another cloth, pushed it (contact/cloth_contact.h)
//   4  held        it moved as one rigid body with its neighbours, because nothing else kept them
//                  apart (contact/rigid_zones.h)
//
// 0 before the first step. The same bytes for any number of threads, and after a resume.

#include "taut/sim/simulation.h"

namespace taut {

inline constexpr std::uint8_t touches_solid = 1, touches_cloth = 2, held_in_zone = 4;

std::vector<std::uint8_t> node_contact(const Simulation& simulation);

}  // namespace taut
