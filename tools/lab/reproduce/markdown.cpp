#include <fmt/format.h>

#include <cmath>
#include <string_view>

#include "run.hpp"

namespace gdtslam::reproduce {
namespace {

// Within a cell or a line: nothing that means something there.
std::string cell_text(const std::string& text) {
  std::string out;
  for (const char letter : text) {
    if (std::string_view("|<*_`[]\\").find(letter) != std::string_view::npos) out += '\\';
    out += letter;
  }
  return out;
}

std::string table_row(const std::vector<std::string>& cells) {
  std::string text = "|";
  for (const std::string& cell : cells) text += " " + cell_text(cell) + " |";
  return text + "\n";
}

std::string table_head(const std::vector<std::string>& heads) {
  std::string text = table_row(heads) + "|";
  for (std::size_t k = 0; k < heads.size(); ++k) text += "---|";
  return text + "\n";
}

std::vector<std::string> cells_of(const Row& row) {
  return {row.quantity, row.paper.empty() ? "not given" : row.paper, row.ours, std::string(to_string(row.verdict)),
          row.remark};
}

std::string overview_of(const Result& result) {
  std::string text = table_head({"Part", "Quantity", "Paper", "Ours", "Verdict", "Remark"});
  for (const PartState& state : result.parts) {
    if (!state.kept) continue;
    for (const Row& row : state.kept->part.rows) {
      std::vector<std::string> cells = cells_of(row);
      cells.insert(cells.begin(), std::string(state.info->label));
      text += table_row(cells);
    }
  }
  return text;
}

std::string rows_of(const Part& part) {
  if (part.rows.empty()) return "";
  std::string text = "\n" + table_head({"Quantity", "Paper", "Ours", "Verdict", "Remark"});
  for (const Row& row : part.rows) text += table_row(cells_of(row));
  return text;
}

std::string times_of(const Result& result) {
  std::string text =
      "\n## CPU time of each part\n\nOf parts that share a simulated drive the first one has its time.\n\n" +
      table_head({"Part", "Shows", "CPU time", "Made"});
  for (const PartState& state : result.parts) {
    text += table_row({std::string(state.info->label), std::string(state.info->title),
                       state.kept ? seconds_text(state.kept->cpu_s) : "not made", state.kept ? state.kept->date : ""});
  }
  return text;
}

std::string commands_text(const std::vector<std::string>& commands) {
  std::string text = "```\n";
  for (const std::string& command : commands) text += command + "\n";
  return text + "```\n";
}

std::string part_text(const PartState& state) {
  const PartInfo& info = *state.info;
  std::string text = fmt::format("\n## {}: {}\n\nIn the paper: {}\n\n", info.label, info.title, info.paper);
  if (!state.kept) return text + "Not made yet:\n\n" + commands_text({command_of(info)});
  const Part& part = state.kept->part;
  text += fmt::format("**{}.** {}\n", to_string(part.origin), cell_text(part.source));
  for (const Picture& picture : part.pictures) {
    text += fmt::format("\n![{}]({}/{})\n\n*{}*\n", cell_text(picture.caption), Store::place_of(std::string(info.id)),
                        picture.file, cell_text(picture.caption));
  }
  text += rows_of(part);
  for (const Table& table : part.tables) {
    text += fmt::format("\n{}\n\n", cell_text(table.caption)) + table_head(table.heads);
    for (const auto& row : table.rows) text += table_row(row);
  }
  if (!part.notes.empty()) text += "\n";
  for (const std::string& note : part.notes) text += "* " + cell_text(note) + "\n";
  text += "\nThis part alone:\n\n" + commands_text({command_of(info)});
  if (!part.by_hand.empty()) text += "\nStep by step:\n\n" + commands_text(part.by_hand);
  return text +
         fmt::format("\nMade {}, {} of CPU time.\n", cell_text(state.kept->date), seconds_text(state.kept->cpu_s));
}

}  // namespace

VerdictCounts counts_of(const Result& result) {
  VerdictCounts counts;
  for (const PartState& state : result.parts) {
    if (!state.kept) continue;
    for (const Row& row : state.kept->part.rows) {
      ++(row.verdict == Verdict::kWithin    ? counts.within
         : row.verdict == Verdict::kOutside ? counts.outside
                                            : counts.open);
    }
  }
  return counts;
}

std::string command_of(const PartInfo& info) { return fmt::format("gdtslam reproduce -o report --only {}", info.id); }

double cpu_s_of_parts(const Result& result) {
  double seconds = 0.0;
  for (const PartState& state : result.parts) seconds += state.kept ? state.kept->cpu_s : 0.0;
  return seconds;
}

std::string seconds_text(double seconds) {
  if (seconds < 59.95) return fmt::format("{:.1f} s", seconds);
  const auto whole = static_cast<long>(std::lround(seconds));
  return fmt::format("{}:{:02} min", whole / 60, whole % 60);
}

std::size_t parts_made(const Result& result) {
  std::size_t count = 0;
  for (const PartState& state : result.parts) count += state.kept ? 1U : 0U;
  return count;
}

std::string markdown_of(const Result& result) {
  const VerdictCounts counts = counts_of(result);
  std::string text = fmt::format(
      "# The paper, figure by figure\n\n{}\n\n**{}**\n\n"
      "* Version: gdtslam {}\n* Report written: {}\n* Processor: {}, {} threads\n* Device: {}\n"
      "* Parts: {} of {} made, {} of CPU time\n* Verdicts: {} within, {} outside, {} without\n\n"
      "## Contents\n\n",
      kAbout, kNotPublished, result.host.version, utc_text(), result.host.processor, result.host.threads,
      result.host.device, parts_made(result), result.parts.size(), seconds_text(cpu_s_of_parts(result)), counts.within,
      counts.outside, counts.open);
  for (const PartState& state : result.parts) text += fmt::format("* {}: {}\n", state.info->label, state.info->title);
  text += "* Paper and reproduction: all numbers\n* CPU time of each part\n";
  for (const PartState& state : result.parts) text += part_text(state);
  text += fmt::format("\n## Paper and reproduction\n\n{}\n\n", kVerdicts) + overview_of(result);
  return text + times_of(result);
}

}  // namespace gdtslam::reproduce
