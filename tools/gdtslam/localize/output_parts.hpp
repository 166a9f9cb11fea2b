// Parts of what `gdtslam localize` tells that single scans and a drive have in common. Thread-safe, constant time.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "engine/runs/evaluation/errors.hpp"
#include "engine/runs/localizer/map_field.hpp"
#include "engine/runs/localizer/reference.hpp"
#include "gdtslam/mapping/evaluation.hpp"

namespace gdtslam {

/// "a mean distance of more than 25.0 mm is a poor fit: ..."
std::string fit_text(const FitLimit& fit);

nlohmann::ordered_json fit_json(const FitLimit& fit);
nlohmann::ordered_json field_json(const MapField& field);
nlohmann::ordered_json share_json(const Share& share);
nlohmann::ordered_json error_json(const ErrorSummary& error);

}  // namespace gdtslam
