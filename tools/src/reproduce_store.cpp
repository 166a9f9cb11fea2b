#include "reproduce_store.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <system_error>

#include "gdtslam/core/error.hpp"
#include "gdtslam/io/atomic_file.hpp"
#include "gdtslam/io/json_file.hpp"

namespace gdtslam::reproduce {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr int kVersion = 2;
constexpr const char* kMaking = ".making";

Json json_of(const std::string& key, const KeptPart& kept) {
  const Part& part = kept.part;
  Json json{{"version", kVersion},   {"key", key},
            {"cpu_s", kept.cpu_s},   {"date", kept.date},
            {"source", part.source}, {"origin", static_cast<int>(part.origin)},
            {"notes", part.notes},   {"by_hand", part.by_hand}};
  for (const Picture& p : part.pictures) {
    json["pictures"].push_back({{"file", p.file}, {"caption", p.caption}, {"across", p.across}});
  }
  for (const Row& r : part.rows) {
    json["rows"].push_back({{"quantity", r.quantity},
                            {"paper", r.paper},
                            {"ours", r.ours},
                            {"verdict", static_cast<int>(r.verdict)},
                            {"remark", r.remark}});
  }
  for (const Table& t : part.tables) {
    json["tables"].push_back({{"caption", t.caption}, {"heads", t.heads}, {"rows", t.rows}});
  }
  return json;
}

template <class Action>
void each(const Json& json, const char* name, Action action) {
  if (!json.contains(name)) return;
  for (const Json& entry : json.at(name)) action(entry);
}

template <class Enum>
Enum value_of(const Json& json, Enum last) {
  const int value = json.get<int>();
  if (value < 0 || value > static_cast<int>(last)) throw InputError("a value that there is not");
  return static_cast<Enum>(value);
}

KeptPart part_of(const Json& json) {
  KeptPart kept;
  Part& part = kept.part;
  kept.cpu_s = json.at("cpu_s").get<double>();
  kept.date = json.at("date").get<std::string>();
  part.source = json.at("source").get<std::string>();
  part.origin = value_of<Origin>(json.at("origin"), Origin::kSimulatedAndReal);
  part.notes = json.at("notes").get<std::vector<std::string>>();
  part.by_hand = json.at("by_hand").get<std::vector<std::string>>();
  each(json, "pictures", [&part](const Json& p) {
    part.pictures.push_back({p.at("file").get<std::string>(), p.at("caption").get<std::string>(),
                             std::clamp(p.at("across").get<int>(), 1, 3)});
  });
  each(json, "rows", [&part](const Json& r) {
    part.rows.push_back({r.at("quantity").get<std::string>(), r.at("paper").get<std::string>(),
                         r.at("ours").get<std::string>(), value_of<Verdict>(r.at("verdict"), Verdict::kOpen),
                         r.at("remark").get<std::string>()});
  });
  each(json, "tables", [&part](const Json& t) {
    part.tables.push_back({t.at("caption").get<std::string>(), t.at("heads").get<std::vector<std::string>>(),
                           t.at("rows").get<std::vector<std::vector<std::string>>>()});
  });
  return kept;
}

// A name of a picture leads to no other folder.
bool pictures_are_there(const Part& part, const std::string& folder) {
  for (const Picture& picture : part.pictures) {
    std::error_code failed;
    if (picture.file.find('/') != std::string::npos) return false;
    if (!fs::is_regular_file(folder + "/" + picture.file, failed) ||
        fs::file_size(folder + "/" + picture.file, failed) == 0)
      return false;
  }
  return true;
}

void remove(const fs::path& path) {
  std::error_code failed;
  fs::remove_all(path, failed);
  if (failed) throw FileError(path.string(), "cannot be removed: " + failed.message());
}

}  // namespace

Store::Store(const std::string& folder) : folder_(folder) { make_folder(folder + "/parts"); }

std::optional<KeptPart> Store::find(const std::string& id, const std::string& key) const {
  std::ifstream file(folder_of(id) + "/part.json");
  if (!file) return std::nullopt;
  try {
    const Json json = Json::parse(file);
    if (json.at("version").get<int>() != kVersion || json.at("key").get<std::string>() != key) return std::nullopt;
    KeptPart kept = part_of(json);
    if (pictures_are_there(kept.part, folder_of(id))) return kept;
  } catch (const Json::exception&) {  // cut or changed by hand: it is made again
  } catch (const InputError&) {
  }
  return std::nullopt;
}

std::string Store::begin(const std::string& id) {
  std::string folder = folder_of(id) + kMaking;
  remove(folder);
  make_folder(folder);
  return folder;
}

void Store::keep(const std::string& id, const std::string& key, const KeptPart& part) {
  const std::string making = folder_of(id) + kMaking;
  write_json(making + "/part.json", json_of(key, part));
  remove(folder_of(id));
  std::error_code failed;
  fs::rename(making, folder_of(id), failed);
  if (failed) throw FileError(folder_of(id), "cannot be written: " + failed.message());
}

void Store::drop(const std::string& id) {
  std::error_code ignored;  // begin() removes it the next time
  fs::remove_all(folder_of(id) + kMaking, ignored);
}

std::string utc_text() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  ::gmtime_r(&now, &utc);
  return fmt::format("{:04}-{:02}-{:02} {:02}:{:02} UTC", utc.tm_year + 1900, utc.tm_mon + 1, utc.tm_mday, utc.tm_hour,
                     utc.tm_min);
}

}  // namespace gdtslam::reproduce
