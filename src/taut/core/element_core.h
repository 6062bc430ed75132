#pragma once
// The elements that make a core, and what of each assembled matrix they leave out. Which elements
// these are is found once; the numbers are taken from the assembler after each assemble().
//
// ρ of two-node elements is read off A's blocks, of all cores at once (core/core_bound.h); where a
// core leaves out larger ones, ρ, D_R and M + L_C come from the elements themselves.

#include <span>
#include <string>
#include <vector>

#include "taut/core/core.h"
#include "taut/element/assembler.h"

namespace taut {

class ElementCore {
 public:
  ElementCore() = default;
  // An empty mask: a core that is not there.
  ElementCore(std::string name, std::vector<std::uint8_t> mask, const Assembler& assembler);

  const std::string& name() const { return name_; }
  const std::vector<std::uint8_t>& mask() const { return mask_; }
  const CoreElements& elements() const { return elements_; }
  bool is_there() const { return !mask_.empty(); }
  bool leaves_larger_elements_out() const { return elements_.nodes_outside > 2; }

 private:
  std::string name_;
  std::vector<std::uint8_t> mask_;
  CoreElements elements_;
};

// What a core leaves out of one matrix.
struct CoreRest {
  double rho = -1.0;                // negative: not asked for
  BlockCsr matrix;                  // M + L_C, and D_R ...
  std::vector<Mat3> rest_diagonal;  // ... where larger elements are left out
};

// `a` is what the assembler has assembled last. Without wants_rho only cores that leave larger
// elements out are looked at: these have no other matrix. The same bits for any number of threads.
void measure_rests(std::span<const ElementCore> cores, const Assembler& assembler,
                   const BlockCsr& a, std::span<const double> masses, bool wants_rho,
                   std::span<CoreRest> rests);

// Both must outlive it.
Core view(const ElementCore& core, const CoreRest& rest);

}  // namespace taut
