// What a SPIR-V module says about itself: enough to compare a shader with its kernel and to see that its arithmetic
// cannot be contracted. Reads the words by [Kessenich2019]; knows the instructions that our shaders are made of.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <string>
#include <vector>

namespace gdtslam::test {

/// A buffer of descriptor set 0.
struct SpirvBinding {
  bool is_uniform = false;    ///< a uniform buffer; else a storage buffer
  bool is_read_only = false;  ///< no member may be written
};

struct SpirvModule {
  std::set<std::uint32_t> capabilities;
  std::set<std::string> extensions;
  std::map<std::uint32_t, SpirvBinding> bindings;
  std::uint32_t push_constant_bytes = 0;
  bool has_misaligned_push_constant = false;         ///< a member that is no 4-byte scalar in its place
  std::vector<std::uint32_t> local_size_constants;   ///< SpecIds of the work group's size, x, y, z
  std::set<std::uint32_t> specialization_constants;  ///< every SpecId
  std::uint32_t shared_bytes = 0;                    ///< of work group memory, as far as its sizes are fixed
  std::vector<std::string> contractible;             ///< float arithmetic without NoContraction, by instruction
  std::set<std::uint32_t> float_operations;          ///< opcodes of the float arithmetic in use
  std::set<std::uint32_t> library_functions;         ///< of GLSL.std.450
};

/// Throws std::runtime_error for what is no SPIR-V.
SpirvModule read_spirv(std::span<const std::uint32_t> words);

}  // namespace gdtslam::test
