#include "taut/linalg/parallelogram.h"

namespace taut {

std::vector<Parallelogram> parallelograms(const BlockPattern& pattern,
                                          std::span<const std::uint8_t> sides,
                                          std::span<const std::uint8_t> kept) {
  std::vector<Parallelogram> result;
  for (Index a = 0; a < pattern.rows(); ++a)
    for (Index k = pattern.diagonal[a] + 1; k < pattern.row_start[a + 1]; ++k) {
      if (kept[k]) continue;
      const Index c = pattern.column[k];
      Index common[2] = {-1, -1}, count = 0;
      Index other = pattern.row_start[c];
      for (Index e = pattern.row_start[a]; e < pattern.row_start[a + 1] && count <= 2; ++e) {
        const Index j = pattern.column[e];
        if (!sides[e] || j == a || j == c) continue;
        while (other < pattern.row_start[c + 1] && pattern.column[other] < j) ++other;
        if (other == pattern.row_start[c + 1]) break;
        if (pattern.column[other] != j || !sides[other]) continue;
        if (count < 2) common[count] = j;
        ++count;
      }
      if (count != 2) continue;
      const Index diagonal = pattern.find(common[0], common[1]);
      if (diagonal >= 0 && kept[diagonal] && !sides[diagonal])
        result.push_back({a, common[0], c, common[1], k, pattern.find(c, a)});
    }
  return result;
}

}  // namespace taut
