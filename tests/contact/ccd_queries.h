#pragma once
// The queries of ../shared/data/ccd/unit-tests: eight rows `num,den` x 3 and the true answer.

#include <array>
#include <filesystem>
#include <vector>

#include "taut/base/types.h"

namespace taut::test {

struct CcdQuery {
  std::array<Vec3, 8> corners;  // four at the start, then four at the end
  bool hits = false;
};

std::vector<CcdQuery> read_ccd_queries(const std::filesystem::path& file);

}  // namespace taut::test
