#include "taut/base/parallel.h"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <chrono>
#include <cmath>
#include <mutex>
#include <set>
#include <stdexcept>
#include <thread>

#include "taut/base/collect.h"

namespace taut::test {
namespace {

class Parallel : public testing::Test {
 protected:
  ~Parallel() override { set_thread_count(before_); }
  const int before_ = thread_count();
  const std::thread::id caller_ = std::this_thread::get_id();
};

// Numbers of very different sizes, so that another order of adding gives other bits.
double term(Index i) { return std::sin(1.0 + i) * std::pow(10.0, i % 13 - 6); }

double sum_of_terms(Index n) {
  return ordered_sum(n, [](Index begin, Index end) {
    double s = 0.0;
    for (Index i = begin; i < end; ++i) s += term(i);
    return s;
  });
}

TEST_F(Parallel, ForVisitsEachItemOnce) {
  for (const int threads : {1, 2, 3, 4}) {
    set_thread_count(threads);
    for (const Index n : {0, 1, 2, 7, 1000, 100'003})
      for (const Index grain : {1, 10, 1000}) {
        std::vector<int> visits(static_cast<std::size_t>(n), 0);
        parallel_for(n, grain, [&](Index begin, Index end) {
          EXPECT_LT(begin, end);
          for (Index i = begin; i < end; ++i) ++visits[static_cast<std::size_t>(i)];
        });
        EXPECT_TRUE(std::ranges::all_of(visits, [](int v) { return v == 1; }))
            << n << " items, grain " << grain << ", " << threads << " threads";
      }
  }
}

TEST_F(Parallel, SmallLoopStaysOnTheCallingThread) {
  set_thread_count(4);
  int calls = 0;
  parallel_for(100, 100, [&](Index begin, Index end) {
    ++calls;
    EXPECT_EQ(begin, 0);
    EXPECT_EQ(end, 100);
    EXPECT_EQ(std::this_thread::get_id(), caller_);
  });
  EXPECT_EQ(calls, 1);
}

TEST_F(Parallel, OrderedSumIsDeterministicInTheNumberOfThreads) {
  for (const Index n : {1, 2048, 2049, 12'345, 500'000}) {
    set_thread_count(1);
    const double expected = sum_of_terms(n);
    for (const int threads : {2, 3, 4}) {
      set_thread_count(threads);
      for (int repeat = 0; repeat < 5; ++repeat)
        EXPECT_EQ(std::bit_cast<std::uint64_t>(sum_of_terms(n)),
                  std::bit_cast<std::uint64_t>(expected))
            << n << " terms, " << threads << " threads";
    }
  }
}

TEST_F(Parallel, OrderedSumIsTheSum) {
  set_thread_count(3);
  const auto count = [](Index begin, Index end) {
    return static_cast<long long>(end) * (end - 1) / 2 -
           static_cast<long long>(begin) * (begin - 1) / 2;
  };
  for (const Index n : {0, 1, 2047, 2048, 2049, 100'000})
    EXPECT_EQ(ordered_sum<long long>(n, count), static_cast<long long>(n) * (n - 1) / 2) << n;
}

TEST_F(Parallel, NestedLoopsAndSumsAreDeterministic) {
  const auto nested = [] {
    std::vector<double> rows(40);
    parallel_for(40, 1, [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i)
        rows[static_cast<std::size_t>(i)] = sum_of_terms(10'000 + 97 * i);
    });
    return rows;
  };
  set_thread_count(1);
  const std::vector<double> expected = nested();
  for (const int threads : {2, 3, 4}) {
    set_thread_count(threads);
    EXPECT_EQ(nested(), expected);
  }
}

TEST_F(Parallel, LoopsFromSeveralThreadsAtOnce) {
  set_thread_count(2);
  const double expected = sum_of_terms(50'000);
  std::array<double, 3> found{};
  std::vector<std::thread> callers;
  for (double& sum : found) callers.emplace_back([&sum] { sum = sum_of_terms(50'000); });
  for (std::thread& caller : callers) caller.join();
  for (const double sum : found) EXPECT_EQ(sum, expected);
}

// Each range waits until another thread has begun one: one thread alone would wait in vain.
TEST_F(Parallel, SeveralThreadsReallyWork) {
  using Clock = std::chrono::steady_clock;
  for (const int threads : {2, 4}) {
    set_thread_count(threads);
    std::mutex mutex;
    std::set<std::thread::id> workers;
    const Clock::time_point limit = Clock::now() + std::chrono::seconds(20);
    const auto met = [&] {
      const std::lock_guard lock(mutex);
      return static_cast<int>(workers.size()) >= threads;
    };
    parallel_for(1000, 1, [&](Index, Index) {
      {
        const std::lock_guard lock(mutex);
        workers.insert(std::this_thread::get_id());
      }
      while (!met() && Clock::now() < limit) std::this_thread::yield();
    });
    EXPECT_EQ(static_cast<int>(workers.size()), threads);
  }
}

// Each range marks its slot, looks around for a while and finds no other in it.
TEST_F(Parallel, SlotsAreOfOneThreadAtATime) {
  for (const int threads : {1, 2, 4}) {
    set_thread_count(threads);
    std::array<std::atomic<int>, 4> inside{};
    std::atomic<int> strangers = 0, outside = 0;
    parallel_for(400, 1, [&](Index, Index) {
      const int slot = thread_slot();
      if (slot < 0 || slot >= threads) {
        ++outside;
        return;
      }
      if (++inside[static_cast<std::size_t>(slot)] > 1) ++strangers;
      for (int k = 0; k < 20; ++k) std::this_thread::yield();
      --inside[static_cast<std::size_t>(slot)];
    });
    EXPECT_EQ(strangers, 0) << threads << " threads";
    EXPECT_EQ(outside, 0) << threads << " threads";
  }
  EXPECT_EQ(thread_slot(), 0);
}

TEST_F(Parallel, CollectedListsAreInOrder) {
  for (const int threads : {1, 2, 4}) {
    set_thread_count(threads);
    for (const Index n : {0, 1, 99, 100, 101, 12'345}) {
      std::vector<Index> thirds{-1}, begins;
      collect(
          n, 100,
          [](Index begin, Index end, std::vector<Index>& third, std::vector<Index>& first) {
            first.push_back(begin);
            for (Index i = begin; i < end; ++i)
              if (i % 3 == 0) third.push_back(i);
          },
          thirds, begins);
      ASSERT_EQ(std::ssize(thirds), 1 + (n + 2) / 3) << "what was in the list stays";
      for (Index k = 1; k < std::ssize(thirds); ++k) ASSERT_EQ(thirds[k], 3 * (k - 1));
      ASSERT_EQ(std::ssize(begins), (n + 99) / 100);
      for (Index k = 0; k < std::ssize(begins); ++k) ASSERT_EQ(begins[k], 100 * k);
    }
  }
}

TEST_F(Parallel, OneThreadMeansTheCallingOne) {
  set_thread_count(1);
  parallel_for(100'000, 1, [&](Index, Index) { EXPECT_EQ(std::this_thread::get_id(), caller_); });
}

TEST_F(Parallel, ExceptionsReachTheCaller) {
  set_thread_count(2);
  const auto loop = [] {
    parallel_for(1000, 1, [](Index begin, Index end) {
      if (begin <= 700 && 700 < end) throw std::length_error("item 700");
    });
  };
  EXPECT_THROW(loop(), std::length_error);
  EXPECT_GT(sum_of_terms(100'000), -1e300);  // and the workers go on working
}

TEST_F(Parallel, ThreadCountIsWhatWasAsked) {
  EXPECT_GE(thread_count(), 1);
  for (const int threads : {3, 1, 4}) {
    set_thread_count(threads);
    EXPECT_EQ(thread_count(), threads);
  }
  EXPECT_THROW(set_thread_count(0), std::invalid_argument);
  EXPECT_THROW(set_thread_count(-2), std::invalid_argument);
  EXPECT_EQ(thread_count(), 4);
}

}  // namespace
}  // namespace taut::test
