#pragma once
// d_i: the mean of A's diagonal at node i, kg. It scales I - S where a formulation adds it to S A
// (docs/mathematics.md, 3.7).

#include <vector>

#include "taut/linalg/block_csr.h"

namespace taut {

std::vector<double> node_scale(const BlockCsr& a);

}  // namespace taut
