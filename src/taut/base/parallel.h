#pragma once
// Parallel loops and sums that give the same bits for any number of threads.
//
//   parallel_for(n, grain, f)   f(begin, end) over disjoint ranges covering [0, n); the iterations
//                               must be independent
//   ordered_sum(n, f)           sum of f(begin, end) over fixed chunks of `sum_chunk` items, added
//                               up in order: the chunks, and so the rounding, do not depend on the
//                               number of threads; f that does much for an item names smaller ones
//
// A loop of at most `grain` items runs on the calling thread. Callable from any thread; nested
// calls are allowed.

#include <algorithm>
#include <array>
#include <functional>
#include <span>
#include <vector>

#include "taut/base/types.h"

namespace taut {

// Number of threads that loops may use, at least 1. The default is the number of processors.
// Not to be called while a loop runs.
void set_thread_count(int count);
int thread_count();
// 0 ... thread_count() - 1, for the body of a loop or task: another number for each thread that
// runs one at the same time. For scratch memory; results must not depend on it.
int thread_slot();

namespace detail {
void run_parallel(Index n, Index grain, const std::function<void(Index, Index)>& body);

// Tasks that make tasks, for TaskTree (base/task_tree.h): body(t, spawn) for every t in `first` and
// every t that a body hands to spawn(t). Returns when all have run.
class Spawner {
 public:
  virtual void operator()(Index task) = 0;

 protected:
  ~Spawner() = default;
};
void run_tasks(std::span<const Index> first, const std::function<void(Index, Spawner&)>& body);
}  // namespace detail

template <class Body>
void parallel_for(Index n, Index grain, Body&& body) {
  if (n <= 0) return;
  if (n <= grain || thread_count() == 1) {
    body(Index{0}, n);
    return;
  }
  detail::run_parallel(n, grain, std::ref(body));
}

constexpr Index sum_chunk = 2048;

// T is a double or anything with += and a zero default (several sums at once: std::array wrappers
// in vector_ops).
template <class T = double, class Body>
T ordered_sum(Index n, Body&& body, Index chunk = sum_chunk, Index chunks_per_task = 4) {
  const Index chunks = (n + chunk - 1) / chunk;
  if (chunks <= 1) return n > 0 ? T(body(Index{0}, n)) : T{};
  std::vector<T> partial(static_cast<std::size_t>(chunks));
  parallel_for(chunks, chunks_per_task, [&](Index begin, Index end) {
    for (Index c = begin; c < end; ++c)
      partial[static_cast<std::size_t>(c)] = body(c * chunk, std::min(n, (c + 1) * chunk));
  });
  T total{};
  for (const T& p : partial) total += p;
  return total;
}

}  // namespace taut
