// judge FILE.obj...: how many pairs of triangles without a common vertex intersect in each. All files are one surface each, no solids.
// Exit code 0 where none do, 1 where some do, 2 where a file cannot be judged.
#include <cstdio>
#include <exception>

#include "contact/independent_judge.h"
#include "taut/io/obj.h"

int main(int argc, char** argv) try {
  if (argc < 2) {
    std::fprintf(stderr, "usage: judge FILE.obj...\n");
    return 2;
  }
  bool clean = true;
  for (int k = 1; k < argc; ++k) {
    const taut::TriangleMesh mesh = taut::read_obj(argv[k]);
    const auto pairs = taut::test::intersecting_triangles(mesh.positions, mesh.triangles);
    std::printf("%s: %zu intersecting pairs of %zu triangles\n", argv[k], pairs.size(), mesh.triangles.size());
    for (std::size_t p = 0; p < pairs.size() && p < 5; ++p) std::printf("  triangles %d and %d\n", pairs[p][0] + 1, pairs[p][1] + 1);
    clean &= pairs.empty();
  }
  return clean ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "judge: %s\n", error.what());
  return 2;
}
