// Help as a page: lines of a width, the form of defaults and bounds, groups, command lines that go on; and what the
// tree of texts takes from a declaration.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

#include <string>
#include <vector>

#include "tools/gdtslam/shell/help/command_tree.hpp"
#include "tools/gdtslam/shell/help/help_page.hpp"
#include "tools/gdtslam/shell/help/offers.hpp"
#include "tools/gdtslam/shell/settings_options.hpp"

namespace gdtslam {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// A command line with one of each.
class HelpPageTest : public testing::Test {
 public:
  HelpPageTest() {
    app_.group("Commands");
    app_.add_option("log", logs_, "Logs that are read")->type_name("LOG")->required();
    CLI::Option* const list = app_.add_flag("-l,--list", lists_, "List what there is");
    app_.add_option("-e,--every", every_, "Draw every\nNth scan")
        ->type_name("N")
        ->check(CLI::Range(1, 100))
        ->capture_default_str()
        ->excludes(list);
    app_.add_option("--colour", colour_, "Colour of the points [height; with a reference distance]")->type_name("NAME");
    app_.add_option("--view", colour_, "View that is drawn (default: the map)")->type_name("NAME")->needs(list);
    app_.add_flag("--hidden", lists_, "Not shown")->group("");
    app_.add_flag("!--no-loops", loops_, "Look for no loops")->group("Research");
    app_.footer(
        "A paragraph that was\nbroken here.\n"
        "\n"
        "Examples:\n"
        "  tool a.log        reads it and says what is in it, as long as it takes\n"
        "  tool b.log --colour 'a b' --view map --every 12 --list\n"
        "\n"
        "The end.");
  }

 protected:
  std::string page(std::size_t width) { return help_page(command_text(app_), width); }

  CLI::App app_{"Reads logs", "tool"};
  std::vector<std::string> logs_;
  std::string colour_;
  int every_ = 5;
  bool lists_ = false;
  bool loops_ = true;
};

TEST_F(HelpPageTest, AsPeopleReadIt) {
  EXPECT_EQ(page(64),
            "Reads logs\n"
            "Usage: tool [OPTIONS] log...\n"
            "\n"
            "Arguments:\n"
            "  log ...          Logs that are read (required)\n"
            "\n"
            "Options:\n"
            "  -h, --help       Print this help message and exit\n"
            "  -l, --list       List what there is\n"
            "  -e, --every N    Draw every Nth scan (default: 5; 1 to 100)\n"
            "  --colour NAME    Colour of the points (default: height; with a\n"
            "                   reference distance)\n"
            "  --view NAME      View that is drawn (default: the map; with\n"
            "                   --list)\n"
            "\n"
            "Research:\n"
            "  --no-loops       Look for no loops\n"
            "\n"
            "A paragraph that was broken here.\n"
            "\n"
            "Examples:\n"
            "  tool a.log\n"
            "      # reads it and says what is in it, as long as it takes\n"
            "  tool b.log --colour 'a b' --view map --every 12 --list\n"
            "\n"
            "The end.\n");
}

TEST_F(HelpPageTest, LongCommandLinesGoOnAndQuotesStayWhole) {
  EXPECT_THAT(page(40), HasSubstr("  tool b.log --colour 'a b' --view map \\\n      --every 12 --list\n"));
}

TEST_F(HelpPageTest, OffersAreStatedOrFollowFromTheNameOfTheValue) {
  CLI::Option* const folder = app_.add_option("--folder", colour_, "Folder")->type_name("DIR");
  EXPECT_TRUE(find_offers(*folder, "DIR").has_folders);
  EXPECT_FALSE(find_offers(*folder, "DIR").has_files);
  CLI::Option* const preset = app_.add_option("--preset", colour_, "Preset")->type_name("PRESET|FILE");
  EXPECT_THAT(find_offers(*preset, "PRESET|FILE").words, testing::Contains("paper-b"));
  offer_words(preset, {"one", "two"});
  EXPECT_THAT(find_offers(*preset, "PRESET|FILE").words, ElementsAre("one", "two"));
  EXPECT_THAT(find_offers(*preset, "PRESET|FILE").endings, ElementsAre(".yaml", ".yml")) << "what the name says stays";
  CLI::Option* const count = app_.add_option("--count", every_, "Count")->type_name("N");
  EXPECT_TRUE(find_offers(*count, "N").is_empty());
}

}  // namespace
}  // namespace gdtslam
