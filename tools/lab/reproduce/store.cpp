#include "store.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string_view>
#include <system_error>
#include <utility>

#include "engine/drawing/markup.hpp"
#include "engine/io/atomic_file.hpp"
#include "engine/io/json_file.hpp"
#include "folder.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam::reproduce {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr int kVersion = 2;
constexpr const char* kMaking = ".making";

Json as_json(const std::string& key, const KeptPart& kept) {
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

// Texts of the file are printed and stand in the report: one line each, without control characters.
std::string text_in(const Json& json) {
  std::string text = clean_utf8(json.get<std::string>());
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

std::vector<std::string> texts_in(const Json& json) {
  std::vector<std::string> texts;
  for (const Json& entry : json) texts.push_back(text_in(entry));
  return texts;
}

template <class Action>
void each(const Json& json, const char* name, Action action) {
  if (!json.contains(name)) return;
  for (const Json& entry : json.at(name)) action(entry);
}

int whole_in(const Json& json) {
  if (!json.is_number_integer()) throw InputError("a number that is not whole");
  return json.get<int>();
}

template <class Enum>
Enum value_of(const Json& json, Enum last) {
  const int value = whole_in(json);
  if (value < 0 || value > static_cast<int>(last)) throw InputError("a value that there is not");
  return static_cast<Enum>(value);
}

KeptPart part_of(const Json& json) {
  KeptPart kept;
  Part& part = kept.part;
  kept.cpu_s = json.at("cpu_s").get<double>();
  constexpr double kMostCpu_s = 1.0e9;
  if (!(kept.cpu_s >= 0.0 && kept.cpu_s < kMostCpu_s)) throw InputError("a time that there is not");
  kept.date = text_in(json.at("date"));
  part.source = text_in(json.at("source"));
  part.origin = value_of<Origin>(json.at("origin"), Origin::kSimulatedAndReal);
  part.notes = texts_in(json.at("notes"));
  part.by_hand = texts_in(json.at("by_hand"));
  each(json, "pictures", [&part](const Json& p) {
    part.pictures.push_back(
        {text_in(p.at("file")), text_in(p.at("caption")), std::clamp(whole_in(p.at("across")), 1, 3)});
  });
  each(json, "rows", [&part](const Json& r) {
    part.rows.push_back({text_in(r.at("quantity")), text_in(r.at("paper")), text_in(r.at("ours")),
                         value_of<Verdict>(r.at("verdict"), Verdict::kOpen), text_in(r.at("remark"))});
  });
  each(json, "tables", [&part](const Json& t) {
    Table table{text_in(t.at("caption")), texts_in(t.at("heads")), {}};
    each(t, "rows", [&table](const Json& row) { table.rows.push_back(texts_in(row)); });
    part.tables.push_back(std::move(table));
  });
  return kept;
}

// A name of a picture leads to no other folder and means nothing in HTML or Markdown.
bool pictures_are_there(const Part& part, const std::string& folder) {
  constexpr std::string_view kLetters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789.-_";
  for (const Picture& picture : part.pictures) {
    std::error_code failed;
    if (picture.file.find_first_not_of(kLetters) != std::string::npos) return false;
    if (!fs::is_regular_file(folder + "/" + picture.file, failed) ||
        fs::file_size(folder + "/" + picture.file, failed) == 0)
      return false;
  }
  return true;
}

}  // namespace

Store::Store(const std::string& folder) : folder_(folder) { make_folder(folder + "/parts"); }

std::optional<KeptPart> Store::find(const std::string& id, const std::string& key) const {
  constexpr std::size_t kMostBytes = std::size_t{1} << 20U;  // what parts write has some 10 KB
  const std::string file = folder_of(id) + "/part.json";
  std::error_code failed;
  if (!fs::exists(file, failed)) return std::nullopt;
  try {
    const Json json = read_json(file, kMostBytes);
    if (whole_in(json.at("version")) != kVersion || json.at("key").get<std::string>() != key) return std::nullopt;
    KeptPart kept = part_of(json);
    if (pictures_are_there(kept.part, folder_of(id))) return kept;
  } catch (const Json::exception&) {  // cut or changed by hand: it is made again
  } catch (const InputError&) {
  }
  return std::nullopt;
}

std::string Store::begin(const std::string& id) {
  std::string folder = folder_of(id) + kMaking;
  make_marked_folder(folder);
  return folder;
}

void Store::keep(const std::string& id, const std::string& key, const KeptPart& part) {
  const std::string making = folder_of(id) + kMaking;
  write_json(making + "/part.json", as_json(key, part));
  replace_own_folder(making, folder_of(id));
}

void Store::drop(const std::string& id) noexcept {
  try {
    remove_own_folder(folder_of(id) + kMaking);
  } catch (const Error&) {  // an error is on its way already; begin() removes it the next time, or says what is wrong
  }
}

void Store::require_own(const std::string& id) const {
  require_own_folder(folder_of(id));
  require_own_folder(folder_of(id) + kMaking);
}

std::string utc_text() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  ::gmtime_r(&now, &utc);
  return fmt::format("{:04}-{:02}-{:02} {:02}:{:02} UTC", utc.tm_year + 1900, utc.tm_mon + 1, utc.tm_mday, utc.tm_hour,
                     utc.tm_min);
}

}  // namespace gdtslam::reproduce
