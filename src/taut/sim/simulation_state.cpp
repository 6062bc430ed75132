#include "taut/sim/simulation_state.h"

#include "taut/base/checksum.h"
#include "taut/sim/archive.h"

namespace taut {

namespace {

constexpr std::string_view snapshot_magic = "TAUTSNP1";

template <class Archive, class P>
void transfer_pose(Archive& a, P& pose) {
  for (int k = 0; k < 4; ++k) a.value(pose.rotation.coeffs()[k]);
  a.value(pose.translation);
}

template <class Archive, class K>
void transfer_key_frame(Archive& a, K& key) {
  a.value(key.time);
  transfer_pose(a, key.pose);
}

template <class Archive, class S>
void transfer_solid(Archive& a, S& solid) {
  a.list(solid.name);
  a.value(solid.shape);
  a.value(solid.radius), a.value(solid.height), a.value(solid.size);
  a.value(solid.friction), a.value(solid.thickness);
  a.each(solid.key_frames, [](auto& to, auto& key) { transfer_key_frame(to, key); });
  transfer_pose(a, solid.initial);
  a.value(solid.velocity), a.value(solid.angular_velocity);
}

template <class Archive, class P>
void transfer_pin(Archive& a, P& pin) {
  a.list(pin.nodes);
  a.list(pin.start);
  a.each(pin.carrier.key_frames, [](auto& to, auto& key) { transfer_key_frame(to, key); });
  a.value(pin.pivot), a.value(pin.release), a.value(pin.held);
  a.list(pin.from), a.list(pin.to);
  a.value(pin.t0), a.value(pin.t1), a.value(pin.awaits_step);
}

template <class Archive, class M>
void transfer_material(Archive& a, M& m) {
  a.value(m.k_stretch), a.value(m.k_shear), a.value(m.k_bend);
  a.value(m.k_damp_stretch), a.value(m.k_damp_shear), a.value(m.k_damp_bend);
  a.value(m.bend_cap), a.value(m.compression), a.value(m.bend_model);
}

// The one list of what a snapshot holds, for both directions.
template <class Archive, class Content>
void transfer(Archive& a, Content& c) {
  a.value(c.world);
  a.value(c.clock.steps), a.value(c.clock.origin), a.value(c.clock.since_origin);
  a.value(c.clock.h), a.value(c.clock.longest);
  a.value(c.state.time), a.value(c.state.has_previous);
  for (auto* field : {&c.state.x, &c.state.v, &c.state.x_prev, &c.state.v_prev, &c.state.last})
    a.list(*field);
  a.list(c.contacts.node), a.list(c.contacts.solid);
  a.list(c.contacts.sticking), a.list(c.contacts.normal_force);
  a.list(c.solver_memory);
  a.list(c.surface_contact.zones.node), a.list(c.surface_contact.zones.rides);
  a.list(c.surface_contact.forces);
  a.value(c.gravity);
  a.value(c.wind.velocity), a.value(c.wind.gust), a.value(c.wind.gust_frequency);
  a.list(c.applied);
  a.each(c.materials, [](auto& to, auto& m) { transfer_material(to, m); });
  a.each(c.pins, [](auto& to, auto& pin) { transfer_pin(to, pin); });
  a.each(c.solids, [](auto& to, auto& solid) { transfer_solid(to, solid); });
  a.each(c.solid_targets, [](auto& to, auto& pose) { transfer_pose(to, pose); });
  a.list(c.awaits_step);
  a.each(c.deformations,
         [](auto& to, auto& d) { to.list(d.from), to.list(d.to), to.value(d.t0), to.value(d.t1); });
  a.each(c.shape_targets, [](auto& to, auto& shape) { to.list(shape); });
}

std::uint64_t sum_of_bytes(std::string_view bytes) {
  Checksum sum;
  sum.add(bytes);
  return sum.value();
}

}  // namespace

std::string to_bytes(const SimulationState& state) {
  ArchiveWriter writer;
  for (const char c : snapshot_magic) writer.value(c);
  transfer(writer, state);
  writer.value(sum_of_bytes(writer.bytes()));
  return writer.bytes();
}

SimulationState state_from(std::string_view bytes, const std::string& name) {
  constexpr std::size_t sum_size = sizeof(std::uint64_t);
  const ArchiveReader damaged({}, name);
  if (bytes.size() < snapshot_magic.size() + sum_size || !bytes.starts_with(snapshot_magic))
    damaged.fail();
  const std::string_view content = bytes.substr(0, bytes.size() - sum_size);
  std::uint64_t sum = 0;
  std::memcpy(&sum, bytes.data() + content.size(), sum_size);
  if (sum != sum_of_bytes(content)) damaged.fail();
  ArchiveReader reader(content.substr(snapshot_magic.size()), name);
  SimulationState state;
  transfer(reader, state);
  if (!reader.at_end()) reader.fail();
  return state;
}

}  // namespace taut
