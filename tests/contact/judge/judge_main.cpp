// judge [--solid-from K] FILE.obj...: how many pairs of triangles without a common vertex intersect
// in each. A file is one surface; pairs of triangles on its vertices K, K + 1, ... (counted from 0)
// are solids' own business. Exit code 0 where none do, 1 where some do, 2 where a file cannot be
// judged.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>

#include "contact/independent_judge.h"
#include "taut/io/obj.h"

int main(int argc, char** argv) try {
  const bool has_solids = argc > 2 && std::strcmp(argv[1], "--solid-from") == 0;
  const int first_file = has_solids ? 3 : 1;
  if (argc <= first_file) {
    std::fprintf(stderr, "usage: judge [--solid-from VERTEX] FILE.obj...\n");
    return 2;
  }
  if (!taut::test::judge_available()) {
    std::fprintf(stderr, "judge: %s\n", taut::test::no_judge);
    return 2;
  }
  bool clean = true;
  for (int k = first_file; k < argc; ++k) {
    const taut::TriangleMesh mesh = taut::read_obj(argv[k]);
    std::vector<std::uint8_t> is_solid;
    if (has_solids) {
      is_solid.resize(mesh.positions.size());
      for (std::size_t v = std::strtoul(argv[2], nullptr, 10); v < is_solid.size(); ++v)
        is_solid[v] = 1;
    }
    const auto pairs = taut::test::intersecting_triangles(mesh.positions, mesh.triangles, is_solid);
    std::printf("%s: %zu intersecting pairs of %zu triangles\n", argv[k], pairs.size(),
                mesh.triangles.size());
    for (std::size_t p = 0; p < pairs.size() && p < 5; ++p)
      std::printf("  triangles %d and %d\n", pairs[p][0] + 1, pairs[p][1] + 1);
    clean &= pairs.empty();
  }
  return clean ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "judge: %s\n", error.what());
  return 2;
}
