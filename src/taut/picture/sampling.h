#pragma once
// Random-looking but fixed sample points: hash-scrambled Sobol points in two dimensions.
//
// The first 2^k points of one seed form a (0, 2)-net: each dyadic box of area 2^-k holds one point, so few samples suffice. The seed is
// made from the pixel, so a pixel's samples depend on nothing else: neither on the order of work nor on the number of threads. Source: B.
// Burley, "Practical Hash-based Owen Scrambling", JCGT 9(4), 2020, listings 1 to 4.

#include <array>
#include <cstdint>

namespace taut::detail {

// A bijective mix of 32 bits (the "lowbias32" constants of C. Wellons' hash prospector).
constexpr std::uint32_t mix_bits(std::uint32_t x) {
  x = (x ^ (x >> 16)) * 0x7feb352dU;
  x = (x ^ (x >> 15)) * 0x846ca68bU;
  return x ^ (x >> 16);
}

constexpr std::uint32_t hash_of(std::uint32_t seed, std::uint32_t value) { return mix_bits(seed ^ mix_bits(value + 0x9e3779b9U)); }

constexpr std::uint32_t reverse_bits(std::uint32_t x) {
  x = ((x >> 1) & 0x55555555U) | ((x & 0x55555555U) << 1);
  x = ((x >> 2) & 0x33333333U) | ((x & 0x33333333U) << 2);
  x = ((x >> 4) & 0x0f0f0f0fU) | ((x & 0x0f0f0f0fU) << 4);
  x = ((x >> 8) & 0x00ff00ffU) | ((x & 0x00ff00ffU) << 8);
  return (x >> 16) | (x << 16);
}

// Owen's nested uniform scrambling: each bit is flipped by a hash of the bits above it.
constexpr std::uint32_t owen_scramble(std::uint32_t x, std::uint32_t seed) {
  x = reverse_bits(x);
  x += seed;
  x ^= x * 0x6c50b47cU;
  x ^= x * 0xb82f1e52U;
  x ^= x * 0xc7afe638U;
  x ^= x * 0x8d22f6e6U;
  return reverse_bits(x);
}

constexpr std::uint32_t sobol_second_dimension(std::uint32_t index) {
  std::uint32_t result = 0;
  for (std::uint32_t direction = 1U << 31; index != 0; index >>= 1, direction ^= direction >> 1)
    if (index & 1U) result ^= direction;
  return result;
}

// Sample `index` of the sequence `seed`: two numbers in [0, 1).
constexpr std::array<float, 2> sample_2d(std::uint32_t index, std::uint32_t seed) {
  const std::uint32_t shuffled = owen_scramble(index, seed);
  const std::uint32_t x = owen_scramble(reverse_bits(shuffled), hash_of(seed, 1));
  const std::uint32_t y = owen_scramble(sobol_second_dimension(shuffled), hash_of(seed, 2));
  return {static_cast<float>(x >> 8) * 0x1p-24F, static_cast<float>(y >> 8) * 0x1p-24F};
}

}  // namespace taut::detail
