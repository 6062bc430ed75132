#pragma once
// Bytes put aside on disk until it is known what stands before them in a file. The file has no
// name, so that nothing is left of it however the program ends.

#include <cstdio>
#include <filesystem>
#include <iosfwd>
#include <string_view>

namespace taut {

class SpoolFile {
 public:
  // In `folder`, which is made if missing. Throws InputError when that cannot be
  // written; so do the others.
  explicit SpoolFile(const std::filesystem::path& folder);
  ~SpoolFile();
  SpoolFile(const SpoolFile&) = delete;
  SpoolFile& operator=(const SpoolFile&) = delete;

  void append(std::string_view bytes);
  std::uint64_t size() const { return size_; }
  // All bytes so far.
  void copy_to(std::ostream& out);

 private:
  [[noreturn]] void fail() const;

  std::filesystem::path folder_;
  std::FILE* file_ = nullptr;
  std::uint64_t size_ = 0;
};

}  // namespace taut
