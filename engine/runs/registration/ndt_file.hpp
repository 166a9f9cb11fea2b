// A map of normal distributions as a file, .ndt: some 40 bytes a cube, exact, so that files merge into what one map of
// all their points is (docs/formats.md). The same map gives the same bytes. Linear in the cubes.
#pragma once

#include <cstdint>
#include <string>

#include "engine/cloud/ndt_map.hpp"

namespace gdtslam {

/// Returns the size in bytes. Throws FileError.
std::uint64_t write_ndt(const std::string& path, const NdtMap& map);
/// Throws FileError, and InputError for any other bytes than write_ndt() writes.
NdtMap read_ndt(const std::string& path);
/// By the name's extension, .ndt in small or capital letters.
bool is_ndt_file(const std::string& path);

}  // namespace gdtslam
