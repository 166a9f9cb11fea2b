// Laws of clouds in files: what is written reads back, and any layout of columns gives the values that were put in.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <numeric>

#include "gdtslam/core/error.hpp"
#include "gdtslam/io/cloud_file.hpp"
#include "support/lzf_packer.hpp"

namespace gdtslam {
namespace {

using test::pack_lzf;

std::span<const std::byte> text_bytes(const std::string& text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

Cloud all_of(CloudReader& reader, std::size_t most) {
  Cloud cloud;
  for (Cloud piece = reader.next(most); !piece.empty(); piece = reader.next(most)) {
    RC_ASSERT(piece.size() <= most);
    cloud.insert(cloud.end(), piece.begin(), piece.end());
  }
  return cloud;
}

Cloud read_bytes(const std::string& file) {
  CloudReader reader(text_bytes(file), "prop");
  return all_of(reader, 65536);
}

float finite_float() {
  return *rc::gen::suchThat(
      rc::gen::map(rc::gen::arbitrary<std::uint32_t>(), [](std::uint32_t bits) { return std::bit_cast<float>(bits); }),
      [](float value) { return std::isfinite(value); });
}

double finite_double() {
  return *rc::gen::suchThat(
      rc::gen::map(rc::gen::arbitrary<std::uint64_t>(), [](std::uint64_t bits) { return std::bit_cast<double>(bits); }),
      [](double value) { return std::isfinite(value); });
}

CloudPoint any_point() {
  return {.x_m = finite_float(),
          .y_m = finite_float(),
          .z_m = finite_float(),
          .elevation_rad = finite_float(),
          .stamp_s = finite_double(),
          .scan = *rc::gen::arbitrary<std::uint32_t>()};
}

bool same_bits(const CloudPoint& a, const CloudPoint& b) {
  const auto bits = [](float value) { return std::bit_cast<std::uint32_t>(value); };
  return bits(a.x_m) == bits(b.x_m) && bits(a.y_m) == bits(b.y_m) && bits(a.z_m) == bits(b.z_m) &&
         bits(a.elevation_rad) == bits(b.elevation_rad) &&
         std::bit_cast<std::uint64_t>(a.stamp_s) == std::bit_cast<std::uint64_t>(b.stamp_s) && a.scan == b.scan;
}

// In memory where the system has such a folder: a hundred times four files wait for a disk for seconds.
std::string own_file() {
  const std::filesystem::path memory = "/dev/shm";
  const bool has_memory = ::access(memory.c_str(), W_OK) == 0;
  return ((has_memory ? memory : std::filesystem::temp_directory_path()) / fmt::format("cloud-prop-{}", ::getpid()))
      .string();
}

RC_GTEST_PROP(CloudLaws, EveryPointReadsBackToTheBitInEveryFormat, ()) {
  const std::string path = own_file();
  Cloud cloud(*rc::gen::inRange<std::size_t>(0, 40));
  for (CloudPoint& point : cloud) point = any_point();
  std::string sha256;
  for (const CloudFormat format : {CloudFormat::kPlyBinary, CloudFormat::kPcdBinary}) {
    CloudWriter writer(path, format);
    const auto split = *rc::gen::inRange<std::size_t>(0, cloud.size() + 1);
    writer.add(std::span(cloud).first(split));
    writer.add(std::span(cloud).subspan(split));
    writer.finish();
    RC_ASSERT(writer.points() == cloud.size());
    RC_ASSERT(sha256.empty() || sha256 == writer.points_sha256());
    sha256 = writer.points_sha256();
    CloudReader reader(path);
    RC_ASSERT(reader.header().points == cloud.size());
    RC_ASSERT(reader.header().has_elevation && reader.header().has_time && reader.header().has_scan);
    const Cloud read = all_of(reader, *rc::gen::inRange<std::size_t>(1, 50));
    RC_ASSERT(std::equal(read.begin(), read.end(), cloud.begin(), cloud.end(), same_bits));
    RC_ASSERT(reader.skipped() == 0U);
  }
  std::filesystem::remove(path);
}

/// One scalar type of the two formats, and how the test puts a value of it.
struct Type {
  const char* ply;
  const char* pcd_type;
  int bytes;
  double least;
  double most;
  bool is_float;
};
constexpr std::array<Type, 10> kTypes{{{"char", "I", 1, -128, 127, false},
                                       {"uint8", "U", 1, 0, 255, false},
                                       {"short", "I", 2, -32768, 32767, false},
                                       {"uint16", "U", 2, 0, 65535, false},
                                       {"int", "I", 4, -2147483648.0, 2147483647, false},
                                       {"uint", "U", 4, 0, 4294967295.0, false},
                                       {"int64", "I", 8, -9e15, 9e15, false},
                                       {"uint64", "U", 8, 0, 9e15, false},
                                       {"float32", "F", 4, -1e6, 1e6, true},
                                       {"double", "F", 8, -1e6, 1e6, true}}};

std::string encoded(const Type& type, double value, bool is_big_endian) {
  std::uint64_t bits = 0;
  if (type.is_float && type.bytes == 4) {
    bits = std::bit_cast<std::uint32_t>(static_cast<float>(value));
  } else if (type.is_float) {
    bits = std::bit_cast<std::uint64_t>(value);
  } else {
    bits = static_cast<std::uint64_t>(static_cast<std::int64_t>(value));
  }
  std::string text;
  for (int k = 0; k < type.bytes; ++k) text += static_cast<char>(bits >> (8 * k) & 255U);
  if (is_big_endian) std::reverse(text.begin(), text.end());
  return text;
}

struct TestColumn {
  std::string name;
  const Type* type;
  std::vector<double> values;
  bool is_list = false;
};

// x, y, z, perhaps others of ours, columns that mean nothing, lists: in any order, of any type.
std::vector<TestColumn> any_columns(std::size_t points, bool lists) {
  std::vector<TestColumn> columns;
  const auto add = [&](std::string name, double least, double most) {
    TestColumn column{std::move(name), &kTypes[*rc::gen::inRange<std::size_t>(0, kTypes.size())], {}};
    for (std::size_t k = 0; k < points; ++k) {
      const double low = std::max(least, column.type->least);
      const double high = std::min(most, column.type->most);
      const double value = low + (high - low) * *rc::gen::inRange(0, 1001) / 1000.0;
      column.values.push_back(column.type->is_float ? static_cast<double>(static_cast<float>(value))
                                                    : std::round(value));
    }
    columns.push_back(std::move(column));
  };
  constexpr double kFar = 1e5;
  for (const char* name : {"x", "y", "z"}) add(name, -kFar, kFar);
  if (*rc::gen::arbitrary<bool>()) add("elevation", -2.0, 2.0);
  if (*rc::gen::arbitrary<bool>()) add("time", -1e15, 1e15);
  if (*rc::gen::arbitrary<bool>()) add("scan", 0.0, 4e9);
  for (TestColumn& column : columns) {
    if (column.name != "scan") continue;
    for (double& value : column.values) value = std::floor(value);
  }
  for (int k = *rc::gen::inRange(0, 4); k > 0; --k) add(fmt::format("other{}", k), -1e9, 1e9);
  if (lists && *rc::gen::arbitrary<bool>()) {
    add("x", 0.0, 3.0);  // a list of this name is no coordinate
    columns.back().is_list = true;
  }
  for (std::size_t k = columns.size(); k > 1; --k)
    std::swap(columns[k - 1], columns[*rc::gen::inRange<std::size_t>(0, k)]);
  return columns;
}

Cloud expected_of(const std::vector<TestColumn>& columns, std::size_t points) {
  Cloud cloud(points);
  for (const TestColumn& column : columns) {
    for (std::size_t k = 0; k < points && !column.is_list; ++k) {
      const double value = column.values[k];
      if (column.name == "x") cloud[k].x_m = static_cast<float>(value);
      if (column.name == "y") cloud[k].y_m = static_cast<float>(value);
      if (column.name == "z") cloud[k].z_m = static_cast<float>(value);
      if (column.name == "elevation") cloud[k].elevation_rad = static_cast<float>(value);
      if (column.name == "time") cloud[k].stamp_s = value;
      if (column.name == "scan") cloud[k].scan = static_cast<std::uint32_t>(value);
    }
  }
  return cloud;
}

RC_GTEST_PROP(CloudLaws, PlyOfAnyLayoutGivesTheValuesPutIn, ()) {
  const auto points = *rc::gen::inRange<std::size_t>(0, 8);
  const std::vector<TestColumn> columns = any_columns(points, true);
  const int form = *rc::gen::inRange(0, 3);
  const bool is_ascii = form == 0;
  const std::string end = *rc::gen::arbitrary<bool>() ? "\n" : "\r\n";
  const bool has_before = *rc::gen::arbitrary<bool>();
  const bool has_behind = *rc::gen::arbitrary<bool>();
  std::string file =
      "ply" + end + "format " +
      std::array{"ascii", "binary_little_endian", "binary_big_endian"}.at(static_cast<std::size_t>(form)) + " 1.0" +
      end + "comment any, \xff" + end + "obj_info 1" + end;
  if (has_before) file += "element camera 2" + end + "property list uchar short ids" + end + "property double f" + end;
  file += fmt::format("element vertex {}", points) + end;
  for (const TestColumn& column : columns) {
    file += fmt::format("property {}{} {}", column.is_list ? "list uint8 " : "", column.type->ply, column.name) + end;
  }
  if (has_behind) file += "element face 1" + end + "property list uchar int vertex_indices" + end;
  file += "end_header" + end;
  const auto put = [&](const Type& type, double value) {
    file += is_ascii ? fmt::format("{} ", value) : encoded(type, value, form == 2);
  };
  const auto end_item = [&] { file += is_ascii ? end : ""; };
  for (int k = 0; k < 2 && has_before; ++k) {
    put(kTypes[1], 2.0);
    for (const double id : {1.0, -7.0}) put(kTypes[2], id);
    put(kTypes[9], 0.25);
    end_item();
  }
  for (std::size_t k = 0; k < points; ++k) {
    for (const TestColumn& column : columns) {
      if (column.is_list) put(kTypes[1], static_cast<double>(k % 3));
      for (std::size_t item = 0; item < (column.is_list ? k % 3 : 1); ++item) put(*column.type, column.values[k]);
    }
    end_item();
  }
  if (has_behind) put(kTypes[1], 0.0), end_item();
  RC_ASSERT(read_bytes(file) == expected_of(columns, points));
}

RC_GTEST_PROP(CloudLaws, PcdOfAnyLayoutGivesTheValuesPutIn, ()) {
  const auto points = *rc::gen::inRange<std::size_t>(0, 20);
  const std::vector<TestColumn> columns = any_columns(points, false);
  const std::string data = *rc::gen::element<std::string>("ascii", "binary", "binary_compressed");
  std::string fields = "FIELDS";
  std::string sizes = "SIZE";
  std::string types = "TYPE";
  std::string counts = "COUNT";
  for (const TestColumn& column : columns) {
    fields += " " + column.name;
    sizes += fmt::format(" {}", column.type->bytes);
    types += fmt::format(" {}", column.type->pcd_type);
    counts += column.name.starts_with("other") ? " 2" : " 1";
  }
  const bool is_organised = points % 2 == 0 && points > 0;
  std::string file = fmt::format(
      "# .PCD v.7\nVERSION .7\n{}\n{}\n{}\n{}\nWIDTH {}\nHEIGHT {}\nVIEWPOINT 0 0 0 1 0 0 0\n"
      "POINTS {}\nDATA {}\n",
      fields, sizes, types, counts, is_organised ? points / 2 : points, is_organised ? 2 : 1, points, data);
  std::string body;
  const auto put = [&](const TestColumn& column, std::size_t k) {
    for (int times = column.name.starts_with("other") ? 2 : 1; times > 0; --times) {
      body += data == "ascii" ? fmt::format("{} ", column.values[k]) : encoded(*column.type, column.values[k], false);
    }
  };
  if (data == "binary_compressed") {
    for (const TestColumn& column : columns) {
      for (std::size_t k = 0; k < points; ++k) put(column, k);
    }
    const std::string packed = pack_lzf(body);
    body = encoded(kTypes[5], static_cast<double>(packed.size()), false) +
           encoded(kTypes[5], static_cast<double>(body.size()), false) + packed;
  } else {
    for (std::size_t k = 0; k < points; ++k) {
      for (const TestColumn& column : columns) put(column, k);
      if (data == "ascii") body += "\n";
    }
  }
  RC_ASSERT(read_bytes(file + body) == expected_of(columns, points));
}

// Damage anywhere ends in points or in an InputError, never in anything else.
RC_GTEST_PROP(CloudLaws, DamagedBytesAreReadOrRefused, ()) {
  std::string file =
      "# .PCD v.7\nVERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 20\nHEIGHT 1\nPOINTS 20\n"
      "DATA binary_compressed\n";
  const std::string packed = pack_lzf(std::string(240, '\1'));
  file += encoded(kTypes[5], static_cast<double>(packed.size()), false) + encoded(kTypes[5], 240.0, false) + packed;
  for (int k = *rc::gen::inRange(1, 5); k > 0; --k) {
    file[*rc::gen::inRange<std::size_t>(0, file.size())] = *rc::gen::arbitrary<char>();
  }
  file.resize(*rc::gen::inRange<std::size_t>(0, file.size() + 1));
  try {
    RC_ASSERT(read_bytes(file).size() <= 20U);
  } catch (const InputError& error) {
    RC_ASSERT(std::string_view(error.what()).find('\n') == std::string_view::npos);
  }
}

}  // namespace
}  // namespace gdtslam
