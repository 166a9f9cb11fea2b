#include "cloud_output.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <system_error>
#include <utility>

#include "cloud_sample.hpp"

namespace gdtslam {
namespace {

using namespace std::string_view_literals;

constexpr std::array kRemovals{"none"sv, "floor"sv, "ceiling"sv, "both"sv};
constexpr std::size_t kPieces = 65536;

std::uint64_t most_voxels(const CloudConfig& config) {
  return static_cast<std::uint64_t>(config.max_megavoxels) << 20U;
}

// Only the surfaces to be removed.
LevelSurfaces wanted(LevelSurfaces surfaces, CloudRemoval removal) {
  if (removal == CloudRemoval::kCeiling) surfaces.floor.reset();
  if (removal == CloudRemoval::kFloor) surfaces.ceiling.reset();
  return surfaces;
}

}  // namespace

std::vector<Option> option_table(CloudConfig& config) {
  return {
      {"cloud.voxel", "Edge of the cubes that the cloud is thinned by, of whose points one is kept; 0 keeps all",
       Unit::kMetre, 0.0, 10.0, &config.voxel_m},
      {"cloud.max_megavoxels",
       "Most cubes that thinning may remember, in units of 2^20, which take 16 to 32 MiB of memory each", Unit::kNone,
       1, 16384, &config.max_megavoxels},
      {"cloud.remove",
       "What is left out of the cloud: the floor, the ceiling or both, found as planes and not by height", Unit::kNone,
       0, 0, Choice(config.remove, kRemovals)},
      {"cloud.remove_margin", "Distance from the floor or ceiling within which points are left out with it",
       Unit::kMetre, 0.0, 1.0, &config.remove_margin_m},
  };
}

CloudOutput::CloudOutput(const CloudConfig& config, std::string path) : config_(config), path_(std::move(path)) {
  if (config_.remove != CloudRemoval::kNone) spool_ = path_ + ".spool";
  const std::string& target = spool_.empty() ? path_ : spool_;
  writer_ = std::make_unique<CloudWriter>(target, CloudFormat::kPlyBinary);
  summary_.voxel_m = config_.voxel_m;
  if (config_.voxel_m > 0.0)
    thinning_ = std::make_unique<VoxelThinning>(config_.voxel_m, most_voxels(config_), *writer_);
}

// A full memory does not end the run: later points are thinned by cubes twice as large.
void CloudOutput::coarsen() {
  summary_.voxel_m *= 2.0;
  thinning_ = std::make_unique<VoxelThinning>(summary_.voxel_m, most_voxels(config_), *writer_);
}

CloudOutput::~CloudOutput() {
  std::error_code ignored;  // the spool may be gone already
  if (!spool_.empty()) std::filesystem::remove(spool_, ignored);
}

void CloudOutput::add(std::span<const CloudPoint> points) {
  summary_.measured += points.size();
  if (thinning_) {
    for (; !points.empty(); points = points.subspan(std::min(points.size(), kPieces))) {
      const std::span<const CloudPoint> piece = points.first(std::min(points.size(), kPieces));
      if (thinning_->kept() + piece.size() > most_voxels(config_)) coarsen();
      thinning_->add(piece);
    }
  } else {
    writer_->add(points);
  }
}

CloudSummary CloudOutput::finish() {
  summary_.thinned = writer_->points();
  writer_->finish();
  if (!spool_.empty()) {
    CloudReader spool(spool_);
    CloudSample sample;
    for (Cloud piece = spool.next(kPieces); !piece.empty(); piece = spool.next(kPieces)) sample.add(piece);
    summary_.surfaces = wanted(find_level_surfaces(sample.points(), {}), config_.remove);
    CloudReader again(spool_);
    writer_ = std::make_unique<CloudWriter>(path_, CloudFormat::kPlyBinary);
    LevelRemoval removal(summary_.surfaces, config_.remove_margin_m, *writer_);
    for (Cloud piece = again.next(kPieces); !piece.empty(); piece = again.next(kPieces)) removal.add(piece);
    summary_.removed = removal.removed();
    writer_->finish();
  }
  summary_.written = writer_->points();
  summary_.sha256 = writer_->points_sha256();
  return summary_;
}

}  // namespace gdtslam
