#pragma once
// Lists made by many threads, the same for any number of them.
//
//   collect(n, chunk, body, lists...)   body(begin, end, parts...) over fixed chunks of [0, n);
//                                       what it puts into its parts, one for each of the lists, is
//                                       appended to the lists in the order of the chunks

#include <algorithm>
#include <tuple>
#include <vector>

#include "taut/base/parallel.h"

namespace taut {

template <class Body, class... Item>
void collect(Index n, Index chunk, Body&& body, std::vector<Item>&... lists) {
  const Index chunks = n / chunk + (n % chunk != 0);
  std::vector<std::tuple<std::vector<Item>...>> parts(static_cast<std::size_t>(chunks));
  parallel_for(chunks, 1, [&](Index begin, Index end) {
    for (Index c = begin; c < end; ++c) {
      const Index first = c * chunk, last = first + std::min(chunk, n - first);
      std::apply([&](auto&... part) { body(first, last, part...); },
                 parts[static_cast<std::size_t>(c)]);
    }
  });
  for (const auto& of_chunk : parts)
    std::apply(
        [&](const auto&... part) { (lists.insert(lists.end(), part.begin(), part.end()), ...); },
        of_chunk);
}

}  // namespace taut
