// Shaders with one literal changed at one place: what a check of shaders must find. A mutant keeps the module valid:
// only constants that arithmetic, comparisons, selections and stores use are changed, never indices, sizes or scopes
// [Kessenich2019]. Thread-safe; O(words).
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace gdtslam::test {

/// A use of a constant: operand `operand` (word of the instruction) of the instruction that begins at word `at`.
struct ConstantUse {
  std::size_t at = 0;
  std::size_t operand = 0;
  std::uint32_t constant = 0;  ///< id
  std::string what;            ///< for messages: instruction and value
};

/// Every such use in the functions of a module, in order. Throws std::runtime_error for what is no SPIR-V.
std::vector<ConstantUse> constant_uses(std::span<const std::uint32_t> words);

/// The module with that use reading another constant: an integer one larger, a float a quarter larger (or 1 for 0).
std::vector<std::uint32_t> mutant(std::span<const std::uint32_t> words, const ConstantUse& use);

}  // namespace gdtslam::test
