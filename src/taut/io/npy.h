#pragma once
// NumPy arrays in .npy files: numpy.load(path) reads what is written here.
//
//   T       float (<f4), double (<f8), std::int32_t (<i4), little-endian, or std::uint8_t (|u1)
//   shape   any number of axes, the last one fastest (C order): shape[0] x shape[1] x ... values
//
// Source: NumPy, "numpy.lib.format", version 1.0 of the file format (versions 2.0 and 3.0 are read
// too). Written through a temporary file; throws InputError when that fails. Reading throws
// InputError when the file is no .npy, holds another type (no silent conversion), is big-endian or
// in Fortran order, or its size does not fit its shape; memory is bounded by the file's size.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <vector>

#include "taut/base/types.h"

namespace taut {

template <class T>
struct NpyArray {
  std::vector<std::int64_t> shape;
  std::vector<T> values;
};

// Asserts that shape and number of values fit.
template <class T>
void write_npy(const std::filesystem::path& path, std::span<const T> values,
               std::span<const std::int64_t> shape);

// The same in pieces, one after the other in memory: `next` is asked for piece after piece until
// the shape is filled. Asserts that it ends there.
template <class T>
void write_npy(const std::filesystem::path& path, std::span<const std::int64_t> shape,
               const std::function<std::span<const T>()>& next);

template <class T>
NpyArray<T> read_npy(const std::filesystem::path& path);

// Node vectors, shape (n, 3): as doubles, or rounded to float.
void write_npy(const std::filesystem::path& path, std::span<const Vec3> nodes);
void write_npy_float(const std::filesystem::path& path, std::span<const Vec3> nodes);
// Shape (n, 3) of float or double; refused otherwise.
std::vector<Vec3> read_npy_nodes(const std::filesystem::path& path);

}  // namespace taut
