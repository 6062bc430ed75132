#include "taut/results/checkpoint.h"

#include <ostream>

#include "taut/base/checksum.h"
#include "taut/sim/archive.h"

namespace taut {

namespace {

constexpr std::string_view checkpoint_magic = "TAUTCKP6";

std::uint64_t checksum(std::string_view bytes) {
  Checksum sum;
  sum.add(bytes);
  return sum.value();
}

}  // namespace

void write(std::ostream& out, const Checkpoint& checkpoint) {
  ArchiveWriter writer;
  for (const char c : checkpoint_magic) writer.value(c);
  writer.list(checkpoint.scene);
  writer.value(checkpoint.frame);
  writer.list(checkpoint.files);
  writer.list(checkpoint.snapshot.bytes);
  writer.value(checksum(writer.bytes()));
  out.write(writer.bytes().data(), static_cast<std::streamsize>(writer.bytes().size()));
}

Checkpoint parse_checkpoint(const std::string& bytes, const std::string& name) {
  constexpr std::size_t sum_size = sizeof(std::uint64_t);
  const ArchiveReader damaged({}, name);
  if (bytes.size() < checkpoint_magic.size() + sum_size || !bytes.starts_with(checkpoint_magic))
    damaged.fail();
  const std::string_view content(bytes.data(), bytes.size() - sum_size);
  std::uint64_t sum = 0;
  std::memcpy(&sum, bytes.data() + content.size(), sizeof(sum));
  if (sum != checksum(content)) damaged.fail();
  ArchiveReader reader(content.substr(checkpoint_magic.size()), name);
  Checkpoint checkpoint;
  reader.list(checkpoint.scene);
  reader.value(checkpoint.frame);
  reader.list(checkpoint.files);
  reader.list(checkpoint.snapshot.bytes);
  if (!reader.at_end()) reader.fail();
  return checkpoint;
}

}  // namespace taut
