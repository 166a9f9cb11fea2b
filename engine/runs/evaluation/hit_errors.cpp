#include "hit_errors.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <fstream>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "gdtslam/core/error.hpp"
#include "gdtslam/io/cloud_file.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kDoubles = 6;
constexpr std::size_t kWords = 3;
constexpr std::size_t kRowBytes = 8 * kDoubles + 4 * kWords;
constexpr std::string_view kVertices = "element vertex ";

// The lines of the header, without the number of rows.
constexpr std::array<std::string_view, 14> kHeader{"ply",
                                                   "format binary_little_endian 1.0",
                                                   "comment true hits of a simulated scan",
                                                   kVertices,
                                                   "property double x",
                                                   "property double y",
                                                   "property double z",
                                                   "property double elevation",
                                                   "property double time",
                                                   "property double range",
                                                   "property uint scan",
                                                   "property uint beam",
                                                   "property uint triangle",
                                                   "end_header"};

template <class Word>
Word word_at(const std::array<char, kRowBytes>& row, std::size_t begin) {
  Word word = 0;
  for (std::size_t byte = 0; byte < sizeof(Word); ++byte) {
    word |= static_cast<Word>(static_cast<unsigned char>(row[begin + byte])) << (8 * byte);
  }
  return word;
}

double double_at(const std::array<char, kRowBytes>& row, std::size_t column) {
  return std::bit_cast<double>(word_at<std::uint64_t>(row, 8 * column));
}

bool read_count(std::string_view line, std::uint64_t& count) {
  if (!line.starts_with(kVertices)) return false;
  line.remove_prefix(kVertices.size());
  const auto [end, code] = std::from_chars(line.data(), line.data() + line.size(), count);
  return code == std::errc{} && end == line.data() + line.size();
}

// A header's line is short; without an end the file has another format.
bool read_line(std::istream& file, std::string& line) {
  constexpr std::size_t kLongest = 80;
  line.clear();
  for (int c = file.get(); c != '\n'; c = file.get()) {
    if (c == std::char_traits<char>::eof() || line.size() == kLongest) return false;
    line += static_cast<char>(c);
  }
  return true;
}

/// The true hit of one beam; frame of the scene.
struct TrueHit {
  Eigen::Vector3d place_m{0.0, 0.0, 0.0};
  double stamp_s = 0.0;  ///< when the beam was fired
  double range_m = 0.0;  ///< from the sensor
  std::uint32_t scan = 0;
};

/// Reads the true hits of `simulate --truth-hits` (docs/simulation.md) row by row, in exactly that format. Memory does
/// not depend on the number of rows.
class HitReader {
 public:
  /// Throws FileError, or InputError for a file that has another format, is cut off or too long.
  explicit HitReader(const std::string& path);
  /// Returns no hit at the end. Throws InputError.
  std::optional<TrueHit> next();
  [[nodiscard]] std::uint64_t hits() const { return hits_; }

 private:
  std::string path_;
  std::ifstream file_;
  std::uint64_t hits_ = 0;
  std::uint64_t read_ = 0;
};

HitReader::HitReader(const std::string& path) : path_(path), file_(path, std::ios::binary) {
  if (!file_) throw FileError(path_, "cannot be opened");
  std::string line;
  for (std::size_t i = 0; i < kHeader.size(); ++i) {
    const bool fits =
        read_line(file_, line) && (kHeader[i] == kVertices ? read_count(line, hits_) : line == kHeader[i]);
    if (!fits) {
      throw InputError({path_, i + 1}, "is no file of true hits; `gdtslam simulate --truth-hits` writes one");
    }
  }
  const auto begin = file_.tellg();
  const auto bytes = static_cast<std::uint64_t>(file_.seekg(0, std::ios::end).tellg() - begin);
  file_.seekg(begin);
  if (!file_ || bytes % kRowBytes != 0 || bytes / kRowBytes != hits_) {
    throw InputError({path_, 0}, "has " + std::to_string(bytes) + " bytes of hits where its " + std::to_string(hits_) +
                                     " take " + std::to_string(kRowBytes) + " each; was it cut off?");
  }
}

std::optional<TrueHit> HitReader::next() {
  if (read_ == hits_) return std::nullopt;
  std::array<char, kRowBytes> row{};
  if (!file_.read(row.data(), static_cast<std::streamsize>(row.size()))) {
    throw FileError(path_,
                    "cannot be read after " + std::to_string(read_) + " of its " + std::to_string(hits_) + " hits");
  }
  ++read_;
  TrueHit hit{.place_m = {double_at(row, 0), double_at(row, 1), double_at(row, 2)},
              .stamp_s = double_at(row, 4),
              .range_m = double_at(row, 5),
              .scan = word_at<std::uint32_t>(row, 8 * kDoubles)};
  if (!hit.place_m.allFinite() || !std::isfinite(hit.stamp_s) || !(hit.range_m >= 0.0)) {
    throw InputError({path_, 0}, "hit " + std::to_string(read_) + " has a value that is not finite");
  }
  return hit;
}

constexpr std::size_t kPiece = 65536;
// Beams of a scan are at least some microseconds apart; the times of both files are doubles of the same sums.
constexpr double kSameBeam_s = 1e-6;
constexpr double kRangeStep_m = 0.1;
constexpr double kFarthest_m = 3000.0;

// The bound is linear in the range but expensive, so it is kept for each step of the range.
class BoundTable {
 public:
  explicit BoundTable(const Quantisation& quantisation) : quantisation_(quantisation) {}

  double at(double range_m) {
    const auto step = static_cast<std::size_t>(std::ceil(std::min(range_m, kFarthest_m) / kRangeStep_m));
    if (step >= bounds_m_.size()) bounds_m_.resize(step + 1, -1.0);
    double& bound_m = bounds_m_[step];
    if (bound_m < 0.0) {
      bound_m = calib::quantisation_bound_m(quantisation_.model, static_cast<double>(step) * kRangeStep_m,
                                            quantisation_.range_resolution_m);
    }
    return bound_m;
  }

 private:
  Quantisation quantisation_;
  std::vector<double> bounds_m_;
};

// The hits scan by scan, in step with the cloud.
class HitsByScan {
 public:
  explicit HitsByScan(const std::string& path) : reader_(path), ahead_(reader_.next()) {}

  /// Finds the hit of the beam at that time; null if it has none. Scans must not go back.
  const TrueHit* find(std::uint32_t scan, double stamp_s) {
    while (ahead_ && ahead_->scan <= scan) read_scan();
    if (hits_.empty() || hits_.front().scan != scan) return nullptr;
    const auto after = std::lower_bound(hits_.begin(), hits_.end(), stamp_s - kSameBeam_s,
                                        [](const TrueHit& hit, double t_s) { return hit.stamp_s < t_s; });
    return after != hits_.end() && after->stamp_s <= stamp_s + kSameBeam_s ? &*after : nullptr;
  }
  [[nodiscard]] std::uint64_t hits() const { return reader_.hits(); }

 private:
  void read_scan() {
    hits_.clear();
    const std::uint32_t scan = ahead_->scan;
    for (; ahead_ && ahead_->scan == scan; ahead_ = reader_.next()) hits_.push_back(*ahead_);
  }

  HitReader reader_;
  std::optional<TrueHit> ahead_;
  std::vector<TrueHit> hits_;
};

class Comparison {
 public:
  explicit Comparison(const HitErrorsJob& job) : job_(job), hits_(job.hits) {
    errors_.hits = hits_.hits();
    if (job.quantisation) {
      bounds_.emplace(*job.quantisation);
      errors_.bound.emplace();
    }
  }

  void add(const CloudPoint& point) {
    if (point.scan < last_scan_) {
      throw InputError({job_.cloud, 0}, "is not in the order of its scans, as `map` writes it");
    }
    last_scan_ = point.scan;
    const TrueHit* hit = hits_.find(point.scan, point.stamp_s);
    if (hit == nullptr) {
      ++errors_.without_hit;
      return;
    }
    const double distance_m = (job_.frame.in_truth(point) - hit->place_m).norm();
    errors_.distances.add(distance_m);
    if (errors_.bound) check(distance_m, bounds_->at(hit->range_m), *errors_.bound);
  }
  HitErrors& errors() { return errors_; }

 private:
  static void check(double distance_m, double bound_m, BoundCheck& bound) {
    bound.beyond += distance_m > bound_m ? 1U : 0U;
    bound.largest_bound_m = std::max(bound.largest_bound_m, bound_m);
    if (bound_m > 0.0) bound.largest_share = std::max(bound.largest_share, distance_m / bound_m);
  }

  const HitErrorsJob& job_;
  HitsByScan hits_;
  std::optional<BoundTable> bounds_;
  std::uint32_t last_scan_ = 0;
  HitErrors errors_;
};

}  // namespace

HitErrors hit_errors(const HitErrorsJob& job) {
  CloudReader cloud(job.cloud);
  if (!cloud.header().has_scan || !cloud.header().has_time) {
    throw InputError({job.cloud, 0}, "does not tell scan and time of its points, so their beams cannot be found");
  }
  Comparison comparison(job);
  HitErrors& errors = comparison.errors();
  const auto expected = static_cast<double>(std::max<std::uint64_t>(cloud.header().points, 1));
  std::uint64_t done = 0;
  for (Cloud piece = cloud.next(kPiece); !piece.empty(); piece = cloud.next(kPiece)) {
    for (const CloudPoint& point : piece) comparison.add(point);
    done += piece.size();
    if (job.progress) job.progress(done, static_cast<double>(done) / expected);
    if (job.stop && job.stop()) {
      errors.interrupted = true;
      break;
    }
  }
  if (errors.distances.count() == 0 && !errors.interrupted) {
    throw InputError({job.cloud, 0}, "has no point whose beam is in " + job.hits + "; do both belong to the same log?");
  }
  return std::move(errors);
}

}  // namespace gdtslam
