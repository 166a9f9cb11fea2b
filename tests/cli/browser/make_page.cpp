// Writes a page from files, for the tests of the page: make_page OUT.html [--title TEXT] [--subtitle TEXT]
// [--fact NAME=VALUE] [--cloud FILE] [--distances FILE (float32)] [--path TUM] [--drive INDEX] [--map YAML]
// [--linkage PRESET]
#include <cstdio>
#include <cstring>
#include <exception>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gdtslam/core/error.hpp"
#include "gdtslam/io/cloud_file.hpp"
#include "gdtslam/io/map_files.hpp"
#include "gdtslam/io/trajectory_file.hpp"
#include "gdtslam/viewer/page.hpp"

namespace {

/// Everything that an input points to.
struct Holder {
  gdtslam::PageInput input;
  gdtslam::Cloud cloud;
  std::vector<float> distances_m;
  gdtslam::Trajectory trajectory;
  gdtslam::OccupancyMap map;
  std::optional<gdtslam::calib::SweepModel> linkage;
};

std::vector<float> read_floats(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  std::vector<float> values(bytes.size() / sizeof(float));
  std::memcpy(values.data(), bytes.data(), values.size() * sizeof(float));
  return values;
}

void take_option(Holder& holder, std::string_view option, const std::string& value) {
  if (option == "--title") {
    holder.input.title = value;
  } else if (option == "--subtitle") {
    holder.input.subtitle = value;
  } else if (option == "--fact") {
    const std::size_t middle = value.find('=');
    holder.input.facts.emplace_back(value.substr(0, middle), value.substr(middle + 1));
  } else if (option == "--cloud") {
    holder.cloud = gdtslam::read_cloud(value);
    holder.input.cloud = &holder.cloud;
  } else if (option == "--distances") {
    holder.distances_m = read_floats(value);
    holder.input.distances_m = &holder.distances_m;
  } else if (option == "--path") {
    holder.trajectory = gdtslam::read_tum(value);
    holder.input.trajectory = &holder.trajectory;
  } else if (option == "--drive") {
    holder.input.drives.push_back(std::stoul(value));
  } else if (option == "--map") {
    holder.map = gdtslam::read_occupancy_map(value);
    holder.input.map = &holder.map;
  } else if (option == "--linkage") {
    holder.linkage = gdtslam::calib::sweep_model_of_preset(value);
    holder.input.linkage = &*holder.linkage;
  } else {
    throw gdtslam::UsageError("unknown option " + std::string(option));
  }
}

}  // namespace

int main(int argc, char** argv) {
  try {
    if (argc < 2) throw gdtslam::UsageError("make_page OUT.html [OPTION VALUE]...");
    Holder holder;
    for (int k = 2; k + 1 < argc; k += 2) take_option(holder, argv[k], argv[k + 1]);
    const std::string page = gdtslam::make_page(holder.input);
    std::ofstream file(argv[1], std::ios::binary);
    file << page;
    file.close();
    if (!file) throw gdtslam::FileError(argv[1], "cannot be written");
    return 0;
  } catch (const gdtslam::Error& error) {
    std::fprintf(stderr, "make_page: error: %s\n", error.what());
    return static_cast<int>(error.code());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "make_page: error: %s\n", error.what());
    return 1;
  }
}
