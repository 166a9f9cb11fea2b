// The rules of source_rules.hpp on every file of the project.
#include <algorithm>
#include <filesystem>
#include <map>

#include <gtest/gtest.h>

#include "source_rules.hpp"
#include "tree.hpp"
#include "type_definitions.hpp"

namespace gdtslam::architecture {
namespace {

namespace fs = std::filesystem;

const std::vector<SourceFile>& documents() {
  static const std::vector<SourceFile> files = [] {
    std::vector<SourceFile> all = files_with({"docs", "shaders", "calib", "viewer", "assets", "tests"}, {".md"});
    for (const auto& entry : fs::directory_iterator(root())) {
      if (entry.path().extension() == ".md") all.push_back({entry.path().filename().string(), as_text(entry.path())});
    }
    return all;
  }();
  return files;
}

TEST(Tree, is_found) {
  const auto is_there = [](const std::string& path) {
    return std::any_of(code().begin(), code().end(), [&](const SourceFile& file) { return file.path == path; });
  };
  EXPECT_TRUE(is_there("engine/core/include/gdtslam/core/pose.hpp"));
  EXPECT_TRUE(is_there("engine/mapping/include/gdtslam/mapping/mapper.hpp"));
  EXPECT_GT(documents().size(), 5U);
}

TEST(Tree, every_part_includes_only_what_it_may_know) {
  for (const SourceFile& file : code()) report(file, include_violations(file.path, file.text));
}

TEST(Tree, no_library_prints) {
  for (const SourceFile& file : code()) report(file, printing_violations(file.path, file.text));
}

TEST(Tree, results_do_not_depend_on_the_host_or_the_standard_library) {
  for (const SourceFile& file : code()) report(file, determinism_violations(file.path, file.text));
}

TEST(Tree, files_are_well_formed) {
  for (const SourceFile& file : code()) report(file, form_violations(file.path, file.text));
  for (const SourceFile& file : documents()) report(file, form_violations(file.path, file.text));
  for (const SourceFile& file :
       files_with({"cmake", "tools", "tests", "engine", ".ci"}, {".cmake", ".txt", ".in", ".sh", ".py", ".json"})) {
    report(file, form_violations(file.path, file.text));
  }
}

TEST(Tree, headers_open_with_what_they_are) {
  for (const SourceFile& file : code()) report(file, header_violations(file.path, file.text));
}

// An .inl stands in whatever namespace includes it, one for each instruction set.
TEST(Tree, no_two_types_of_a_namespace_have_one_name) {
  std::map<std::string, std::string> places;
  for (const SourceFile& file : code()) {
    if (!file.path.ends_with(".cpp") && !file.path.ends_with(".hpp")) continue;
    for (const TypeDefinition& type : type_definitions(file.text)) {
      const std::string place = file.path + ":" + std::to_string(type.line);
      const auto [first, is_new] = places.emplace(type.name, place);
      EXPECT_TRUE(is_new) << place << ": " << type.name << " is defined at " << first->second << " as well";
    }
  }
  EXPECT_TRUE(places.contains("gdtslam::Pose2"));
}

TEST(Tree, every_citation_is_in_the_bibliography) {
  const std::set<std::string> keys = bibliography_keys(as_text(root() / "docs/references.bib"));
  ASSERT_FALSE(keys.empty());
  for (const std::vector<SourceFile>& files : {code(), documents()}) {
    for (const SourceFile& file : files) {
      if (file.path.starts_with("tests/unit/architecture/")) continue;  // cites keys that must not exist
      report(file, citation_violations(file.text, keys));
    }
  }
}

TEST(Tree, every_relative_link_of_the_documents_leads_somewhere) {
  for (const SourceFile& file : documents()) {
    for (const std::string& target : relative_links(file.text)) {
      EXPECT_TRUE(fs::exists(root() / fs::path(file.path).parent_path() / target)) << file.path << " -> " << target;
    }
  }
}

TEST(Tree, names_behind_links_stand_in_the_linked_file) {
  for (const SourceFile& file : documents()) {
    for (const NameInFile& named : names_behind_links(file.text)) {
      const std::string text = as_text(root() / fs::path(file.path).parent_path() / named.link);
      EXPECT_TRUE(text.find(named.name) != std::string::npos)
          << file.path << ": " << named.link << " has no " << named.name;
    }
  }
}

}  // namespace
}  // namespace gdtslam::architecture
