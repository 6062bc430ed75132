#pragma once
// The header of a .npy file, a Python dictionary:
//
//   {'descr': '<f4', 'fortran_order': False, 'shape': (9, 3), }

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace taut {

struct NpyHeader {
  std::string type;  // "<f4", "<f8", "<i4", ...
  bool fortran_order = false;
  std::vector<std::int64_t> shape;
  std::size_t data_start = 0;  // bytes
};

// All bytes before the data, padded so that the data begins at a multiple of 64.
std::string npy_header_text(std::string_view type, const std::vector<std::int64_t>& shape);

// Throws InputError("FILE: ...") that says what is wrong.
NpyHeader parse_npy_header(const std::string& file, std::string_view bytes);

}  // namespace taut
