#include "spirv_mutants.hpp"

#include <fmt/format.h>

#include <bit>
#include <map>
#include <set>
#include <stdexcept>

namespace gdtslam::test {
namespace {

constexpr std::uint32_t kMagic = 0x07230203;
constexpr std::size_t kHeaderWords = 5;
constexpr std::size_t kBoundWord = 3;

enum Op : std::uint32_t {
  kTypeInt = 21,
  kTypeFloat = 22,
  kConstant = 43,
  kStore = 62,
};

/// Instructions whose operands from word 3 on are values, with their names. OpStore, whose object is word 2, is apart.
const std::map<std::uint32_t, const char*> kArithmetic{
    {128, "IAdd"},
    {129, "FAdd"},
    {130, "ISub"},
    {131, "FSub"},
    {132, "IMul"},
    {133, "FMul"},
    {134, "UDiv"},
    {135, "SDiv"},
    {136, "FDiv"},
    {137, "UMod"},
    {139, "SMod"},
    {164, "LogicalEqual"},
    {169, "Select"},
    {170, "IEqual"},
    {171, "INotEqual"},
    {172, "UGreaterThan"},
    {173, "SGreaterThan"},
    {174, "UGreaterThanEqual"},
    {175, "SGreaterThanEqual"},
    {176, "ULessThan"},
    {177, "SLessThan"},
    {178, "ULessThanEqual"},
    {179, "SLessThanEqual"},
    {180, "FOrdEqual"},
    {184, "FOrdLessThan"},
    {186, "FOrdGreaterThan"},
    {188, "FOrdLessThanEqual"},
    {190, "FOrdGreaterThanEqual"},
    {194, "ShiftRightLogical"},
    {195, "ShiftRightArithmetic"},
    {196, "ShiftLeftLogical"},
    {197, "BitwiseOr"},
    {198, "BitwiseXor"},
    {199, "BitwiseAnd"},
};

struct Constant {
  std::size_t at = 0;
  bool is_float = false;
  std::uint32_t bits = 0;
};

std::string as_text(const Constant& constant) {
  return constant.is_float ? fmt::format("{:.9g}", std::bit_cast<float>(constant.bits)) : std::to_string(constant.bits);
}

std::size_t length_at(std::span<const std::uint32_t> words, std::size_t at) {
  const std::size_t length = words[at] >> 16U;
  if (length == 0 || at + length > words.size()) throw std::runtime_error("SPIR-V: an instruction without length");
  return length;
}

/// Calls `visit(at, opcode, length)` for every instruction.
template <class Visit>
void walk(std::span<const std::uint32_t> words, Visit visit) {
  if (words.size() < kHeaderWords || words[0] != kMagic) throw std::runtime_error("this is no SPIR-V");
  for (std::size_t at = kHeaderWords; at < words.size(); at += length_at(words, at)) {
    visit(at, words[at] & 0xFFFFU, length_at(words, at));
  }
}

/// The constants of 32-bit integers and floats by id.
std::map<std::uint32_t, Constant> constants_of(std::span<const std::uint32_t> words) {
  std::set<std::uint32_t> floats;
  std::set<std::uint32_t> numbers;
  std::map<std::uint32_t, Constant> constants;
  walk(words, [&](std::size_t at, std::uint32_t opcode, std::size_t length) {
    if (opcode == kTypeFloat) floats.insert(words[at + 1]);
    if (opcode == kTypeFloat || opcode == kTypeInt) numbers.insert(words[at + 1]);
    if (opcode == kConstant && length == 4 && numbers.contains(words[at + 1])) {
      constants[words[at + 2]] = {at, floats.contains(words[at + 1]), words[at + 3]};
    }
  });
  return constants;
}

std::uint32_t changed(const Constant& constant) {
  if (!constant.is_float) return constant.bits + 1;
  const float value = std::bit_cast<float>(constant.bits);
  return std::bit_cast<std::uint32_t>(value == 0.0F ? 1.0F : value * 1.25F);
}

}  // namespace

std::vector<ConstantUse> constant_uses(std::span<const std::uint32_t> words) {
  const std::map<std::uint32_t, Constant> constants = constants_of(words);
  std::vector<ConstantUse> uses;
  walk(words, [&](std::size_t at, std::uint32_t opcode, std::size_t length) {
    const auto arithmetic = kArithmetic.find(opcode);
    if (arithmetic == kArithmetic.end() && opcode != kStore) return;
    const char* const name = opcode == kStore ? "Store" : arithmetic->second;
    for (std::size_t k = opcode == kStore ? 2 : 3; k < (opcode == kStore ? 3 : length); ++k) {
      const auto constant = constants.find(words[at + k]);
      if (constant == constants.end()) continue;
      uses.push_back({at, k, words[at + k], std::string(name) + " " + as_text(constant->second)});
    }
  });
  return uses;
}

std::vector<std::uint32_t> mutant(std::span<const std::uint32_t> words, const ConstantUse& use) {
  const Constant constant = constants_of(words).at(use.constant);
  std::vector<std::uint32_t> result(words.begin(), words.end());
  const std::uint32_t id = result[kBoundWord]++;
  result[use.at + use.operand] = id;
  const std::uint32_t replacement[] = {words[constant.at], words[constant.at + 1], id, changed(constant)};
  result.insert(result.begin() + static_cast<std::ptrdiff_t>(constant.at), std::begin(replacement),
                std::end(replacement));
  return result;
}

}  // namespace gdtslam::test
