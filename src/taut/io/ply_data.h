#pragma once
// The numbers after a PLY header, in order, from text or from bytes. Only for io/ply.h.

#include <memory>

#include "taut/io/ply_header.h"

namespace taut::detail {

class PlyData {
 public:
  virtual ~PlyData() = default;
  // Throws InputError naming the place when the file ends here or the word is no such number.
  virtual double number(PlyType type) = 0;
  // An element begins, an element ends: in text, each has a line of its own.
  virtual void begin_element() {}
  virtual void end_element() {}
  // The most numbers of this type that can follow: bounds what a list may claim.
  virtual std::size_t most_left(PlyType type) const = 0;
  // At the number read last.
  virtual SourcePlace place() const = 0;
  virtual std::string place_in_words() const { return {}; }  // where line and column do not exist
};

// `bytes` must outlive the result.
std::unique_ptr<PlyData> make_ply_data(const std::string& file, std::string_view bytes,
                                       const PlyHeader& header);

}  // namespace taut::detail
