#include "taut/results/checkpoint.h"

#include <bit>
#include <cstring>
#include <ostream>
#include <type_traits>

#include "taut/base/checksum.h"
#include "taut/base/error.h"

namespace taut {

static_assert(std::endian::native == std::endian::little, "checkpoints are little-endian");

namespace {

constexpr char magic[8] = {'T', 'A', 'U', 'T', 'C', 'K', 'P', '5'};

std::uint64_t checksum(std::string_view bytes) {
  Checksum sum;
  sum.add(bytes);
  return sum.value();
}

class Writer {
 public:
  template <class T>
  void value(const T& v) {
    static_assert(std::is_trivially_copyable_v<T>);
    bytes_.append(reinterpret_cast<const char*>(&v), sizeof(T));
  }
  template <class Container>
  void list(const Container& items) {
    value(static_cast<std::uint64_t>(items.size()));
    bytes_.append(reinterpret_cast<const char*>(items.data()),
                  items.size() * sizeof(typename Container::value_type));
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

class Reader {
 public:
  Reader(std::string_view bytes, const std::string& name) : bytes_(bytes), name_(name) {}
  template <class T>
  void value(T& v) {
    need(sizeof(T));
    std::memcpy(&v, bytes_.data(), sizeof(T));
    bytes_.remove_prefix(sizeof(T));
  }
  template <class Container>
  void list(Container& items) {
    constexpr std::size_t item = sizeof(typename Container::value_type);
    std::uint64_t count = 0;
    value(count);
    if (count > bytes_.size() / item) fail();
    items.resize(count);
    if (count == 0) return;  // an empty list may have no memory, which memcpy must not be given
    std::memcpy(static_cast<void*>(items.data()), bytes_.data(), count * item);
    bytes_.remove_prefix(count * item);
  }
  bool at_end() const { return bytes_.empty(); }
  [[noreturn]] void fail() const {
    throw InputError(
        {name_}, "is damaged or of another version of Taut; run the scene anew with `taut run`");
  }

 private:
  void need(std::size_t count) const {
    if (bytes_.size() < count) fail();
  }
  std::string_view bytes_;
  const std::string& name_;
};

// The one list of what a checkpoint holds, for both directions.
template <class Archive, class Content>
void transfer(Archive& archive, Content& c) {
  archive.list(c.scene);
  archive.value(c.steps);
  archive.value(c.frame);
  archive.value(c.state.time);
  archive.value(c.state.has_previous);
  archive.list(c.state.x);
  archive.list(c.state.v);
  archive.list(c.state.x_prev);
  archive.list(c.state.v_prev);
  archive.list(c.state.last);
  archive.list(c.contacts.node);
  archive.list(c.contacts.solid);
  archive.list(c.contacts.sticking);
  archive.list(c.contacts.normal_force);
  archive.list(c.solver_memory);
  archive.list(c.surface_contact.zones.node);
  archive.list(c.surface_contact.zones.rides);
  archive.list(c.surface_contact.forces);
  archive.list(c.files);
}

}  // namespace

void write(std::ostream& out, const Checkpoint& checkpoint) {
  Writer writer;
  for (const char c : magic) writer.value(c);
  transfer(writer, checkpoint);
  const std::uint64_t sum = checksum(writer.bytes());
  writer.value(sum);
  out.write(writer.bytes().data(), static_cast<std::streamsize>(writer.bytes().size()));
}

Checkpoint parse_checkpoint(const std::string& bytes, const std::string& name) {
  const std::size_t frame_size = sizeof(magic) + sizeof(std::uint64_t);
  if (bytes.size() < frame_size || std::memcmp(bytes.data(), magic, sizeof(magic)) != 0)
    Reader({}, name).fail();
  const std::string_view content(bytes.data(), bytes.size() - sizeof(std::uint64_t));
  std::uint64_t sum = 0;
  std::memcpy(&sum, bytes.data() + content.size(), sizeof(sum));
  if (sum != checksum(content)) Reader({}, name).fail();
  Reader reader(content.substr(sizeof(magic)), name);
  Checkpoint checkpoint;
  transfer(reader, checkpoint);
  if (!reader.at_end()) reader.fail();
  return checkpoint;
}

}  // namespace taut
