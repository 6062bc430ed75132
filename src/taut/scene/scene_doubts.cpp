#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "taut/io/obj.h"
#include "taut/scene/cloth_shape.h"
#include "taut/scene/doubts.h"
#include "taut/scene/scene_file.h"
#include "taut/solve/solver_registry.h"

namespace taut {

namespace {

void doubt_time(Doubts& d) {
  const double h = d.scene.time.step;
  if (h > 1.0 / 30)
    d.add(
        "time.step = {} s is longer than a picture of a film lasts: motion will look damped and "
        "contacts late; 1e-3 to 1e-2 is usual",
        h);
}

void doubt_wind(Doubts& d) {
  const auto moved = [](const Cloth& cloth) { return cloth.drag > 0 || cloth.wind_pressure > 0; };
  if (d.scene.wind.velocity.norm() > 0 &&
      std::none_of(d.scene.cloths.begin(), d.scene.cloths.end(), moved))
    d.add("the wind moves nothing: give a cloth wind_pressure (0.4 suits light fabric) or drag");
}

void doubt_fall(Doubts& d, const Cloth& cloth) {
  if (cloth.pins.empty() && d.scene.solids.empty() && d.scene.gravity.norm() > 0)
    d.add(
        "cloth '{}' is not pinned and there is no solid to fall on: it will fall for ever; add a "
        "[[cloth.pin]] or a [[solid]]",
        cloth.name);
}

void doubt_mass(Doubts& d, const Cloth& cloth, const ClothEstimate& e) {
  const double density = e.mass / e.area;
  if (density >= 0.05 && density <= 1.0) return;
  const char* key = cloth.node_mass > 0 ? "node_mass" : "density";
  const double ratio = (density < 0.05 ? 0.05 : 1.0) / density;
  d.add(
      "cloth '{}' weighs {:.3g} kg/m², {} than fabrics do (0.05 to 1): for a real one set {} = "
      "{:.2g} or so",
      cloth.name, density, density < 0.05 ? "less" : "more", key,
      ratio * (cloth.node_mass > 0 ? cloth.node_mass : density));
}

void doubt_stability(Doubts& d, const Cloth& cloth, const ClothEstimate& e) {
  const double h = d.scene.time.step;
  if (d.scene.time.integrator != IntegratorKind::imex || h < e.explicit_step()) return;
  d.add(
      "cloth '{}': IMEX takes shear and bend springs explicitly, which is unstable on slack cloth "
      "from time.step = {:.3g} s on "
      "(h² k_shear / m = {:.3g}; here {} s): take a smaller step, a lower k_shear and k_bend, or "
      "time.integrator = \"imex_adaptive\"",
      cloth.name, e.explicit_step(), h * h * cloth.material.k_shear / e.node_mass, h);
}

void doubt_bdf2(Doubts& d, const Cloth& cloth) {
  if (d.scene.time.integrator != IntegratorKind::bdf2 ||
      cloth.material.compression != Compression::none)
    return;
  d.add(
      "cloth '{}': BDF2 extrapolates from two steps, and springs that go slack or taut between "
      "them can make it gain energy: take "
      "compression = \"linear\", or time.integrator = \"semi_implicit_euler\"",
      cloth.name);
}

void doubt_core(Doubts& d, const Cloth& cloth, const ClothEstimate& e) {
  constexpr double many = 30;
  // IMEX's matrix has the springs of the core only.
  const std::string& solver = d.scene.solver.name;
  if (!solver_traits(solver).bounds_iterations || d.scene.solver.chooses_core() ||
      d.scene.time.integrator == IntegratorKind::imex)
    return;
  const double iterations = e.core_iterations(d.scene.time, d.scene.solver.tolerance);
  if (iterations <= many) return;
  d.add(
      "cloth '{}': shear and bend springs are strong for its mass and the time step (ρ = {:.3g}), "
      "so {} may take up to {:.0f} "
      "iterations a step: take a smaller time.step, lower k_shear and k_bend, or solver.core = "
      "\"auto\"",
      cloth.name, e.rho(d.scene.time), solver, iterations);
}

void doubt_stretch(Doubts& d, const Cloth& cloth, const ClothEstimate& e) {
  if (cloth.pins.empty() || !cloth.is_grid()) return;
  // The topmost spring of a hanging column of n nodes carries all of them.
  const double n = std::max(cloth.grid.nu, cloth.grid.nv);
  if (!(cloth.material.k_stretch > 0)) {
    d.add(
        "cloth '{}' has k_stretch = {}: nothing keeps it together and it will flow from its pins; "
        "set k_stretch = {:.2g} or higher",
        cloth.name, cloth.material.k_stretch,
        std::max(1.0, n * e.node_mass * d.scene.gravity.norm() / (0.01 * e.spacing)));
    return;
  }
  const double strain =
      n * e.node_mass * d.scene.gravity.norm() / (cloth.material.k_stretch * e.spacing);
  if (strain > 0.1)
    d.add(
        "cloth '{}' will hang like rubber: under its own weight springs stretch by {:.0f} % and "
        "more; set k_stretch = {:.2g} or higher",
        cloth.name, 100 * strain, cloth.material.k_stretch * strain / 0.01);
}

void doubt_jitter(Doubts& d, const Cloth& cloth, const ClothEstimate& e) {
  if (cloth.jitter > 0.25 * e.spacing)
    d.add(
        "cloth '{}': jitter = {} m moves neighbours {:.3g} m apart through one another: set it "
        "below {:.2g}",
        cloth.name, cloth.jitter, e.spacing, 0.1 * e.spacing);
}

void doubt_layers(Doubts& d, const Cloth& cloth, const ClothEstimate& e) {
  const double thickness = d.scene.contact.thickness;
  if (d.scene.contact.self && thickness > 0.5 * e.spacing)
    d.add(
        "contact.thickness = {} m is more than half of an edge of cloth '{}': it will push its own "
        "neighbours apart; set it below {:.1g}",
        thickness, cloth.name, 0.5 * e.spacing);
  for (const ContactPair& pair : d.scene.contact.pairs)
    if (d.scene.contact.self && pair.cloth == cloth.name && pair.with == cloth.name &&
        pair.thickness > 0.5 * e.spacing)
      d.add(
          "contact.pair: thickness = {} m of cloth '{}' with itself is more than half of one of "
          "its edges: it will push its own neighbours "
          "apart; set it below {:.1g}",
          pair.thickness, cloth.name, 0.5 * e.spacing);
}

void doubt_start(Doubts& d, const Cloth& cloth, const TriangleMesh& shape, const Solid& solid) {
  if (solid.shape == SolidShape::mesh || (d.scene.contact.untangle && d.scene.contact.self)) return;
  const std::vector<bool> pinned = pinned_at_start(cloth, shape.positions.size());
  std::size_t inside = 0;
  double deepest = 0.0;
  for (std::size_t i = 0; i < pinned.size(); ++i) {
    const double depth = pinned[i] ? 0.0 : depth_inside(solid, shape.positions[i], 0.0);
    if (depth > d.scene.contact.touch_tolerance) ++inside;
    deepest = std::max(deepest, depth);
  }
  if (inside > 0)
    d.add(
        "{} of the {} nodes of cloth '{}' start inside solid '{}', up to {:.3g} m deep, and will "
        "be thrown out: move one of the two, or "
        "let --untangle do it",
        inside, shape.positions.size(), cloth.name, solid.name, deepest);
}

// Nodes stay outside, but a right triangle with legs a between three of them reaches a²/(4 r) into
// a ball of radius r.
void doubt_thickness(Doubts& d, const Cloth& cloth, const ClothEstimate& e, const Solid& solid) {
  if (solid.shape != SolidShape::sphere && solid.shape != SolidShape::cylinder) return;
  const double cut = e.spacing * e.spacing / (4 * solid.radius);
  if (solid.thickness < cut)
    d.add(
        "solid '{}' will show through cloth '{}': triangles cut {:.2g} m into it; set thickness = "
        "{:.1g} or more, or use finer cloth",
        solid.name, cloth.name, cut, 1.5 * cut);
}

// A garment is a metre or so; what is this much longer was made in other units.
bool doubt_units(Doubts& d, const Cloth& cloth, const TriangleMesh& shape) {
  constexpr double centimetres = 20.0, millimetres = 300.0;
  Eigen::AlignedBox3d box;
  for (const Vec3& x : shape.positions) box.extend(x);
  const double size = box.sizes().maxCoeff();
  if (!cloth.from_file || size <= centimetres) return false;
  const bool small = size > millimetres;
  d.add(
      "cloth '{}' is {:.3g} m long: the lengths in {} may not be metres; if they are {}, set scale "
      "= {:g}",
      cloth.name, size, cloth.mesh.filename().string(), small ? "millimetres" : "centimetres",
      (small ? 1e-3 : 1e-2) * cloth.scale);
  return true;
}

// Seams and other things that some programs write into an OBJ, and that Taut does not read.
void doubt_statements(Doubts& d, const std::filesystem::path& mesh, const std::string& prim) {
  if (!prim.empty() || mesh.extension() != ".obj") return;
  std::vector<std::string> notes;
  read_obj(mesh.is_absolute() ? mesh : d.scene.folder / mesh, &notes);
  for (const std::string& note : notes)
    if (note.find("is not OBJ") != std::string::npos)
      d.add("{}: what they say has no effect", note);
}

double smallest_extent(const Solid& solid) {
  if (solid.shape == SolidShape::sphere) return 2 * solid.radius;
  if (solid.shape == SolidShape::cylinder) return std::min(2 * solid.radius, solid.height);
  return solid.shape == SolidShape::box ? solid.size.minCoeff() : INFINITY;
}

double top_speed(const Solid& solid) {
  if (solid.key_frames.empty()) return solid.velocity.norm();
  double speed = 0.0;
  for (std::size_t i = 1; i < solid.key_frames.size(); ++i) {
    const KeyFrame &a = solid.key_frames[i - 1], &b = solid.key_frames[i];
    speed = std::max(speed, (b.pose.translation - a.pose.translation).norm() / (b.time - a.time));
  }
  return speed;
}

void doubt_speed(Doubts& d, const Solid& solid) {
  const double way = top_speed(solid) * d.scene.time.step, allowed = 0.5 * smallest_extent(solid);
  if (way > allowed)
    d.add(
        "solid '{}' moves {:.3g} m in a time step and may jump over cloth: make it slower or set "
        "time.step = {:.1g} or less",
        solid.name, way, d.scene.time.step * allowed / way);
}

}  // namespace

std::vector<std::string> doubtful(const Scene& scene) {
  Doubts d{scene, {}};
  doubt_time(d);
  doubt_wind(d);
  for (const Solid& solid : scene.solids) doubt_speed(d, solid);
  for (const Cloth& cloth : scene.cloths) {
    const TriangleMesh shape = start_shape(cloth, d.scene.folder);
    const ClothEstimate e = estimate(cloth, shape);
    const bool other_units = doubt_units(d, cloth, shape);
    if (cloth.from_file) doubt_statements(d, cloth.mesh, cloth.prim);
    doubt_pins(d, cloth, shape, e);
    doubt_fall(d, cloth);
    doubt_mass(d, cloth, e);
    doubt_stability(d, cloth, e);
    doubt_bdf2(d, cloth);
    doubt_core(d, cloth, e);
    doubt_stretch(d, cloth, e);
    doubt_jitter(d, cloth, e);
    doubt_layers(d, cloth, e);
    for (const Solid& solid : scene.solids) {
      doubt_start(d, cloth, shape, solid);
      if (!other_units) doubt_thickness(d, cloth, e, solid);
    }
  }
  return d.found;
}

}  // namespace taut
