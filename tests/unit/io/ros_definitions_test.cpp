// The definitions of messages that recordings carry, against the sums by which ROS 1 knows the types: the MD5 of the
// fields as ROS 1 has them, where the sum of a type stands in place of its name. The sums are those of the published
// packages.
#include <gtest/gtest.h>
#include <openssl/evp.h>

#include <array>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "engine/io/writers/ros_messages.hpp"

namespace gdtslam {
namespace {

std::string md5(const std::string& text) {
  std::array<unsigned char, EVP_MAX_MD_SIZE> sum{};
  unsigned size = 0;
  EVP_Digest(text.data(), text.size(), sum.data(), &size, EVP_md5(), nullptr);
  std::string hex;
  for (unsigned i = 0; i < size; ++i) {
    constexpr const char* kDigits = "0123456789abcdef";
    hex += kDigits[sum.at(i) / 16];
    hex += kDigits[sum.at(i) % 16];
  }
  return hex;
}

// The fields of the type itself under "", those of the types in it under their names without the package.
std::map<std::string, std::vector<std::string>> parts_of(const std::string& definition) {
  std::map<std::string, std::vector<std::string>> parts;
  std::string name;
  std::istringstream lines(definition);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("====") || line.empty()) continue;
    if (line.starts_with("MSG: ")) {
      name = line.substr(line.rfind('/') + 1);
      EXPECT_EQ(parts.count(name), 0U) << name << " is there twice";
      parts[name];
    } else {
      parts[name].push_back(line);
    }
  }
  return parts;
}

std::string sum_of(const std::string& name, const std::map<std::string, std::vector<std::string>>& parts) {
  std::string text;
  for (const std::string& field : parts.at(name)) {
    std::string type = field.substr(0, field.find(' '));
    std::string bare = type.substr(0, type.find('['));
    bare = bare.substr(bare.rfind('/') + 1);  // npos + 1 is 0
    const bool is_message = parts.count(bare) > 0;
    text += (text.empty() ? "" : "\n") + (is_message ? sum_of(bare, parts) : type) + field.substr(field.find(' '));
  }
  return md5(text);
}

/// The same type in ROS 1: a time is simple there, and a header has a number.
std::map<std::string, std::vector<std::string>> as_of_ros1(std::map<std::string, std::vector<std::string>> parts) {
  for (auto& [name, fields] : parts) {
    for (std::string& field : fields) {
      constexpr std::string_view kTime = "builtin_interfaces/Time";
      if (field.starts_with(kTime)) field.replace(0, kTime.size(), "time");
    }
    if (name == "Header") fields.insert(fields.begin(), "uint32 seq");
  }
  parts.erase("Time");
  return parts;
}

constexpr std::array<std::pair<RosType, const char*>, 7> kPublished{
    {{RosType::kLaserScan, "90c7ef2dc6895d81024acba2ac42f369"},
     {RosType::kOdometry, "cd5e73d190d741a2f92e81eda573aca7"},
     {RosType::kTransforms, "94810edda583a504dfda3829e70d7eec"},
     {RosType::kInt32, "da5909fbe378aeaf85e547e830cc1bb7"},
     {RosType::kJointState, "3066dcd76a6cfaef579bd0f34173e9fd"},
     {RosType::kPoseStamped, "d3812c3cbc69362b77dc0b19b345f8f5"},
     {RosType::kOccupancyGrid, "3381f2d731d4076ec5c71b0759edbe4e"}}};

TEST(RosDefinitions, HaveThePublishedSums) {
  for (const auto& [type, sum] : kPublished) {
    EXPECT_EQ(sum_of("", as_of_ros1(parts_of(ros_definition(type)))), sum) << ros_definition(type);
  }
}

}  // namespace
}  // namespace gdtslam
