// Every rule is shown a text that breaks it and one that does not.
#include "source_rules.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace gdtslam::architecture {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using ::testing::UnorderedElementsAre;

struct IncludeCase {
  std::string_view path;
  std::string_view header;  ///< with its brackets
  bool is_allowed;
};

class WhoMayIncludeWhom : public ::testing::TestWithParam<IncludeCase> {};

TEST_P(WhoMayIncludeWhom, follows_the_table) {
  const IncludeCase& c = GetParam();
  const std::string text = "// What it is.\n#include " + std::string(c.header) + "\n";
  const std::vector<Violation> found = include_violations(c.path, text);
  if (c.is_allowed) {
    EXPECT_THAT(found, IsEmpty()) << c.path << " " << c.header << " " << (found.empty() ? "" : found[0].message);
  } else {
    ASSERT_THAT(found, SizeIs(1)) << c.path << " " << c.header;
    EXPECT_EQ(found[0].line, 2U);
  }
}

// clang-format off
INSTANTIATE_TEST_SUITE_P(Parts, WhoMayIncludeWhom, ::testing::Values(
    IncludeCase{"engine/core/pose.cpp", "\"gdtslam/core/pose.hpp\"", true},
    IncludeCase{"engine/core/pose.cpp", "<Eigen/Core>", true},
    IncludeCase{"engine/core/pose.cpp", "<vector>", true},
    IncludeCase{"engine/core/pose.cpp", "\"gdtslam/compute/backend.hpp\"", false},
    IncludeCase{"engine/core/pose.cpp", "<yaml-cpp/yaml.h>", false},
    IncludeCase{"engine/core/pose.cpp", "<fmt/format.h>", false},
    IncludeCase{"engine/compute/src/backend.cpp", "\"gdtslam/core/error.hpp\"", true},
    IncludeCase{"engine/compute/src/backend.cpp", "\"cpu/slices.hpp\"", true},
    IncludeCase{"engine/compute/src/backend.cpp", "<immintrin.h>", true},
    IncludeCase{"engine/compute/src/backend.cpp", "<vulkan/vulkan.hpp>", false},
    IncludeCase{"engine/compute/src/backend.cpp", "\"gdtslam/mapping/mapper.hpp\"", false},
    IncludeCase{"engine/vulkan/device/device.cpp", "<vulkan/vulkan_raii.hpp>", true},
    IncludeCase{"engine/vulkan/device/device.cpp", "\"gdtslam/compute/kernel.hpp\"", true},
    IncludeCase{"engine/vulkan/device/device.cpp", "\"gdtslam/mapping/mapper.hpp\"", false},
    IncludeCase{"engine/mapping/mapper.cpp", "\"gdtslam/compute/backend.hpp\"", true},
    IncludeCase{"engine/mapping/mapper.cpp", "\"gdtslam/io/carmen.hpp\"", false},
    IncludeCase{"engine/mapping/mapper.cpp", "\"yaml-cpp/yaml.h\"", false},
    IncludeCase{"engine/mapping/mapper.cpp", "<vtkSmartPointer.h>", false},
    IncludeCase{"engine/mapping/mapper.cpp", "<nlohmann/json.hpp>", false},
    IncludeCase{"engine/mapping/mapper.cpp", "\"../../io/src/line_reader.hpp\"", false},
    IncludeCase{"engine/io/src/config.cpp", "<yaml-cpp/yaml.h>", true},
    IncludeCase{"engine/io/src/config.cpp", "\"gdtslam/mapping/config.hpp\"", false},
    IncludeCase{"engine/io/src/config.cpp", "<sys/stat.h>", true},
    IncludeCase{"engine/io/src/config.cpp", "\"gdtslam/sim/scene.hpp\"", false},
    IncludeCase{"engine/io/src/config.cpp", "<CLI/CLI.hpp>", false},
    IncludeCase{"engine/io/include/gdtslam/io/config.hpp", "<yaml-cpp/yaml.h>", false},
    IncludeCase{"engine/io/include/gdtslam/io/config.hpp", "\"line_reader.hpp\"", false},
    IncludeCase{"engine/io/include/gdtslam/io/config.hpp", "\"gdtslam/core/stream.hpp\"", true},
    IncludeCase{"engine/sim/scene.cpp", "<embree3/rtcore.h>", true},
    IncludeCase{"engine/sim/scene.cpp", "\"gdtslam/calib/four_bar.hpp\"", true},
    IncludeCase{"engine/sim/scene.cpp", "\"gdtslam/io/carmen.hpp\"", false},
    IncludeCase{"engine/sim/scene.cpp", "\"gdtslam/compute/backend.hpp\"", false},
    IncludeCase{"calib/linkage/four_bar.cpp", "\"gdtslam/core/angle.hpp\"", true},
    IncludeCase{"calib/linkage/four_bar.cpp", "\"gdtslam/mapping/mapper.hpp\"", false},
    IncludeCase{"calib/linkage/four_bar.cpp", "<yaml-cpp/yaml.h>", false},
    IncludeCase{"viewer/src/scene.cpp", "<vtkActor.h>", true},
    IncludeCase{"viewer/src/scene.cpp", "\"gdtslam/io/carmen.hpp\"", false},
    IncludeCase{"tools/gdtslam/main.cpp", "<CLI/CLI.hpp>", true},
    IncludeCase{"tools/gdtslam/main.cpp", "\"gdtslam/sim/scene.hpp\"", true},
    IncludeCase{"engine/mapping/mapper.cpp", "<boost/graph/graph.hpp>", false}));
// clang-format on

TEST(Parts, are_known_by_their_folder) {
  EXPECT_EQ(part_of("engine/core/pose.cpp"), "core");
  EXPECT_EQ(part_of("calib/linkage/four_bar.cpp"), "calib");
  EXPECT_EQ(part_of("docs/paper.md"), "");
  EXPECT_EQ(part_of("README.md"), "");
}

TEST(Printing, is_forbidden_in_libraries_only) {
  for (const std::string text : {"std::cout << 1;\n", "std :: cerr << 1;\n", "printf(\"x\");\n",
                                 "std::fprintf(stderr, \"x\");\n", "std::puts(\"x\");\n", "fmt::print(\"x\");\n"}) {
    EXPECT_THAT(printing_violations("engine/io/src/a.cpp", text), SizeIs(1)) << text;
    EXPECT_THAT(printing_violations("tools/src/a.cpp", text), IsEmpty()) << text;
  }
  for (const std::string text : {"std::snprintf(b, 2, \"x\");\n", "// std::cout\n", "auto s = \"std::cerr\";\n",
                                 "/* printf( */\n", "output.puts_left();\n"}) {
    EXPECT_THAT(printing_violations("engine/io/src/a.cpp", text), IsEmpty()) << text;
  }
}

TEST(Determinism, forbids_libm_and_the_random_numbers_of_the_library) {
  for (const std::string text :
       {"x = std::sin(a);\n", "x = std::atan2(y, z);\n", "x = std::hypot(y, z);\n", "x = std::pow(y, 2);\n",
        "std::mt19937 g;\n", "std::uniform_real_distribution<double> d;\n", "std::random_device r;\n",
        "x = std::fma(a, b, c);\n", "x = std::log (a);\n"}) {
    EXPECT_THAT(determinism_violations("engine/core/src/a.cpp", text), SizeIs(1)) << text;
    EXPECT_THAT(determinism_violations("tests/support/a.cpp", text), IsEmpty()) << text;
  }
  for (const std::string text :
       {"x = std::sqrt(a);\n", "x = gdtslam::sin_cos(a).sin;\n", "x = std::floor(a);\n", "// std::sin(a)\n"}) {
    EXPECT_THAT(determinism_violations("engine/core/src/a.cpp", text), IsEmpty()) << text;
  }
}

TEST(Form, refuses_tabs_trailing_spaces_and_a_missing_last_line_break) {
  EXPECT_THAT(form_violations("a.md", "good\ntext\n"), IsEmpty());
  EXPECT_THAT(form_violations("a.md", "x\n\ty\n"), SizeIs(1));
  EXPECT_THAT(form_violations("a.md", "x \ny\n"), SizeIs(1));
  EXPECT_THAT(form_violations("a.md", "x\r\ny\n"), SizeIs(1));
  EXPECT_THAT(form_violations("a.md", "x\ny"), SizeIs(1));
}

TEST(Form, refuses_code_of_more_than_400_lines) {
  std::string text;
  for (int k = 0; k < 400; ++k) text += "int a;\n";
  EXPECT_THAT(form_violations("engine/core/src/a.cpp", text), IsEmpty());
  text += "int a;\n";
  ASSERT_THAT(form_violations("engine/core/src/a.cpp", text), SizeIs(1));
  EXPECT_THAT(form_violations("engine/core/src/a.cpp", text)[0].message, HasSubstr("401 lines"));
  for (const std::string path : {"shaders/a.comp", "shaders/common/a.glsl", "tools/a.sh", "tools/a.py"}) {
    EXPECT_THAT(form_violations(path, text), SizeIs(1)) << path;
  }
  EXPECT_THAT(form_violations("docs/a.md", text), IsEmpty());
}

TEST(Form, refuses_marks_of_unfinished_work) {
  for (const std::string& word :
       {std::string("TO") + "DO", std::string("FIX") + "ME", std::string("place") + "holder"}) {
    EXPECT_THAT(form_violations("engine/core/src/a.cpp", "int a;  // " + word + " later\n"), SizeIs(1)) << word;
  }
}

TEST(Headers, say_what_they_are_and_may_be_included_twice) {
  const std::string_view path = "engine/core/include/gdtslam/core/pose.hpp";
  EXPECT_THAT(header_violations(path, "// Poses.\n#pragma once\n"), IsEmpty());
  EXPECT_THAT(header_violations(path, "#pragma once\n"), SizeIs(1));
  EXPECT_THAT(header_violations(path, "// Poses.\n"), SizeIs(1));
  EXPECT_THAT(header_violations("engine/core/src/private.hpp", "#pragma once\n"), IsEmpty());
  EXPECT_THAT(header_violations("engine/core/pose.cpp", "int a;\n"), IsEmpty());
}

TEST(Citations, must_be_in_the_bibliography) {
  const std::set<std::string> keys =
      bibliography_keys("% text\n@article{Meijster2000,\n  title = {A},\n}\n @book{ Rong2006 , \n");
  EXPECT_THAT(keys, UnorderedElementsAre("Meijster2000", "Rong2006"));
  EXPECT_THAT(citation_violations("// [Meijster2000] and [Rong2006, section 3]\n", keys), IsEmpty());
  const std::vector<Violation> found =
      citation_violations("// by [Meijster2000]\n// by [Nobody1999], [Else2001a]\n", keys);
  ASSERT_THAT(found, SizeIs(2));
  EXPECT_EQ(found[0].line, 2U);
  EXPECT_THAT(found[0].message, HasSubstr("Nobody1999"));
  EXPECT_THAT(citation_violations("values[N2000] = table[Max]; // [1] [Fig 2]\n", keys), IsEmpty());
}

TEST(Links, are_found_without_their_anchors) {
  EXPECT_THAT(relative_links("see [a](docs/a.md#part) and [b](https://x.org/y.md) or [c](#here), ![p](images/p.png)\n"),
              ElementsAre("docs/a.md", "images/p.png"));
}

TEST(Links, name_what_stands_in_their_file) {
  const std::vector<NameInFile> found =
      names_behind_links("[a](../a.hpp) `one`, `two`; [b](b.hpp); `three` [c](c.hpp) `four`.\n");
  ASSERT_THAT(found, SizeIs(3));
  EXPECT_EQ(found[0].link + " " + found[0].name, "../a.hpp one");
  EXPECT_EQ(found[1].link + " " + found[1].name, "../a.hpp two");
  EXPECT_EQ(found[2].link + " " + found[2].name, "c.hpp four");
}

TEST(Stripping, blanks_comments_and_literals_and_keeps_lines) {
  EXPECT_EQ(without_comments_and_literals("a // b\nc"), "a     \nc");
  EXPECT_EQ(without_comments_and_literals("a /* b\nc */ d"), "a     \n     d");
  EXPECT_EQ(without_comments_and_literals(R"(f("x\"y", 'c', 1'000);)"), "f(      ,    , 1'000);");
  EXPECT_EQ(without_comments_and_literals("R\"(a\nb)\" c"), "    \n    c");
  EXPECT_EQ(without_comments_and_literals("\"open"), "     ");
  EXPECT_EQ(without_comments_and_literals("/* open"), "       ");
}

}  // namespace
}  // namespace gdtslam::architecture
