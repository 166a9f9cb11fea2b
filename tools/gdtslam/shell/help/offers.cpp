#include "offers.hpp"

#include <CLI/App.hpp>

#include <map>
#include <sstream>
#include <string_view>
#include <utility>

#include "gdtslam/calib/crank_rocker.hpp"

namespace gdtslam {
namespace {

// CLI11 stores no remark on an option except a validator's name, and a validator that accepts everything changes
// nothing else.
constexpr std::string_view kMark = "offers\n";

std::string packed(const Offers& offers) {
  std::string text(kMark);
  for (const std::string& word : offers.words) text += "w" + word + "\n";
  for (const std::string& ending : offers.endings) text += "e" + ending + "\n";
  if (offers.has_files) text += "f\n";
  if (offers.has_folders) text += "d\n";
  if (offers.has_settings) text += "s\n";
  return text;
}

Offers unpacked(const std::string& text) {
  Offers offers;
  std::istringstream lines(text.substr(kMark.size()));
  for (std::string line; std::getline(lines, line);) {
    switch (line.front()) {
      case 'w':
        offers.words.push_back(line.substr(1));
        break;
      case 'e':
        offers.endings.push_back(line.substr(1));
        break;
      case 'f':
        offers.has_files = true;
        break;
      case 'd':
        offers.has_folders = true;
        break;
      default:
        offers.has_settings = true;
    }
  }
  return offers;
}

// Endings of plain logs, and of the compressed ones that the log readers unpack.
std::vector<std::string> log_endings() {
  std::vector<std::string> endings;
  for (const char* const format : {".log", ".clf", ".csv", ".jsonl", ".mcap", ".bag", ".db3"}) {
    endings.emplace_back(format);
    for (const char* const packing : {".gz", ".bz2", ".xz", ".zst"}) endings.push_back(std::string(format) + packing);
  }
  return endings;
}

Offers linkage_offers() {
  Offers offers{.endings = {".yaml", ".yml"}, .has_files = true};
  for (const calib::LinkagePreset& preset : calib::linkage_presets()) offers.words.emplace_back(preset.name);
  return offers;
}

std::map<std::string, Offers> make_known_offers() {
  const Offers folders{.has_folders = true};
  const Offers files{.has_files = true};
  const Offers files_or_folders{.has_files = true, .has_folders = true};
  const Offers linkages = linkage_offers();
  return {
      {"FILE", files},
      {"DIR", folders},
      {"RUN", folders},
      {"ATLAS", folders},
      {"LOG", {.endings = log_endings(), .has_files = true, .has_folders = true}},
      {"OUT", files_or_folders},
      {"INPUT", files_or_folders},
      {"CLOUD", {.endings = {".ply", ".pcd", ".ply.gz", ".pcd.gz"}, .has_files = true}},
      {"RUN|CLOUD", {.endings = {".ply", ".pcd", ".ply.gz", ".pcd.gz"}, .has_files = true, .has_folders = true}},
      {"RUN|FILE", files_or_folders},
      {"MAP", {.endings = {".yaml", ".yml"}, .has_files = true, .has_folders = true}},
      {"SCENE", {.endings = {".yaml", ".yml"}, .has_files = true}},
      {"LINKAGE", linkages},
      {"NAME|FILE", linkages},
      {"PRESET|FILE", linkages},
      {"POINT|FILE", files},
      {"POLYGON|FILE", files},
      {"PATH=VALUE", {.has_settings = true}},
  };
}

Offers known_offers(const std::string& value_name) {
  static const std::map<std::string, Offers> known = make_known_offers();
  const auto found = known.find(value_name);
  return found == known.end() ? Offers{} : found->second;
}

}  // namespace

CLI::Option* offer(CLI::Option* option, const Offers& offers) {
  return option->check(CLI::Validator([](std::string&) { return std::string(); }, "", packed(offers)));
}

CLI::Option* offer_words(CLI::Option* option, std::vector<std::string> words) {
  Offers offers = known_offers(option->get_type_name());
  offers.words = std::move(words);
  return offer(option, offers);
}

Offers find_offers(CLI::Option& option, const std::string& value_name) {
  try {
    for (int k = 0;; ++k) {
      const std::string& name = option.get_validator(k)->get_name();
      if (name.starts_with(kMark)) return unpacked(name);
    }
  } catch (const CLI::OptionNotFound&) {  // CLI11's sign that there are no more
  }
  return value_name.empty() ? Offers{} : known_offers(value_name);
}

}  // namespace gdtslam
