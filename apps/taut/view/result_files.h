#pragma once
// The files of a results folder, read for others to see: nothing outside the folder is ever opened.
// Names are fixed by this program, never taken from a request; symbolic links are not followed,
// only regular files are read.
//
// The folder may be changed by a running simulation, and be emptied and filled anew, at any time.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "taut/io/npy_header.h"

namespace taut::app {

// An open file; closed with the last copy.
class OpenFile {
 public:
  OpenFile(int descriptor, std::string path)
      : descriptor_(new int(descriptor), close_and_delete), path_(std::move(path)) {}
  int descriptor() const { return *descriptor_; }
  const std::string& path() const { return path_; }
  std::size_t size() const;
  // Changes when another file takes this name.
  std::string identity() const;
  // Up to `length` bytes from `offset`; fewer at the end of the file. Throws InputError when the
  // system cannot read.
  std::string read(std::size_t offset, std::size_t length) const;

 private:
  static void close_and_delete(const int* descriptor);
  std::shared_ptr<int> descriptor_;
  std::string path_;
};

// The numbers of a .npy file.
struct ArrayFile {
  OpenFile file;
  NpyHeader header;
  std::size_t bytes() const { return file.size() - header.data_start; }
};

class ResultFiles {
 public:
  // Throws InputError when there is no such folder.
  explicit ResultFiles(const std::filesystem::path& folder);

  const std::filesystem::path& folder() const { return path_; }
  // DIR/name, or DIR/frames/name. Nothing when there is no such file; throws InputError when it is
  // a link, a folder or may not be read.
  std::optional<OpenFile> open(const std::string& name) const;
  std::optional<OpenFile> open_in_frames(const std::string& name) const;
  // A .npy file in frames/ with numbers of this type ("<f4", "<i4") and this many to a row (1: the
  // array has one axis). Throws InputError when it is something else.
  std::optional<ArrayFile> open_array(const std::string& name, std::string_view type,
                                      std::int64_t row) const;
  std::optional<ArrayFile> open_frame(int frame) const;
  // What touches each node (sim/node_contact.h).
  std::optional<ArrayFile> open_contact(int frame) const;
  bool has_frame(int frame) const { return open_in_frames(frame_name(frame)).has_value(); }
  bool has_contact(int frame) const { return open_in_frames(contact_name(frame)).has_value(); }

 private:
  static std::string frame_name(int frame);
  static std::string contact_name(int frame);
  std::optional<OpenFile> open_at(int folder, const std::string& name,
                                  const std::filesystem::path& shown) const;
  std::filesystem::path path_;
  OpenFile folder_;
};

}  // namespace taut::app
