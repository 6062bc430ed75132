#pragma once
// While a FlushSubnormals lives, this thread takes subnormal numbers (below 1e-38 in single
// precision, 1e-308 in double) for zero, in what it reads and in what it computes. Many processors
// do arithmetic with them in microcode, a hundred times slower. The entries of a factor fall off
// with the distance between nodes, so in single precision there are millions of them: a
// factorisation took six times as long as without.
//
// It is a property of the thread, and oneTBB sets it anew for each loop and task: so each body of a
// parallel loop that computes with such numbers has its own, and the bits do not depend on which
// thread runs it.

#include <cstdint>

namespace taut {

class FlushSubnormals {
 public:
  FlushSubnormals() : before_(read()) {
    if ((before_ & flush) != flush) write(before_ | flush);
  }
  ~FlushSubnormals() {
    if ((before_ & flush) != flush) write(before_);
  }
  FlushSubnormals(const FlushSubnormals&) = delete;
  FlushSubnormals& operator=(const FlushSubnormals&) = delete;

 private:
  // Where the architecture is not known, subnormal numbers stay what they are.
#if defined(__x86_64__)
  using Word = unsigned;
  static constexpr Word flush = 0x8040;  // MXCSR: results (FZ) and operands (DAZ)
  static Word read() { return __builtin_ia32_stmxcsr(); }
  static void write(Word word) { __builtin_ia32_ldmxcsr(word); }
#elif defined(__aarch64__)
  using Word = std::uint64_t;
  static constexpr Word flush = Word{1} << 24;  // FPCR.FZ: both
  static Word read() {
    Word word;
    asm volatile("mrs %0, fpcr" : "=r"(word)::"memory");
    return word;
  }
  static void write(Word word) { asm volatile("msr fpcr, %0" ::"r"(word) : "memory"); }
#else
  using Word = std::uint64_t;
  static constexpr Word flush = 0;
  static Word read() { return 0; }
  static void write(Word) {}
#endif

  Word before_;
};

}  // namespace taut
