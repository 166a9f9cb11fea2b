// Clouds into files and out of them, beside the same bytes by fwrite and fread, and thinning beside the standard
// library's set of cells.
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <unordered_set>
#include <utility>
#include <vector>

#include "gdtslam/cloud/thinning.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/core/random.hpp"
#include "gdtslam/io/cloud_file.hpp"
#include "rows.hpp"
#include "tools/gdtslam/shell/folders.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kPoints = 1'000'000;
constexpr std::size_t kPiece = 65536;
constexpr std::size_t kPointBytes = 28;
constexpr double kVoxel_m = 0.02;

void write_cloud(const std::string& path, const Cloud& cloud) {
  CloudWriter writer(path, CloudFormat::kPlyBinary);
  for (std::size_t k = 0; k < cloud.size(); k += kPiece) {
    writer.add(std::span(cloud).subspan(k, std::min(kPiece, cloud.size() - k)));
  }
  writer.finish();
}

void read_cloud_in_pieces(const std::string& path) {
  CloudReader reader(path);
  std::size_t points = 0;
  for (Cloud piece = reader.next(kPiece); !piece.empty(); piece = reader.next(kPiece)) points += piece.size();
  if (points != kPoints) throw Error(ExitCode::kFailed, "bench: the cloud did not come back whole");
}

using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

void plain_write(const std::string& path, const std::vector<char>& bytes) {
  const File file(std::fopen(path.c_str(), "wb"), std::fclose);
  if (!file || std::fwrite(bytes.data(), 1, bytes.size(), file.get()) != bytes.size()) {
    throw FileError(path, "cannot be written");
  }
}

void plain_read(const std::string& path, std::vector<char>& bytes) {
  const File file(std::fopen(path.c_str(), "rb"), std::fclose);
  if (!file || std::fread(bytes.data(), 1, bytes.size(), file.get()) != bytes.size()) {
    throw FileError(path, "cannot be read");
  }
}

std::size_t thin(const Cloud& cloud) {
  CountingSink sink;
  VoxelThinning thinning(kVoxel_m, std::uint64_t{1} << 24U, sink);
  for (std::size_t k = 0; k < cloud.size(); k += kPiece) {
    thinning.add(std::span(cloud).subspan(k, std::min(kPiece, cloud.size() - k)));
  }
  return sink.count;
}

std::size_t thin_by_set(const Cloud& cloud) {
  std::unordered_set<std::uint64_t> cells;
  for (const CloudPoint& p : cloud) {
    const auto cell = [](float x) {
      constexpr std::int64_t kMiddle = 1 << 20;
      return static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(static_cast<double>(x) / kVoxel_m)) +
                                        kMiddle);
    };
    cells.insert(cell(p.x_m) << 42U | cell(p.y_m) << 21U | cell(p.z_m));
  }
  return cells.size();
}

/// A cloud, as a file and as bytes in another.
struct CloudFiles {
  Cloud cloud = bench_hall(kPoints);
  std::vector<char> bytes = std::vector<char>(kPoints * kPointBytes, 'x');
  TemporaryFolder folder{"gdtslam-bench", bench_folder()};
  std::string file = folder.path() + "/cloud.ply";
  std::string plain_file = folder.path() + "/plain";
  CloudFiles() {
    write_cloud(file, cloud);
    plain_write(plain_file, bytes);
    if (thin(cloud) != thin_by_set(cloud)) throw Error(ExitCode::kFailed, "bench: the thinnings differ");
  }
};

}  // namespace

Cloud bench_hall(std::size_t points) {
  Random random(1);
  Cloud cloud(points);
  for (std::size_t k = 0; k < points; ++k) {
    const auto along = static_cast<float>(random.uniform(-20.0, 20.0));
    const auto across = static_cast<float>(random.uniform(-10.0, 10.0));
    const auto up = static_cast<float>(random.uniform(0.0, 4.0));
    CloudPoint& p = cloud[k];
    switch (k % 4) {
      case 0:
        p = {.x_m = along, .y_m = across, .z_m = 0.01F * up};
        break;
      case 1:
        p = {.x_m = along, .y_m = across, .z_m = 4.0F + 0.01F * up};
        break;
      case 2:
        p = {.x_m = along, .y_m = 10.0F, .z_m = up};
        break;
      default:
        p = {.x_m = 20.0F, .y_m = across, .z_m = up};
    }
    p.elevation_rad = 0.1F * up;
    p.stamp_s = 1e9 + 1e-5 * static_cast<double>(k);
    p.scan = static_cast<std::uint32_t>(k / 361);
  }
  return cloud;
}

void add_clouds(const BenchTarget& cpu) {
  const auto files = shared_by_rows([] { return std::make_shared<CloudFiles>(); });
  const auto add = [&cpu, &files](const char* group, const char* name, const char* variant, auto step) {
    add_row(cpu, group, name, variant, [files, step](benchmark::State& state) {
      time_work(state, {.step = [&files = files(), &step] { step(files); }}, kPoints, "point");
    });
  };
  add("cloud", "cloud_write", "binary PLY, SHA-256", [](CloudFiles& f) { write_cloud(f.file, f.cloud); });
  add("cloud", "cloud_read", "binary PLY", [](CloudFiles& f) { read_cloud_in_pieces(f.file); });
  add("cloud", "cloud_thin", "2 cm", [](CloudFiles& f) { thin(f.cloud); });
  add("peer", "cloud_write", "fwrite", [](CloudFiles& f) { plain_write(f.plain_file, f.bytes); });
  add("peer", "cloud_read", "fread", [](CloudFiles& f) { plain_read(f.plain_file, f.bytes); });
  add("peer", "cloud_thin", "unordered_set", [](CloudFiles& f) { thin_by_set(f.cloud); });
}

}  // namespace gdtslam
