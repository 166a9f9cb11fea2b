#include "byte_shelf.hpp"

#include "gdtslam/core/error.hpp"

namespace gdtslam {

void ByteShelf::put(std::initializer_list<std::span<const std::byte>> parts) {
  std::uint64_t record_bytes = 0;  // bytes after this number
  for (const std::span<const std::byte> part : parts) record_bytes += part.size();
  const std::size_t bytes = sizeof record_bytes + record_bytes;
  if (!open_.empty() && open_.size() + bytes > page_bytes_) close_page();
  if (open_.empty()) open_.reserve(std::max(bytes, page_bytes_));
  const auto append = [this](std::span<const std::byte> part) { open_.insert(open_.end(), part.begin(), part.end()); };
  append(value_bytes(record_bytes));
  for (const std::span<const std::byte> part : parts) append(part);
  ++size_;
}

void ByteShelf::close_page() {
  Page page{.bytes = std::exchange(open_, {}), .place = file_bytes_, .size = 0};
  page.size = page.bytes.size();
  if (bytes_in_memory_ + page.size > memory_bytes_ && write(page)) {
    file_bytes_ += page.size;
    open_ = std::exchange(page.bytes, {});
    open_.clear();
  } else {
    bytes_in_memory_ += page.size;
  }
  pages_.push_back(std::move(page));
}

// The disk only saves memory, so a full disk does not end a long run.
bool ByteShelf::write(const Page& page) {
  if (!trouble_.empty()) return false;
  try {
    if (!file_) file_.emplace(folder_);
    file_->write(page.place, page.bytes);
    return true;
  } catch (const FileError& error) {
    trouble_ = error.what();
    return false;
  }
}

std::span<const std::byte> ByteShelf::Reader::page() {
  if (page_ == shelf_->pages_.size()) return shelf_->open_;
  const Page& closed = shelf_->pages_[page_];
  if (!closed.bytes.empty()) return closed.bytes;
  if (in_memory_ != page_) {
    in_memory_.reset();
    from_file_.resize(closed.size);
    shelf_->file_->read(closed.place, from_file_);
    in_memory_ = page_;
  }
  return from_file_;
}

std::span<const std::byte> ByteShelf::Reader::next() {
  if (page_ < shelf_->pages_.size() && read_ == shelf_->pages_[page_].size) {
    ++page_;
    read_ = 0;
  }
  std::span<const std::byte> left = page().subspan(read_);
  std::uint64_t record_bytes = 0;
  take_values(left, std::span(&record_bytes, 1));
  read_ += sizeof record_bytes + record_bytes;
  return left.first(record_bytes);
}

}  // namespace gdtslam
