#include <fmt/format.h>

#include <array>

#include "taut/scene/schema_parts.h"

namespace taut {

namespace {

constexpr std::array up_names{"z", "y"};
constexpr std::array corner_names{"u0v0", "u1v0", "u0v1", "u1v1"};
constexpr std::array edge_names{"u0", "u1", "v0", "v1"};

// 12 springs a node: beyond this a spring's index no longer fits.
constexpr Index max_nodes = 100'000'000;

void describe_grid(SchemaVisitor& v, GridShape& grid) {
  std::vector<Index> nodes{grid.nu, grid.nv};
  v.integers("nodes", nodes,
             {.doc = "number of nodes along u and along v",
              .min = 2,
              .max = 20000,
              .required = true,
              .count = 2});
  grid.nu = nodes[0], grid.nv = nodes[1];
  v.check(Offset{grid.nu} * grid.nv <= max_nodes, "nodes",
          "more than 100 million nodes: use fewer");
  v.vector("origin", grid.origin, {.doc = "corner u0v0", .unit = "m", .min = -1e6, .max = 1e6});
  v.vector("u", grid.u,
           {.doc = "the edge from corner u0v0 to u1v0",
            .unit = "m",
            .min = -1e6,
            .max = 1e6,
            .required = true});
  v.vector("v", grid.v,
           {.doc = "the edge from corner u0v0 to u0v1",
            .unit = "m",
            .min = -1e6,
            .max = 1e6,
            .required = true});
  v.check(grid.u.cross(grid.v).norm() > 1e-9 * grid.u.norm() * grid.v.norm(), "v",
          "u and v span no area: give two edges that are not zero and not parallel");
}

void describe_tube(SchemaVisitor& v, TubeShape& tube) {
  std::vector<Index> nodes{tube.around, tube.along};
  v.integers("nodes", nodes,
             {.doc = "number of nodes around and along the axis",
              .min = 2,
              .max = 20000,
              .required = true,
              .count = 2});
  tube.around = nodes[0], tube.along = nodes[1];
  v.check(tube.around >= 3, "nodes", "a tube has at least 3 nodes around");
  v.number("radius", tube.radius,
           {.doc = "of the tube",
            .unit = "m",
            .min = 0,
            .max = 1e6,
            .above_min = true,
            .required = true});
  v.number("height", tube.height,
           {.doc = "along the axis",
            .unit = "m",
            .min = 0,
            .max = 1e6,
            .above_min = true,
            .required = true});
}

void describe_shape(SchemaVisitor& v, Cloth& cloth) {
  const bool file = cloth.from_file = v.given("mesh", cloth.from_file);
  const bool tube = cloth.is_tube = v.given("tube", cloth.is_tube);
  v.exactly_one(std::array{"grid", "tube", "mesh"});
  v.table("grid",
          {.doc = "A rectangular sheet: node (i, j) stands at origin + i/(nu-1) u + j/(nv-1) v and "
                  "has the index j nu + i. Springs as Provot's.",
           .unset = file || tube},
          [&] { describe_grid(v, cloth.grid); });
  v.table("tube",
          {.doc = "A closed tube around the z axis, centred: node (i, j) is number i around and j "
                  "along, its index j times the nodes around plus i. "
                  "Springs as of a mesh.",
           .unset = !tube},
          [&] { describe_tube(v, cloth.tube); });
  constexpr const char* mesh_only = "a cloth with mesh";
  constexpr const char* placed_only =
      "a cloth with tube or mesh (a grid is placed by its origin, u and v)";
  v.file("mesh", cloth.mesh,
         {.doc = "OBJ, PLY or USD file, relative to the scene file; stretch springs on edges, bend "
                 "springs across them",
          .unset = !file});
  v.text("prim", cloth.prim,
         {.doc = "which mesh of a USD file, by its path (`/World/Shirt`); not needed where there "
                 "is only one",
          .unset = cloth.prim.empty(),
          .applies = file,
          .only_for = mesh_only});
  v.number("scale", cloth.scale,
           {.doc = "of the file's lengths: 0.01 for centimetres",
            .min = 1e-6,
            .max = 1e6,
            .applies = file,
            .only_for = mesh_only});
  int up = cloth.y_up ? 1 : 0;
  v.choose("up", up, up_names,
           {.doc = "the file's upward axis; `y` is turned to Taut's z",
            .applies = file,
            .only_for = mesh_only});
  cloth.y_up = up == 1;
  describe_pose(v, cloth.placement, file || tube, placed_only);
}

void check_nodes(SchemaVisitor& v, const Cloth& cloth, const std::vector<Index>& nodes) {
  const Index count = cloth.grid.node_count();
  for (const Index node : nodes)
    v.check(!cloth.is_grid() || node < count, "nodes",
            "node " + std::to_string(node) + " is not on the grid: its " +
                std::to_string(cloth.grid.nu) + " x " + std::to_string(cloth.grid.nv) +
                " nodes are numbered 0 to " + std::to_string(count - 1));
}

void describe_pin(SchemaVisitor& v, const Cloth& cloth, Pin& pin) {
  v.exactly_one(std::array{"nodes", "corners", "edges"});
  v.integers("nodes", pin.where.nodes,
             {.doc = "by index, from 0", .min = 0, .unset = pin.where.nodes.empty()});
  check_nodes(v, cloth, pin.where.nodes);
  constexpr const char* grid_only = "a cloth with grid (on a mesh or a tube pin nodes by index)";
  constexpr const char* edges_only = "a cloth with grid or tube (on a mesh pin nodes by index)";
  v.choose_some(
      "corners", pin.where.corners, corner_names,
      {.doc =
           "of the grid: u0v0 is node (0, 0), u1v0 is (nu-1, 0), u0v1 is (0, nv-1), u1v1 the last",
       .unset = pin.where.corners.empty(),
       .applies = cloth.is_grid(),
       .only_for = grid_only});
  v.choose_some("edges", pin.where.edges, edge_names,
                {.doc = "all nodes on edges of the grid: i = 0 is u0, i = nu-1 is u1, j = 0 is v0, "
                        "j = nv-1 is v1; a tube has v0 and v1",
                 .unset = pin.where.edges.empty(),
                 .applies = !cloth.from_file,
                 .only_for = edges_only});
  for (const std::string& edge : pin.where.edges)
    v.check(!cloth.is_tube || edge[0] == 'v', "edges",
            "a tube has no edge '" + edge + "': write \"v0\" (below) or \"v1\" (above)");
  constexpr const char* none =
      "empty, so the pin holds nothing: name what it holds, or remove the pin";
  v.check(!v.given("nodes", false) || !pin.where.nodes.empty(), "nodes", none);
  v.check(!v.given("corners", false) || !pin.where.corners.empty(), "corners", none);
  v.check(!v.given("edges", false) || !pin.where.edges.empty(), "edges", none);
  describe_pin_path(v, pin.pivot, pin.release, pin.key_frames);
}

}  // namespace

void describe_cloth(SchemaVisitor& v, Cloth& cloth) {
  describe_cloth_name(v, cloth.name);
  describe_shape(v, cloth);
  describe_cloth_values(v, {cloth.node_mass, cloth.density, cloth.material, cloth.drag,
                            cloth.wind_pressure, cloth.velocity});
  v.number("jitter", cloth.jitter,
           {.doc = "each coordinate at the start is moved at random by up to this",
            .unit = "m",
            .min = 0,
            .max = 1});
  int seed = static_cast<int>(cloth.jitter_seed);
  v.integer("jitter_seed", seed, {.doc = "another seed, another randomness", .min = 0});
  cloth.jitter_seed = static_cast<unsigned>(seed);
  v.list("pin", cloth.pins, {.doc = "Nodes that are held or carried along a path."},
         [&](Pin& pin) { describe_pin(v, cloth, pin); });
}

}  // namespace taut
