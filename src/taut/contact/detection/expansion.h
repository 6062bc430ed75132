#pragma once
// Exact sums and products of doubles: a number is kept as a sum of doubles that do not overlap (J.
// R. Shewchuk 1997, contact/intersection.h).
//
// Exact unless something overflows or a product's rounding error falls below 2^-1074. Private to
// contact. Slow, and rarely needed.

#include <cmath>
#include <vector>

namespace taut::detail {

class Expansion {
 public:
  Expansion() = default;
  // a - b
  static Expansion difference(double a, double b) {
    const double sum = a - b, other = a - sum;
    const double error = (a - (sum + other)) + (other - b);
    Expansion result;
    result.append(error);
    result.append(sum);
    return result;
  }

  Expansion operator+(const Expansion& other) const {
    Expansion result = *this;
    for (const double term : other.terms_) result = result.grown(term);
    return result;
  }
  Expansion operator-() const {
    Expansion result = *this;
    for (double& term : result.terms_) term = -term;
    return result;
  }
  Expansion operator-(const Expansion& other) const { return *this + -other; }
  Expansion operator*(const Expansion& other) const {
    Expansion result;
    for (const double a : terms_)
      for (const double b : other.terms_) {
        const double product = a * b;
        result = result.grown(std::fma(a, b, -product)).grown(product);
      }
    return result;
  }

  // Of the exact value. Terms do not overlap and grow, so the last outweighs all others.
  int sign() const { return terms_.empty() ? 0 : terms_.back() > 0.0 ? 1 : -1; }

 private:
  void append(double term) {
    if (term != 0.0) terms_.push_back(term);
  }
  // *this + b, Shewchuk's GROW-EXPANSION without its zeros.
  Expansion grown(double b) const {
    Expansion result;
    double carry = b;
    for (const double term : terms_) {
      const double sum = carry + term, part = sum - carry;
      result.append((carry - (sum - part)) + (term - part));
      carry = sum;
    }
    result.append(carry);
    return result;
  }

  std::vector<double> terms_;
};

}  // namespace taut::detail
