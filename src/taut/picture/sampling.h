#pragma once
// Random-looking but fixed sample points of a picture: one scrambled Sobol sequence in two
// dimensions for each use, spread over the pixels.
//
// Pixels take consecutive runs of the sequence along a Z-order curve whose nested squares are
// visited in a scrambled order. A pixel's 2^k points form a (0, 2)-net (each dyadic box of
// area 2^-k holds one), and so do those of 2 x 2, 4 x 4, ... neighbours together: the error
// left differs from pixel to pixel as much as it can, and the eye averages it away. A sample
// depends on the pixel's coordinates and its number alone: neither on the order of work nor
// on the number of threads.
//
// Sources: A. Ahmed, P. Wonka, "Screen-Space Blue-Noise Diffusion of Monte Carlo Sampling Error via
// Hierarchical Ordering of Pixels", ACM TOG 39(6), 2020; scrambling: B. Burley, "Practical
// Hash-based Owen Scrambling", JCGT 9(4), 2020.

#include <array>
#include <bit>
#include <cstdint>

namespace taut::detail {

// A bijective mix of 32 bits (the "lowbias32" constants of C. Wellons' hash prospector).
constexpr std::uint32_t mix_bits(std::uint32_t x) {
  x = (x ^ (x >> 16)) * 0x7feb352dU;
  x = (x ^ (x >> 15)) * 0x846ca68bU;
  return x ^ (x >> 16);
}

constexpr std::uint32_t reverse_bits(std::uint32_t x) {
  x = ((x >> 1) & 0x55555555U) | ((x & 0x55555555U) << 1);
  x = ((x >> 2) & 0x33333333U) | ((x & 0x33333333U) << 2);
  x = ((x >> 4) & 0x0f0f0f0fU) | ((x & 0x0f0f0f0fU) << 4);
  x = ((x >> 8) & 0x00ff00ffU) | ((x & 0x00ff00ffU) << 8);
  return (x >> 16) | (x << 16);
}

// Owen's nested uniform scrambling of the number whose bits are x reversed: each bit is flipped by
// a hash of the bits below it.
constexpr std::uint32_t scramble_reversed(std::uint32_t x, std::uint32_t seed) {
  x += seed;
  x ^= x * 0x6c50b47cU;
  x ^= x * 0xb82f1e52U;
  x ^= x * 0xc7afe638U;
  x ^= x * 0x8d22f6e6U;
  return x;
}

constexpr std::uint32_t scramble(std::uint32_t x, std::uint32_t seed) {
  return reverse_bits(scramble_reversed(reverse_bits(x), seed));
}

// The second Sobol dimension; the first is reverse_bits(index). Both are
// linear: f(a ^ b) = f(a) ^ f(b).
constexpr std::uint32_t sobol_second(std::uint32_t index) {
  std::uint32_t result = 0;
  for (std::uint32_t direction = 1U << 31; index != 0; index >>= 1, direction ^= direction >> 1)
    if (index & 1U) result ^= direction;
  return result;
}

// x in the even bits and y in the odd ones; 16 bits each.
constexpr std::uint32_t z_order(std::uint32_t x, std::uint32_t y) {
  const auto spread = [](std::uint32_t v) {
    v = (v | v << 8) & 0x00ff00ffU;
    v = (v | v << 4) & 0x0f0f0f0fU;
    v = (v | v << 2) & 0x33333333U;
    return (v | v << 1) & 0x55555555U;
  };
  return spread(x) | spread(y) << 1;
}

// The samples of one pixel for one use (`seed`).
class PixelSamples {
 public:
  constexpr PixelSamples(std::uint32_t x, std::uint32_t y, std::uint32_t samples_per_pixel,
                         std::uint32_t seed)
      : seed_(mix_bits(seed)),
        first_(scramble(z_order(x, y), seed_) << std::bit_width(samples_per_pixel - 1)),
        second_(sobol_second(first_)) {}

  // Sample `index` < samples_per_pixel: two numbers in [0, 1).
  constexpr std::array<float, 2> at(std::uint32_t index) const {
    const std::uint32_t u = reverse_bits(scramble_reversed(first_ | index, seed_ ^ 0x68bc21ebU));
    const std::uint32_t v = scramble(second_ ^ sobol_second(index), seed_ ^ 0x02e5be93U);
    return {static_cast<float>(u >> 8) * 0x1p-24F, static_cast<float>(v >> 8) * 0x1p-24F};
  }

 private:
  std::uint32_t seed_, first_, second_;
};

}  // namespace taut::detail
