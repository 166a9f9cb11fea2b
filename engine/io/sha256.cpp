#include "sha256.hpp"

#include <fmt/format.h>
#include <openssl/evp.h>

#include <algorithm>
#include <array>
#include <bit>
#include <new>
#include <vector>

#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kReadBytes = std::size_t{1} << 18U;

void require(int done) {
  if (done != 1) throw Error(ExitCode::kFailed, "OpenSSL's libcrypto cannot compute a SHA-256");
}

template <class Integer>
std::array<std::byte, sizeof(Integer)> little_endian(Integer value) {
  std::array<std::byte, sizeof(Integer)> bytes{};
  for (std::byte& byte : bytes) {
    byte = static_cast<std::byte>(value & 0xffU);
    value = static_cast<Integer>(value >> 8U);
  }
  return bytes;
}

}  // namespace

void Sha256::Free::operator()(EVP_MD_CTX* context) const { EVP_MD_CTX_free(context); }

Sha256::Sha256() {
  context_.reset(EVP_MD_CTX_new());
  if (!context_) throw std::bad_alloc();
  require(EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr));
}

Sha256& Sha256::update(std::span<const std::byte> data) {
  require(EVP_DigestUpdate(context_.get(), data.data(), data.size()));
  return *this;
}

Sha256& Sha256::update(std::string_view text) { return update(std::as_bytes(std::span(text.data(), text.size()))); }
Sha256& Sha256::update(double value) { return update(little_endian(std::bit_cast<std::uint64_t>(value))); }
Sha256& Sha256::update(std::int32_t value) { return update(little_endian(std::bit_cast<std::uint32_t>(value))); }
Sha256& Sha256::update(std::uint16_t value) { return update(little_endian(value)); }

std::string Sha256::hex() {
  std::array<unsigned char, 32> digest{};
  require(EVP_DigestFinal_ex(context_.get(), digest.data(), nullptr));
  std::string text;
  for (const unsigned char byte : digest) text += fmt::format("{:02x}", byte);
  return text;
}

HashedBytes sha256_of(ByteSource& source, const std::function<void()>& before_piece) {
  Sha256 hash;
  HashedBytes hashed;
  std::vector<char> piece(kReadBytes);
  for (std::size_t count = 1; count > 0;) {
    if (before_piece) before_piece();
    count = source.read(piece);
    hash.update(std::string_view(piece.data(), count));
    hashed.bytes += count;
  }
  hashed.sha256 = hash.hex();
  return hashed;
}

HashedBytes sha256_of_file(const std::string& path, const std::function<void()>& before_piece) {
  return sha256_of(*open_file_source(path), before_piece);
}

std::string sha256_of(const DistanceFieldRows& field) {
  Sha256 hash;
  const GridGeometry& geometry = field.geometry;
  hash.update(geometry.resolution_m).update(geometry.origin_x_m).update(geometry.origin_y_m);
  hash.update(geometry.width).update(geometry.height);
  std::vector<std::uint16_t> row(static_cast<std::size_t>(geometry.width));
  std::vector<std::byte> text(2 * row.size());
  for (std::int32_t y = 0; y < geometry.height; ++y) {
    field.read(y, row);
    for (std::size_t x = 0; x < row.size(); ++x) {
      const auto bytes = little_endian(row[x]);
      std::copy(bytes.begin(), bytes.end(), text.begin() + static_cast<std::ptrdiff_t>(2 * x));
    }
    hash.update(text);
  }
  return hash.hex();
}

std::string sha256_of(const Trajectory& trajectory) {
  Sha256 hash;
  for (const StampedPose& pose : trajectory) {
    hash.update(pose.T_map_base.x_m).update(pose.T_map_base.y_m).update(pose.T_map_base.theta_rad);
  }
  return hash.hex();
}

}  // namespace gdtslam
