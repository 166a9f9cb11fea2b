#include "output.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <system_error>
#include <vector>

#include "engine/io/did_you_mean.hpp"
#include "film_writer.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;

struct Ending {
  std::string_view extension;
  OutputKind kind;
};
constexpr std::array<Ending, 10> kEndings{{{".png", OutputKind::kPng},
                                           {".svg", OutputKind::kSvg},
                                           {".pdf", OutputKind::kPdf},
                                           {".mp4", OutputKind::kMp4},
                                           {".gif", OutputKind::kGif},
                                           {".html", OutputKind::kPage},
                                           {".htm", OutputKind::kPage},
                                           {".gltf", OutputKind::kGltf},
                                           {".ply", OutputKind::kCloud},
                                           {".pcd", OutputKind::kCloud}}};

}  // namespace

OutputKind output_kind_of(const std::string& path) {
  std::error_code ignored;
  if (path.ends_with('/')) return OutputKind::kFrames;
  const bool is_folder = fs::is_directory(path, ignored);
  if (!is_folder && is_frame_pattern(path)) {
    frame_path(path, 0);  // refuses what is no pattern
    return OutputKind::kFrames;
  }
  std::string extension = fs::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  std::vector<std::string> names;
  std::string list;
  for (const Ending& ending : kEndings) {
    if (ending.extension == extension && is_folder) {
      throw UsageError("-o: '" + path + "' is a folder; end it in / for the frames of a film");
    }
    if (ending.extension == extension) return ending.kind;
    names.emplace_back(ending.extension);
    list += (list.empty() ? "" : " ") + names.back();
  }
  if (is_folder) return OutputKind::kFrames;
  throw UsageError("-o: '" + path + "' has none of the endings " + list + ", nor does it end in / for frames" +
                   did_you_mean(extension, names));
}

std::string_view to_string(OutputKind kind) {
  constexpr std::array<std::string_view, 9> kNames{"a still in .png", "a drawing in .svg", "a page in .pdf",
                                                   "a film in .mp4",  "a film in .gif",    "frames in a folder",
                                                   "a page in .html", "a model in .gltf",  "a cloud"};
  return kNames[static_cast<std::size_t>(kind)];
}

}  // namespace gdtslam
