// After the first factorisation and solve there is nothing left to allocate: counted by this test
// program's own operator new.

#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "linalg/random_matrix.h"
#include "taut/base/parallel.h"
#include "taut/linalg/block_cholesky.h"

namespace {
std::atomic<long> allocations{0};

void* counted(std::size_t size) {
  ++allocations;
  if (void* p = std::malloc(size ? size : 1)) return p;
  throw std::bad_alloc();
}
}  // namespace

void* operator new(std::size_t size) { return counted(size); }
void* operator new[](std::size_t size) { return counted(size); }
// The standard library's stable sorts ask so for their buffers.
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  ++allocations;
  return std::malloc(size ? size : 1);
}
void operator delete(void* p) noexcept { std::free(p); }
void operator delete[](void* p) noexcept { std::free(p); }
void operator delete(void* p, std::size_t) noexcept { std::free(p); }
void operator delete[](void* p, std::size_t) noexcept { std::free(p); }

namespace taut::test {
namespace {

TEST(BlockFactorMemory, RefactorisingAllocatesNothing) {
  const int before = thread_count();
  set_thread_count(1);  // oneTBB makes tasks
  Random random(1);
  const BlockCsr a = random_spd(random, make_pattern(random_graph(random, 300, 4, 100), 3), 1e-2);
  const std::vector<double> b = random.vector(a.dofs());
  std::vector<double> x(b.size());
  for (const auto precision :
       {CholeskyPrecision::double_precision, CholeskyPrecision::single_precision}) {
    BlockCholesky cholesky(precision);
    ASSERT_TRUE(cholesky.analyze(a).ok() && cholesky.factorize(a).ok() &&
                cholesky.solve(b, x).ok());
    const long at_start = allocations;
    bool ok = true;
    for (int k = 0; k < 3; ++k) ok = ok && cholesky.factorize(a).ok() && cholesky.solve(b, x).ok();
    EXPECT_EQ(allocations - at_start, 0);
    EXPECT_TRUE(ok);
  }
  set_thread_count(before);
}

}  // namespace
}  // namespace taut::test
