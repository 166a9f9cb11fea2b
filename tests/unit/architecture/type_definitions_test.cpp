#include "type_definitions.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace gdtslam::architecture {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

std::vector<std::string> names_in(std::string_view text) {
  std::vector<std::string> names;
  for (const TypeDefinition& type : type_definitions(text)) names.push_back(type.name);
  return names;
}

TEST(TypeDefinitions, are_found_in_named_namespaces) {
  EXPECT_THAT(names_in("struct A {};\n"), ElementsAre("A"));
  EXPECT_THAT(
      names_in("namespace a {\nclass B final : public C<int> {\n};\nnamespace b::c {\nunion D { int e; };\n}\n}\n"),
      ElementsAre("a::B", "a::b::c::D"));
  EXPECT_THAT(names_in("namespace a {\nenum class E : std::uint8_t { kOne };\nenum F { kTwo };\n}\n"),
              ElementsAre("a::E", "a::F"));
  EXPECT_THAT(names_in("namespace a {\ntemplate <typename T, int N = 2>\nstruct alignas(16) G {};\n}\n"),
              ElementsAre("a::G"));
  EXPECT_THAT(names_in("extern \"C\" {\nstruct H {};\n}\n"), ElementsAre("H"));
}

TEST(TypeDefinitions, of_templates_differ_by_their_arguments) {
  EXPECT_THAT(names_in("template <class T>\nstruct A {};\ntemplate <>\nstruct A<b::C, 2> {};\n"),
              ElementsAre("A", "A<b::C,2>"));
}

TEST(TypeDefinitions, of_a_type_a_function_or_an_anonymous_namespace_do_not_count) {
  EXPECT_THAT(names_in("namespace {\nstruct A {};\n}\n"), IsEmpty());
  EXPECT_THAT(names_in("class A {\n  struct B {};\n};\n"), ElementsAre("A"));
  EXPECT_THAT(names_in("struct A::B {};\n"), IsEmpty());
  EXPECT_THAT(names_in("void f() {\n  struct A {};\n}\nint x = g({1, {2}});\n"), IsEmpty());
}

TEST(TypeDefinitions, are_no_declarations_comments_literals_or_macros) {
  EXPECT_THAT(names_in("class A;\nenum class B : int;\nstruct C f() { return {}; }\nstruct D e = {1};\n"), IsEmpty());
  EXPECT_THAT(names_in("// struct A {};\nconst char* b = \"struct C {\";\n#define D \\\n  struct E {\n"), IsEmpty());
}

TEST(TypeDefinitions, have_the_line_of_their_brace) {
  const std::vector<TypeDefinition> found = type_definitions("namespace a {\n\nstruct B\n    : C {};\n}\n");
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].line, 4U);
}

}  // namespace
}  // namespace gdtslam::architecture
