#pragma once
/// The state of a run on one rank as a row of named blocks of bytes, for checkpoints. Each module lists once what it
/// stores, in a member `serialize(Archive &)` that serves writing and reading alike, so that the two cannot differ.
/// Bytes are as this machine stores them.
#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace talus {

class Archive {
 public:
  /// Stores what is serialized into it.
  Archive() = default;
  /// Restores what `bytes` hold.
  explicit Archive(std::string bytes) : bytes_(std::move(bytes)), reading_(true) {}

  bool reading() const { return reading_; }
  const std::string &bytes() const { return bytes_; }

  /// Numbers, plain structs, texts, and vectors of plain structs, which get their size back; all under one name.
  /// Reading throws std::runtime_error where the archive holds something else.
  template <class... T>
  void serialize(const char *name, T &...values) {
    std::string found = name;
    text(found);
    if (found != name) throw std::runtime_error("it holds `" + found.substr(0, 40) + "` where `" + name + "` belongs");
    (one(values), ...);
  }
  /// Plain numbers of which the reader knows how many there are.
  void serialize_bytes(const char *name, void *values, std::size_t size) {
    std::size_t stored = size;
    serialize(name, stored);
    if (stored != size) throw std::runtime_error("`" + std::string(name) + "` has another size");
    block(values, size);
  }

 private:
  template <class T>
  void one(T &value) {
    static_assert(std::is_trivially_copyable_v<T> && !std::is_pointer_v<T>, "only plain values can be stored");
    block(&value, sizeof value);
  }
  template <class T>
  void one(std::vector<T> &values) {
    static_assert(std::is_trivially_copyable_v<T> && !std::is_pointer_v<T>, "only plain values can be stored");
    resize(values, sizeof(T));
    block(values.data(), values.size() * sizeof(T));
  }
  void one(std::string &value) { text(value); }
  void text(std::string &value) {
    resize(value, 1);
    block(value.data(), value.size());
  }
  template <class Container>
  void resize(Container &values, std::size_t item) {
    std::size_t count = values.size();
    block(&count, sizeof count);
    if (!reading_) return;
    if (count > (bytes_.size() - at_) / item) throw std::runtime_error("it ends too early");
    values.resize(count);
  }
  void block(void *data, std::size_t size) {
    if (!reading_) {
      bytes_.append(static_cast<const char *>(data), size);
      return;
    }
    if (size > bytes_.size() - at_) throw std::runtime_error("it ends too early");
    if (size) std::memcpy(data, bytes_.data() + at_, size);
    at_ += size;
  }

  std::string bytes_;
  std::size_t at_ = 0;
  bool reading_ = false;
};

/// A number that tells contents apart: FNV-1a on words of 8 bytes (Fowler, Noll, Vo 1991), for damage, not against
/// malice.
inline unsigned long long fingerprint(const void *data, std::size_t size,
                                      unsigned long long seed = 0xcbf29ce484222325) {
  const char *bytes = static_cast<const char *>(data);
  unsigned long long sum = seed;
  for (std::size_t at = 0; at < size; at += sizeof sum) {
    unsigned long long word = size - at;  // of the last, shorter word
    std::memcpy(&word, bytes + at, std::min(sizeof word, size - at));
    sum = (sum ^ word) * 0x100000001b3;
    sum ^= sum >> 32;
  }
  return sum;
}

}  // namespace talus
