#include "taut/base/parallel.h"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <memory>
#include <stdexcept>
#include <thread>

#if defined(TAUT_THREAD_SANITIZER)
// oneTBB is not compiled with the thread sanitizer and neither is this file
// (src/taut/CMakeLists.txt): the sanitizer is told of the hand-over of work here, and sees nothing
// of how it is done. What the loops' bodies do it sees.
extern "C" void __tsan_acquire(void*);
extern "C" void __tsan_release(void*);
#define TAUT_TSAN_ACQUIRE(p) __tsan_acquire(p)
#define TAUT_TSAN_RELEASE(p) __tsan_release(p)
#else
#define TAUT_TSAN_ACQUIRE(p) ((void)(p))
#define TAUT_TSAN_RELEASE(p) ((void)(p))
#endif

namespace taut {
namespace {

struct Workers {
  int count = 1;
  // lifts TBB's own limit when more threads than processors are asked for
  std::unique_ptr<tbb::global_control> limit;
  std::unique_ptr<tbb::task_arena> arena;

  explicit Workers(int n) { resize(n); }
  void resize(int n) {
    arena.reset();
    limit = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                  static_cast<std::size_t>(n));
    arena = std::make_unique<tbb::task_arena>(n);
    count = n;
  }
};

Workers& workers() {
  static Workers instance(std::max(1, static_cast<int>(std::thread::hardware_concurrency())));
  return instance;
}

}  // namespace

void set_thread_count(int count) {
  if (count < 1) throw std::invalid_argument("set_thread_count: at least one thread is needed");
  if (count != workers().count) workers().resize(count);
}

int thread_count() { return workers().count; }

int thread_slot() {
  return workers().count == 1 ? 0 : std::max(0, tbb::this_task_arena::current_thread_index());
}

void detail::run_parallel(Index n, Index grain, const std::function<void(Index, Index)>& body) {
  Workers& w = workers();
  char start_token = 0, end_token = 0;
  TAUT_TSAN_RELEASE(&start_token);
  w.arena->execute([&] {
    // Isolated: a thread that waits for the end of a loop inside a task must not begin another,
    // perhaps much longer, task meanwhile.
    tbb::this_task_arena::isolate([&] {
      // A static split: the same ranges go to the same caches loop after loop.
      tbb::parallel_for(
          tbb::blocked_range<Index>(0, n, grain),
          [&](const tbb::blocked_range<Index>& range) {
            TAUT_TSAN_ACQUIRE(&start_token);
            body(range.begin(), range.end());
            TAUT_TSAN_RELEASE(&end_token);
          },
          tbb::static_partitioner());
    });
  });
  TAUT_TSAN_ACQUIRE(&end_token);
}

void detail::run_tasks(std::span<const Index> first,
                       const std::function<void(Index, Spawner&)>& body) {
  char start_token = 0, end_token = 0;
  struct GroupSpawner final : Spawner {
    const std::function<void(Index, Spawner&)>& body;
    char *start_token, *end_token;
    tbb::task_group group;

    GroupSpawner(const std::function<void(Index, Spawner&)>& b, char* start, char* end)
        : body(b), start_token(start), end_token(end) {}
    void operator()(Index task) override {
      TAUT_TSAN_RELEASE(start_token);
      group.run([this, task] {
        TAUT_TSAN_ACQUIRE(start_token);
        body(task, *this);
        TAUT_TSAN_RELEASE(end_token);
      });
    }
  };
  workers().arena->execute([&] {
    GroupSpawner spawn(body, &start_token, &end_token);
    for (const Index task : first) spawn(task);
    spawn.group.wait();
  });
  TAUT_TSAN_ACQUIRE(&end_token);
}

}  // namespace taut
