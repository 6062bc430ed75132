#include "taut/core/element_core.h"

#include <algorithm>
#include <cassert>

#include "taut/core/core_bound.h"

namespace taut {

ElementCore::ElementCore(std::string name, std::vector<std::uint8_t> mask,
                         const Assembler& assembler)
    : name_(std::move(name)), mask_(std::move(mask)) {
  if (is_there()) elements_ = assembler.elements_of(mask_);
}

void measure_rests(std::span<const ElementCore> cores, const Assembler& assembler,
                   const BlockCsr& a, std::span<const double> masses, bool wants_rho,
                   std::span<CoreRest> rests) {
  assert(rests.size() == cores.size());
  std::vector<std::size_t> of_springs;
  std::vector<std::span<const std::uint8_t>> masks;
  for (std::size_t c = 0; c < cores.size(); ++c) {
    CoreRest& rest = rests[c];
    rest.rho = -1.0;
    if (!cores[c].is_there()) continue;
    if (!cores[c].leaves_larger_elements_out()) {
      rest.matrix = {}, rest.rest_diagonal.clear();
      if (wants_rho) of_springs.push_back(c), masks.push_back(cores[c].mask());
      continue;
    }
    if (rest.matrix.pattern != a.pattern) rest.matrix = BlockCsr(a.pattern);
    rest.rest_diagonal.resize(masses.size());
    assembler.gather_core(cores[c].elements(), rest.matrix);
    assembler.gather_rest_diagonal(cores[c].elements(), rest.rest_diagonal);
    rest.rho = remainder_ratio(rest.rest_diagonal, masses);
  }
  if (masks.empty()) return;
  const std::vector<double> rho = remainder_ratios(a, masks, masses);
  for (std::size_t k = 0; k < of_springs.size(); ++k) rests[of_springs[k]].rho = rho[k];
}

Core view(const ElementCore& core, const CoreRest& rest) {
  Core result{core.name(), core.mask(), rest.rho};
  if (!core.leaves_larger_elements_out()) return result;
  result.nodes_outside = core.elements().nodes_outside;
  result.matrix = &rest.matrix;
  result.rest_diagonal = rest.rest_diagonal;
  return result;
}

}  // namespace taut
