// Records that are not needed before the end of a long run, in order. Up to a limit they stay in memory, beyond it they
// go to a file without a name, so that memory does not grow with the run. Not thread-safe. Cost: a copy each way.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "scratch_file.hpp"

namespace gdtslam {

class ByteShelf {
 public:
  static constexpr std::size_t kMemoryBytes = std::size_t{8} << 20U;
  static constexpr std::size_t kFewBytes = std::size_t{1} << 20U;  ///< for records of a few bytes each

  /// Beyond `memory_bytes` the file is made in `folder` (ScratchFile).
  explicit ByteShelf(std::string folder, std::size_t memory_bytes = kMemoryBytes)
      : folder_(std::move(folder)), memory_bytes_(memory_bytes), page_bytes_(std::min(kPageBytes, memory_bytes / 16)) {}

  /// Appends a record from its parts. If the folder takes no file, or its disk is full, records stay in memory.
  void put(std::initializer_list<std::span<const std::byte>> parts);
  /// Number of records.
  [[nodiscard]] std::size_t size() const { return size_; }
  /// Number of bytes in the file.
  [[nodiscard]] std::uint64_t bytes_in_file() const { return file_bytes_; }
  /// Reason why the file could not be used; usually empty.
  [[nodiscard]] const std::string& trouble() const { return trouble_; }

  /// Reads all records in order, including those put meanwhile. The shelf must outlive it.
  class Reader {
   public:
    explicit Reader(const ByteShelf& shelf) : shelf_(&shelf) {}
    /// Call at most size() times; the bytes are valid until the next call of any member. Throws FileError if the file
    /// cannot be read.
    std::span<const std::byte> next();

   private:
    std::span<const std::byte> page();

    const ByteShelf* shelf_;
    std::size_t page_ = 0;  // current page; the one after the closed pages is the open one
    std::size_t read_ = 0;  // bytes of it
    std::vector<std::byte> from_file_;
    std::optional<std::size_t> in_memory_;  // number of the page in memory
  };

 private:
  /// Many whole records.
  struct Page {
    std::vector<std::byte> bytes;  // empty if the page is in the file
    std::uint64_t place = 0;
    std::size_t size = 0;
  };
  static constexpr std::size_t kPageBytes = std::size_t{1} << 20U;
  void close_page();
  bool write(const Page& page);

  std::string folder_;
  std::size_t memory_bytes_;
  std::size_t page_bytes_;
  std::size_t size_ = 0;
  std::vector<Page> pages_;
  std::vector<std::byte> open_;  // the page being filled
  std::size_t bytes_in_memory_ = 0;
  std::optional<ScratchFile> file_;
  std::uint64_t file_bytes_ = 0;
  std::string trouble_;
};

/// A value as a part of a record.
template <typename Value>
std::span<const std::byte> value_bytes(const Value& value) {
  static_assert(std::is_trivially_copyable_v<Value>);
  return std::as_bytes(std::span(&value, 1));
}

/// Takes values from the front of a record.
template <typename Value>
void take_values(std::span<const std::byte>& record, std::span<Value> values) {
  static_assert(std::is_trivially_copyable_v<Value>);
  const std::span<const std::byte> bytes = record.first(values.size_bytes());
  if (!bytes.empty()) std::memcpy(values.data(), bytes.data(), bytes.size());
  record = record.subspan(bytes.size());
}

/// A trivially copyable value as a record.
template <typename Value>
requires std::is_trivially_copyable_v<Value>
void put_on(ByteShelf& shelf, const Value& value) { shelf.put({value_bytes(value)}); }
template <typename Value>
requires std::is_trivially_copyable_v<Value>
void take_from(std::span<const std::byte> record, Value& value) { take_values(record, std::span(&value, 1)); }

/// Values on a ByteShelf: put_on(shelf, value) writes a value as a record, and take_from(record, value) reads it back.
template <typename Value>
class Shelf {
 public:
  explicit Shelf(std::string folder, std::size_t memory_bytes = ByteShelf::kMemoryBytes)
      : bytes_(std::move(folder), memory_bytes) {}

  void put(const Value& value) { put_on(bytes_, value); }
  [[nodiscard]] std::size_t size() const { return bytes_.size(); }
  [[nodiscard]] const ByteShelf& bytes() const { return bytes_; }
  /// All values. Throws FileError if the file cannot be read.
  [[nodiscard]] std::vector<Value> all() const {
    std::vector<Value> values;
    values.reserve(size());
    Reader reader(*this);
    for (std::size_t i = 0; i < size(); ++i) values.push_back(reader.next());
    return values;
  }

  /// Reads the values in order, including those put meanwhile.
  class Reader {
   public:
    explicit Reader(const Shelf& shelf) : reader_(shelf.bytes_) {}
    /// Call at most once for each value. Throws FileError if the file cannot be read.
    Value next() {
      Value value;
      take_from(reader_.next(), value);
      return value;
    }

   private:
    ByteShelf::Reader reader_;
  };

 private:
  ByteShelf bytes_;
};

}  // namespace gdtslam
