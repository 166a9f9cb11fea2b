// One hash of what logs became. Thread-safe.
#pragma once

#include <string>

#include "state.hpp"

namespace gdtslam {

/// SHA-256 of what a run folder has that must not differ between nodes: the bytes of its texts and of map.pgm, and by
/// the hashes of report.json what is packed (gdt.png, keyframes.bin.gz, tiles). Left out are report.json, which has
/// times, and pictures, which depend on the fonts of a machine. Throws InputError, FileError.
std::string result_sha256_of(const std::string& run_folder);

/// SHA-256 over a line for each unit, sorted: name of its run, hash of its log, mapped or refused, hash of its result.
/// So it depends on the logs' bytes, the configuration and the program, and not on the order and the places of the
/// logs, on shards, nodes, instruction sets or devices. Every unit has a record.
std::string atlas_sha256_of(const AtlasState& state);

}  // namespace gdtslam
