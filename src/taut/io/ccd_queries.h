#pragma once
// Files of continuous-collision queries, in the form of the data sets of Wang et
// al. 2021 (contact/ccd.h).
//
//   eight rows a query    x y z of its corners: four at t = 0, then the same four at t = 1
//   a row                 x_num,x_den,y_num,y_den,z_num,z_den[,truth]
//   x_num, x_den          x = x_num / x_den, m, divided as doubles: exact where x is a double and
//                         x_den a power of two
//   vf                    a vertex p, then its triangle's a, b, c
//   ee                    two edges: a, b, then c, d
//   truth                 1 where the two meet, else 0; the same in all rows of a query, and in all
//                         queries or in none
//
// Numbers are decimal with any number of digits. Empty lines are passed over. gzip is unpacked.

#include <array>
#include <filesystem>
#include <optional>
#include <vector>

#include "taut/base/types.h"

namespace taut {

struct CcdQuery {
  std::array<Vec3, 4> start, end;
  std::optional<bool> truth;
};

// Throws InputError naming file, line and column for a row with too few or too many columns, what
// is not a finite number, a denominator of 0, a truth that is neither 0 nor 1 or differs within a
// query, and rows that are not a multiple of eight or none at all.
std::vector<CcdQuery> read_ccd_queries(const std::filesystem::path& path);

}  // namespace taut
