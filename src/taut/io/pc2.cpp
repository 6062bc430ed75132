#include "taut/io/pc2.h"

#include <unistd.h>

#include <cassert>
#include <cerrno>
#include <cstring>
#include <string_view>
#include <system_error>

#include "taut/base/error.h"
#include "taut/io/little_endian.h"

namespace taut {

namespace {

constexpr std::streamoff sample_count_position = 28;

std::string header(Index points, float start_frame, float sample_rate) {
  std::string bytes(pc2_magic);
  append_little_endian(bytes, std::int32_t{1});
  append_little_endian(bytes, points);
  append_little_endian(bytes, start_frame);
  append_little_endian(bytes, sample_rate);
  append_little_endian(bytes, std::int32_t{0});
  return bytes;
}

}  // namespace

Pc2Writer::Pc2Writer(const std::filesystem::path& path, Index points, float start_frame,
                     float sample_rate)
    : path_(path),
      temporary_(path.string() + ".tmp" + std::to_string(::getpid())),
      points_(points) {
  std::error_code failure;
  if (path.has_parent_path()) std::filesystem::create_directories(path.parent_path(), failure);
  errno = 0;
  stream_.open(temporary_, std::ios::binary | std::ios::trunc);
  stream_ << header(points, start_frame, sample_rate);
  if (!stream_) fail();
}

Pc2Writer::~Pc2Writer() {
  if (temporary_.empty()) return;
  stream_.close();
  std::error_code failure;
  std::filesystem::remove(temporary_, failure);
}

void Pc2Writer::fail() const {
  const std::string reason = errno ? std::strerror(errno) : "unknown reason";
  // The constructor does not reach the destructor when it throws.
  std::error_code failure;
  std::filesystem::remove(temporary_, failure);
  throw InputError({path_.string()}, "cannot be written: " + reason +
                                         "; check the folder's permissions and free space");
}

void Pc2Writer::add_sample(std::span<const Vec3> positions) {
  assert(static_cast<Index>(positions.size()) == points_);
  std::string bytes;
  bytes.reserve(positions.size() * 3 * sizeof(float));
  for (const double coordinate : flat(positions))
    append_little_endian(bytes, static_cast<float>(coordinate));
  errno = 0;
  stream_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!stream_) fail();
  ++samples_;
}

void Pc2Writer::finish() {
  std::string count;
  append_little_endian(count, samples_);
  errno = 0;
  stream_.seekp(sample_count_position);
  stream_ << count;
  stream_.close();
  if (!stream_) fail();
  std::error_code failure;
  std::filesystem::rename(temporary_, path_, failure);
  if (failure) {
    errno = failure.value();
    fail();
  }
  temporary_.clear();
}

}  // namespace taut
