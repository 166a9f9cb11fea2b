#include "output_parts.hpp"

#include <fmt/format.h>

#include <array>
#include <cstddef>

namespace gdtslam {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array kFitSources{"option", "run", "resolution"};    // as FitLimit::Source has them
constexpr std::array kFieldSources{"distances", "occupied-cells"};  // as MapField::Source has them

}  // namespace

std::string fit_text(const FitLimit& fit) {
  const char* why = "as --poor-fit says";
  if (fit.source == FitLimit::Source::kRun) why = "99 of 100 scans of the run leave no more";
  if (fit.source == FitLimit::Source::kResolution) why = "two cells of the map";
  return fmt::format("a mean distance of more than {:.1f} mm is a poor fit: {}\n", 1000.0 * fit.distance_m, why);
}

Json fit_json(const FitLimit& fit) {
  return {{"distance_m", fit.distance_m},
          {"usual_m", fit.usual_m},
          {"from", kFitSources[static_cast<std::size_t>(fit.source)]}};
}

Json field_json(const MapField& field) {
  constexpr double kUnitsPerCell = 256.0;
  const double resolution_m = field.file.geometry.resolution_m;
  return {{"from", kFieldSources[static_cast<std::size_t>(field.source)]},
          {"resolution_m", resolution_m},
          {"truncation_m", resolution_m * static_cast<double>(field.file.cap) / kUnitsPerCell}};
}

Json share_json(const Share& share) {
  const bool is_any = share.of > 0;
  return {{"count", share.count},
          {"of", share.of},
          {"share", is_any ? Json(share.value()) : Json()},
          {"low_95", is_any ? Json(share.low()) : Json()},
          {"high_95", is_any ? Json(share.high()) : Json()}};
}

Json error_json(const ErrorSummary& error) {
  const auto value = [&error](double number) { return error.count > 0 ? Json(number) : Json(); };
  return {
      {"count", error.count}, {"mean", value(error.mean)}, {"median", value(error.median)}, {"max", value(error.max)}};
}

}  // namespace gdtslam
