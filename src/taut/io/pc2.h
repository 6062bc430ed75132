#pragma once
// PC2 point caches: the positions of a mesh's vertices over time, for Blender, Maya,
// Houdini and others; the mesh itself goes into an OBJ. Source: the 3ds Max PC2 format as
// Blender's Mesh Cache reads it.
//
//   header        32 bytes, little-endian: "POINTCACHE2\0", int32 version = 1, int32 points, float
//                 start_frame, float sample_rate, int32 samples
//   each sample   points x 3 float32: x y z of each vertex in the mesh's order, m
//   sample_rate   frames between two samples (1: a sample a frame)
//
// A reader never sees half a cache: samples go to a temporary file as they come, which finish()
// renames. Read are all samples at once, 24 bytes a point and sample. Throws InputError naming the
// file, and sample and point where there is one (docs/design/readers.md says for what).

#include <filesystem>
#include <fstream>
#include <span>
#include <string_view>
#include <vector>

#include "taut/base/types.h"

namespace taut {

// What such a file begins with.
inline constexpr std::string_view pc2_magic{"POINTCACHE2\0", 12};

struct PointCache {
  Index points = 0;
  double start_frame = 0.0;
  double sample_rate = 1.0;
  std::vector<Vec3> positions;  // m, sample after sample, `points` each
  Index samples() const {
    return static_cast<Index>(positions.size() / static_cast<std::size_t>(points));
  }
  std::span<const Vec3> sample(Index k) const {
    return std::span(positions).subspan(
        static_cast<std::size_t>(k) * static_cast<std::size_t>(points),
        static_cast<std::size_t>(points));
  }
};

PointCache read_pc2(const std::filesystem::path& path);

class Pc2Writer {
 public:
  Pc2Writer(const std::filesystem::path& path, Index points, float start_frame = 0,
            float sample_rate = 1);
  ~Pc2Writer();
  Pc2Writer(const Pc2Writer&) = delete;
  Pc2Writer& operator=(const Pc2Writer&) = delete;

  // Asserts that there are `points` positions.
  void add_sample(std::span<const Vec3> positions);
  Index samples() const { return samples_; }
  void finish();

 private:
  [[noreturn]] void fail() const;

  std::filesystem::path path_, temporary_;
  std::ofstream stream_;
  Index points_;
  Index samples_ = 0;
};

}  // namespace taut
