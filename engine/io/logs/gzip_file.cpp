#include "gzip_file.hpp"

#include <zlib.h>

#include <limits>
#include <span>
#include <vector>

#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

constexpr int kDeflateWindowBits = 15 + 16;  // the largest window, with a gzip header
constexpr int kMemoryLevel = 8;              // zlib's default
constexpr std::size_t kBlockBytes = std::size_t{1} << 16;

}  // namespace

struct TextSink::Deflater {
  Deflater() {
    if (deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, kDeflateWindowBits, kMemoryLevel,
                     Z_DEFAULT_STRATEGY) != Z_OK) {
      throw Error(ExitCode::kFailed, "zlib cannot start: not enough memory");
    }
  }
  Deflater(const Deflater&) = delete;
  Deflater& operator=(const Deflater&) = delete;
  ~Deflater() { deflateEnd(&stream); }

  // Compresses all of the input and writes the output.
  void run(std::string_view text, int flush, AtomicFile& file) {
    // zlib does not write to its input; its interface predates const.
    stream.next_in = const_cast<Bytef*>(reinterpret_cast<const Bytef*>(text.data()));
    stream.avail_in = static_cast<uInt>(text.size());
    int status = Z_OK;
    do {
      stream.next_out = block.data();
      stream.avail_out = static_cast<uInt>(block.size());
      status = deflate(&stream, flush);
      file.write(std::as_bytes(std::span(block.data(), block.size() - stream.avail_out)));
    } while (stream.avail_out == 0 || (flush == Z_FINISH && status == Z_OK));
  }

  z_stream stream{};
  std::vector<Bytef> block = std::vector<Bytef>(kBlockBytes);
};

TextSink::TextSink(AtomicFile& file)
    : file_(file), deflater_(file.path().ends_with(".gz") ? std::make_unique<Deflater>() : nullptr) {}

TextSink::~TextSink() = default;

void TextSink::write(std::string_view text) {
  bytes_ += text.size();
  if (!deflater_) {
    file_.write(text);
    return;
  }
  constexpr std::size_t kMostAtOnce = std::numeric_limits<uInt>::max();
  while (!text.empty()) {
    deflater_->run(text.substr(0, kMostAtOnce), Z_NO_FLUSH, file_);
    text.remove_prefix(std::min(text.size(), kMostAtOnce));
  }
}

void TextSink::finish() {
  if (deflater_) {
    deflater_->run({}, Z_FINISH, file_);
  }
}

}  // namespace gdtslam
