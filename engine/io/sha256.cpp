#include "sha256.hpp"

#include <fmt/format.h>
#include <openssl/evp.h>

#include <array>
#include <new>
#include <vector>

#include "engine/io/little_endian.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kReadBytes = std::size_t{1} << 18U;

void require(int done) {
  if (done != 1) throw Error(ExitCode::kFailed, "OpenSSL's libcrypto cannot compute a SHA-256");
}

template <class Number>
std::string little_endian_bytes(Number value) {
  std::string bytes;
  append_little_endian(bytes, value);
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
Sha256& Sha256::update(double value) { return update(little_endian_bytes(value)); }
Sha256& Sha256::update(std::int32_t value) { return update(little_endian_bytes(value)); }
Sha256& Sha256::update(std::uint16_t value) { return update(little_endian_bytes(value)); }

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
  std::string text;
  for (std::int32_t y = 0; y < geometry.height; ++y) {
    field.read(y, row);
    text.clear();
    for (const std::uint16_t value : row) append_little_endian(text, value);
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
