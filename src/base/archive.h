#pragma once
/// The state of a run on one rank as a row of named entries, for checkpoints and for moving it to another partition.
/// Each module lists once what it stores, in a member `serialize(Archive &)` that serves writing and reading alike, so
/// that the two cannot differ. An entry says to whom its content belongs: to all ranks alike, to a sum over ranks, or
/// to a cell, a node or an edge of the mesh by its global number. So the state of any number of ranks can be dealt out
/// to any other number (output/deal.h). All ranks make the same entries in the same order. Bytes are as this machine
/// stores them.
#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace talus {

/// To whom the content of an entry belongs.
enum class Belongs : char {
  to_all,      ///< the same on all ranks
  to_sum,      ///< numbers whose sums over ranks count
  to_largest,  ///< numbers whose largest over ranks count
  to_any,      ///< records that any rank may keep
  to_cells,    ///< begins rows: global numbers of the cells that they belong to
  to_points,   ///< begins rows: numbers of the nodes or edges that they belong to (ElementPlex::number)
  to_rows      ///< a column of rows
};

class Archive {
 public:
  /// Stores what is serialized into it.
  Archive() = default;
  /// Restores what `bytes` hold.
  explicit Archive(std::string bytes) : bytes_(std::move(bytes)), reading_(true) {}

  bool reading() const { return reading_; }
  const std::string &bytes() const & { return bytes_; }
  std::string bytes() && { return std::move(bytes_); }

  /// Numbers, plain structs, texts, and vectors of plain structs, which get their size back; all under one name, and
  /// the same on all ranks. Reading throws std::runtime_error where the archive holds something else.
  template <class... T>
  void serialize(const char *name, T &...values) {
    entry(Belongs::to_all, name, [&] { (one(values), ...); });
  }
  /// Shares of this rank in sums over all ranks.
  template <class... T>
  void sums(const char *name, T &...values) {
    entry(Belongs::to_sum, name, [&] { (numbers(values), ...); });
  }
  /// Numbers of which the largest over all ranks counts.
  template <class... T>
  void largest(const char *name, T &...values) {
    entry(Belongs::to_largest, name, [&] { (numbers(values), ...); });
  }
  /// Records that belong to no rank in particular.
  template <class T>
  void records(const char *name, std::vector<T> &values) {
    static_assert(std::is_trivially_copyable_v<T> && !std::is_pointer_v<T>, "only plain values can be stored");
    entry(Belongs::to_any, name, [&] {
      if (reading_) values.resize(left() / sizeof(T));
      block(values.data(), values.size() * sizeof(T));
    });
  }

  /// Rows that belong to cells or points; returned by `rows`, to name the rows of a column.
  struct Rows {
    std::size_t number = 0;  ///< of the archive's rows
    std::size_t count = 0;
  };
  /// Begins rows: `owner` is the global number of the cell or point that each belongs to, and comes back when read. A
  /// cell or point may have several rows, which stay in their order.
  Rows rows(const char *name, Belongs belongs, std::vector<long long> &owner) {
    entry(belongs, name, [&] {
      if (reading_) owner.resize(left() / sizeof(long long));
      block(owner.data(), owner.size() * sizeof(long long));
    });
    return {rows_++, owner.size()};
  }
  /// A column of rows: `width` values of each. A vector that is too short has no such column; read, it grows as needed.
  template <class T>
  void column(const Rows &rows, const char *name, std::vector<T> &values, std::size_t width = 1) {
    static_assert(std::is_trivially_copyable_v<T> && !std::is_pointer_v<T>, "only plain values can be stored");
    const std::size_t wanted = rows.count * width;
    column_of(rows, name, reading_ || values.size() >= wanted ? sizeof(T) * width : 0, [&]() -> void * {
      if (values.size() < wanted) values.resize(wanted);
      return values.data();
    });
  }
  /// The same of `bytes` per row in an array that has room for all rows.
  void column(const Rows &rows, const char *name, void *values, std::size_t bytes) {
    column_of(rows, name, bytes, [&] { return values; });
  }

  /// An entry as it is stored.
  struct Entry {
    Belongs belongs;
    std::string_view name, content;
  };
  /// The entries in their order; they refer to this archive.
  std::vector<Entry> entries() const {
    std::vector<Entry> all;
    for (std::size_t at = 0; at < bytes_.size();) {
      const auto take = [&](void *value, std::size_t size) {
        if (size > bytes_.size() - at) throw std::runtime_error("it ends too early");
        std::memcpy(value, bytes_.data() + at, size), at += size;
      };
      const auto text = [&] {
        std::size_t size;
        take(&size, sizeof size);
        if (size > bytes_.size() - at) throw std::runtime_error("it ends too early");
        const std::string_view found(bytes_.data() + at, size);
        at += size;
        return found;
      };
      Entry one;
      take(&one.belongs, sizeof one.belongs);
      one.name = text(), one.content = text();
      all.push_back(one);
    }
    return all;
  }
  /// Adds an entry as it is stored.
  void add(Belongs belongs, std::string_view name, std::string_view content) {
    bytes_ += static_cast<char>(belongs);
    for (const std::string_view part : {name, content}) {
      const std::size_t size = part.size();
      bytes_.append(reinterpret_cast<const char *>(&size), sizeof size);
      bytes_ += part;
    }
  }

 private:
  template <class Content>
  void entry(Belongs belongs, const char *name, Content &&content) {
    if (!reading_) {
      add(belongs, name, "");
      const std::size_t begin = bytes_.size();
      content();
      const std::size_t size = bytes_.size() - begin;
      std::memcpy(bytes_.data() + begin - sizeof size, &size, sizeof size);
      return;
    }
    end_ = bytes_.size();
    Belongs found;
    std::string found_name;
    std::size_t size;
    block(&found, sizeof found), text(found_name), block(&size, sizeof size);
    if (found_name != name || found != belongs)
      throw std::runtime_error("it holds `" + found_name.substr(0, 40) + "` where `" + name + "` belongs");
    if (size > left()) throw std::runtime_error("it ends too early");
    end_ = at_ + size;
    content();
    if (at_ != end_) throw std::runtime_error("`" + std::string(name) + "` has another size");
  }
  template <class Where>
  void column_of(const Rows &rows, const char *name, std::size_t bytes, Where &&where) {
    entry(Belongs::to_rows, name, [&] {
      std::size_t of = rows.number, stored = bytes;
      block(&of, sizeof of), block(&stored, sizeof stored);
      if (of != rows.number || (rows.count > 0 && stored != bytes && stored != 0))
        throw std::runtime_error("`" + std::string(name) + "` has another size");
      if (stored) block(where(), stored * rows.count);
    });
  }
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
  /// Plain numbers of which the reader knows how many there are.
  template <class T>
  void numbers(T &value) {
    static_assert(std::is_trivially_copyable_v<T> && sizeof(T) % sizeof(double) == 0, "these are no doubles");
    block(&value, sizeof value);
  }
  template <class T>
  void numbers(std::vector<T> &values) {
    static_assert(std::is_trivially_copyable_v<T> && sizeof(T) % sizeof(double) == 0, "these are no doubles");
    block(values.data(), values.size() * sizeof(T));
  }
  std::size_t left() const { return end_ - at_; }
  template <class Container>
  void resize(Container &values, std::size_t item) {
    std::size_t count = values.size();
    block(&count, sizeof count);
    if (!reading_) return;
    if (count > left() / item) throw std::runtime_error("it ends too early");
    values.resize(count);
  }
  void block(void *data, std::size_t size) {
    if (!reading_) {
      bytes_.append(static_cast<const char *>(data), size);
      return;
    }
    if (size > left()) throw std::runtime_error("it ends too early");
    if (size) std::memcpy(data, bytes_.data() + at_, size);
    at_ += size;
  }

  std::string bytes_;
  std::size_t at_ = 0, end_ = 0;  ///< where reading is, and where the entry that is read ends
  std::size_t rows_ = 0;
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
