#include "spirv_reader.hpp"

#include <array>
#include <optional>
#include <stdexcept>

namespace gdtslam::test {
namespace {

using Words = std::span<const std::uint32_t>;

constexpr std::uint32_t kMagic = 0x07230203;
constexpr std::size_t kHeaderWords = 5;

// Instructions.
constexpr std::uint32_t kExtension = 10;
constexpr std::uint32_t kExtInst = 12;
constexpr std::uint32_t kCapability = 17;
constexpr std::uint32_t kTypeBool = 20;
constexpr std::uint32_t kTypeInt = 21;
constexpr std::uint32_t kTypeFloat = 22;
constexpr std::uint32_t kTypeVector = 23;
constexpr std::uint32_t kTypeArray = 28;
constexpr std::uint32_t kTypeRuntimeArray = 29;
constexpr std::uint32_t kTypeStruct = 30;
constexpr std::uint32_t kTypePointer = 32;
constexpr std::uint32_t kConstant = 43;
constexpr std::uint32_t kSpecConstantComposite = 51;
constexpr std::uint32_t kVariable = 59;
constexpr std::uint32_t kDecorate = 71;
constexpr std::uint32_t kMemberDecorate = 72;
// Decorations.
constexpr std::uint32_t kSpecId = 1;
constexpr std::uint32_t kBuiltIn = 11;
constexpr std::uint32_t kNonWritable = 24;
constexpr std::uint32_t kBinding = 33;
constexpr std::uint32_t kOffset = 35;
constexpr std::uint32_t kNoContraction = 42;
constexpr std::uint32_t kWorkgroupSize = 25;  // a built-in
// Storage classes.
constexpr std::uint32_t kUniform = 2;
constexpr std::uint32_t kWorkgroup = 4;
constexpr std::uint32_t kPushConstant = 9;
constexpr std::uint32_t kStorageBuffer = 12;

struct FloatOperation {
  std::uint32_t opcode;
  const char* name;
};
constexpr FloatOperation kFloatOperations[] = {
    {127, "OpFNegate"},
    {129, "OpFAdd"},
    {131, "OpFSub"},
    {133, "OpFMul"},
    {136, "OpFDiv"},
    {140, "OpFRem"},
    {141, "OpFMod"},
    {142, "OpVectorTimesScalar"},
    {143, "OpMatrixTimesScalar"},
    {144, "OpVectorTimesMatrix"},
    {145, "OpMatrixTimesVector"},
    {146, "OpMatrixTimesMatrix"},
    {147, "OpOuterProduct"},
    {148, "OpDot"},
};

struct Instruction {
  std::uint32_t opcode = 0;
  Words operands;
};

struct Type {
  std::uint32_t opcode = 0;
  std::uint32_t bytes = 0;  ///< of a scalar or vector
  std::vector<std::uint32_t> parts;
};

std::string as_text(Words words) {
  std::string text;
  for (const std::uint32_t word : words) {
    for (std::uint32_t shift = 0; shift < 32; shift += 8) {
      const char c = static_cast<char>(word >> shift & 0xFFU);
      if (c == '\0') return text;
      text += c;
    }
  }
  return text;
}

class Reader {
 public:
  explicit Reader(Words words) {
    if (words.size() < kHeaderWords || words[0] != kMagic) throw std::runtime_error("no SPIR-V");
    for (std::size_t at = kHeaderWords; at < words.size();) {
      const std::size_t count = words[at] >> 16U;
      if (count == 0 || at + count > words.size())
        throw std::runtime_error("an instruction ends outside of the module");
      code_.push_back({words[at] & 0xFFFFU, words.subspan(at + 1, count - 1)});
      at += count;
    }
  }

  SpirvModule read() {
    for (const Instruction& instruction : code_) collect(instruction);
    for (const Instruction& instruction : code_) {
      if (instruction.opcode == kVariable) read_variable(instruction.operands);
      if (instruction.opcode == kSpecConstantComposite) read_local_size(instruction.operands);
    }
    for (const auto& [id, decorations] : decorations_) {
      if (const auto spec = decorations.find(kSpecId); spec != decorations.end()) {
        module_.specialization_constants.insert(spec->second);
      }
    }
    return module_;
  }

 private:
  void collect(const Instruction& instruction) {
    const Words ops = instruction.operands;
    switch (instruction.opcode) {
      case kCapability:
        module_.capabilities.insert(ops[0]);
        break;
      case kExtension:
        module_.extensions.insert(as_text(ops));
        break;
      case kExtInst:
        module_.library_functions.insert(ops[3]);
        break;
      case kDecorate:
        decorations_[ops[0]][ops[1]] = ops.size() > 2 ? ops[2] : 0;
        break;
      case kMemberDecorate:
        member_[{ops[0], ops[1]}][ops[2]] = ops.size() > 3 ? ops[3] : 0;
        break;
      case kConstant:
        constants_[ops[1]] = ops[2];
        break;
      default:
        collect_type(instruction);
        collect_arithmetic(instruction);
        break;
    }
  }

  void collect_type(const Instruction& instruction) {
    const Words ops = instruction.operands;
    Type type{instruction.opcode, 0, {}};
    switch (instruction.opcode) {
      case kTypeBool:
        break;
      case kTypeInt:
      case kTypeFloat:
        type.bytes = ops[1] / 8;
        break;
      case kTypeVector:
        type.bytes = types_.at(ops[1]).bytes * ops[2];
        break;
      case kTypeArray:
      case kTypeRuntimeArray:
      case kTypePointer:
      case kTypeStruct:
        type.parts.assign(ops.begin() + 1, ops.end());
        break;
      default:
        return;
    }
    types_[ops[0]] = type;
  }

  void collect_arithmetic(const Instruction& instruction) {
    for (const FloatOperation& operation : kFloatOperations) {
      if (operation.opcode != instruction.opcode) continue;
      module_.float_operations.insert(operation.opcode);
      // Decorations come before the code, so they are all known here.
      const auto decorated = decorations_.find(instruction.operands[1]);
      if (decorated == decorations_.end() || !decorated->second.contains(kNoContraction)) {
        module_.contractible.push_back(std::string(operation.name) + " %" + std::to_string(instruction.operands[1]));
      }
    }
  }

  /// Bytes of a type as far as they are fixed: 0 for what a specialisation constant decides.
  std::uint32_t bytes_of(std::uint32_t id) const {
    const auto found = types_.find(id);
    if (found == types_.end()) return 0;
    const Type& type = found->second;
    if (type.opcode == kTypeArray) {
      const auto length = constants_.find(type.parts[1]);
      return length == constants_.end() ? 0 : bytes_of(type.parts[0]) * length->second;
    }
    std::uint32_t sum = type.bytes;
    for (const std::uint32_t part : type.opcode == kTypeStruct ? type.parts : std::vector<std::uint32_t>{}) {
      sum += bytes_of(part);
    }
    return sum;
  }

  void read_variable(Words ops) {
    const std::uint32_t storage = ops[2];
    const std::uint32_t pointed = types_.at(ops[0]).parts[1];
    if (storage == kUniform || storage == kStorageBuffer) {
      SpirvBinding binding;
      binding.is_uniform = storage == kUniform;
      binding.is_read_only = is_read_only(ops[1], pointed);
      module_.bindings[decorations_.at(ops[1]).at(kBinding)] = binding;
    } else if (storage == kPushConstant) {
      read_push_constants(pointed);
    } else if (storage == kWorkgroup) {
      module_.shared_bytes += bytes_of(pointed);
    }
  }

  bool is_read_only(std::uint32_t variable, std::uint32_t block) {
    if (decorations_[variable].contains(kNonWritable)) return true;
    const std::size_t count = types_.at(block).parts.size();
    for (std::uint32_t i = 0; i < count; ++i) {
      if (!member_[{block, i}].contains(kNonWritable)) return false;
    }
    return count > 0;
  }

  void read_push_constants(std::uint32_t block, std::uint32_t base = 0) {
    const std::vector<std::uint32_t>& members = types_.at(block).parts;
    for (std::uint32_t i = 0; i < members.size(); ++i) {
      const std::uint32_t offset = base + member_[{block, i}].at(kOffset);
      if (types_.at(members[i]).opcode == kTypeStruct) {
        read_push_constants(members[i], offset);
        continue;
      }
      const bool is_in_place = offset == module_.push_constant_bytes && types_.at(members[i]).bytes == 4;
      module_.has_misaligned_push_constant |= !is_in_place;
      module_.push_constant_bytes = offset + types_.at(members[i]).bytes;
    }
  }

  void read_local_size(Words ops) {
    const auto& decorations = decorations_[ops[1]];
    const auto built_in = decorations.find(kBuiltIn);
    if (built_in == decorations.end() || built_in->second != kWorkgroupSize) return;
    for (const std::uint32_t part : ops.subspan(2)) {
      const auto& of_part = decorations_[part];
      if (const auto spec = of_part.find(kSpecId); spec != of_part.end()) {
        module_.local_size_constants.push_back(spec->second);
      }
    }
  }

  std::vector<Instruction> code_;
  SpirvModule module_;
  std::map<std::uint32_t, std::map<std::uint32_t, std::uint32_t>> decorations_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::map<std::uint32_t, std::uint32_t>> member_;
  std::map<std::uint32_t, Type> types_;
  std::map<std::uint32_t, std::uint32_t> constants_;
};

}  // namespace

SpirvModule read_spirv(std::span<const std::uint32_t> words) { return Reader(words).read(); }

}  // namespace gdtslam::test
