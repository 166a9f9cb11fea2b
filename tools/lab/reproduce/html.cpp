#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <span>
#include <string>
#include <string_view>

#include "engine/core/base64.hpp"
#include "engine/drawing/markup.hpp"
#include "engine/io/yaml/yaml_text.hpp"
#include "gdtslam/core/error.hpp"
#include "run.hpp"

namespace gdtslam::report_text {
std::string_view skeleton();
std::string_view style();
std::string_view program();
std::string_view program_hash();
}  // namespace gdtslam::report_text

namespace gdtslam::reproduce {
namespace {

constexpr std::array<std::string_view, 5> kUnits{" cm", " mm", " m", " s", " %"};

// Of the text of a cell: numbers stay in one line with their units and deviations.
std::string cell_text(std::string_view text) {
  constexpr std::string_view kSpace = "\u00a0";
  constexpr std::string_view kPlusMinus = "\u00b1";
  std::string out;
  for (std::size_t k = 0; k < text.size(); ++k) {
    const std::string_view rest = text.substr(k);
    const auto has_unit = [rest](std::string_view unit) {
      return rest.starts_with(unit) &&
             (rest.size() == unit.size() || std::ispunct(static_cast<unsigned char>(rest[unit.size()])) != 0 ||
              rest[unit.size()] == ' ');
    };
    const bool follows_digit = k > 0 && std::isdigit(static_cast<unsigned char>(text[k - 1])) != 0;
    const bool is_bound = (follows_digit && std::any_of(kUnits.begin(), kUnits.end(), has_unit)) ||
                          rest.substr(1).starts_with(kPlusMinus) || text.substr(0, k).ends_with(kPlusMinus);
    if (text[k] == ' ' && is_bound) {
      out += kSpace;
    } else {
      out += text[k];
    }
  }
  return markup_text(out);
}

std::string verdict_html(Verdict verdict) {
  const char* const style = verdict == Verdict::kWithin ? "within" : verdict == Verdict::kOutside ? "outside" : "open";
  return fmt::format("<span class=\"verdict {}\">{}</span>", style, to_string(verdict));
}

// "5 within", "1 outside": what there is of each.
std::string verdicts_html(const Part& part) {
  std::string text;
  for (const Verdict verdict : {Verdict::kWithin, Verdict::kOutside}) {
    const auto count =
        std::count_if(part.rows.begin(), part.rows.end(), [verdict](const Row& row) { return row.verdict == verdict; });
    if (count == 0) continue;
    text += fmt::format(" <span class=\"verdict {0}\">{1} {0}</span>", to_string(verdict), count);
  }
  return text;
}

std::string row_html(const Row& row, const std::string& lead) {
  const std::string paper = row.paper.empty() ? "<span class=\"quiet\">not given</span>" : cell_text(row.paper);
  return fmt::format(
      "<tr>{}<td class=\"quantity\">{}</td><td class=\"number\" data-head=\"Paper\">{}</td><td class=\"number\" "
      "data-head=\"Ours\">{}</td><td data-head=\"Verdict\">{}</td><td class=\"remark\">{}</td></tr>\n",
      lead, cell_text(row.quantity), paper, cell_text(row.ours), verdict_html(row.verdict), cell_text(row.remark));
}

// A long table is folded away, so that what comes after it is not pushed out of sight.
std::string folded(const std::string& summary, const std::string& content) {
  return "<details><summary>" + markup_text(summary) + "</summary>\n" + content + "</details>\n";
}

// Where everything is, with what each part shows and how its numbers compare.
std::string contents_html(const Result& result) {
  std::string text = "<nav id=\"contents\" aria-label=\"Contents\">\n<h2>Contents</h2>\n<ol>\n";
  for (const PartState& state : result.parts) {
    text += fmt::format("<li><a href=\"#{}\"><span class=\"label\">{}</span>{}</a>", state.info->id,
                        markup_text(state.info->label), markup_text(state.info->title));
    text += state.kept ? verdicts_html(state.kept->part) : "<span class=\"verdict open\">not made</span>";
    text += "</li>\n";
  }
  return text +
         "<li><a href=\"#verdicts\">Paper and reproduction: all numbers</a></li>\n<li><a href=\"#times\">CPU time of "
         "each part</a></li>\n</ol>\n</nav>\n";
}

// The caption is text, the rows are HTML.
std::string table_html(std::string_view style, const std::string& caption, const std::vector<std::string>& heads,
                       const std::string& rows) {
  std::string text = fmt::format("<div class=\"table\"><table class=\"{}\">", style);
  if (!caption.empty()) text += "<caption>" + markup_text(caption) + "</caption>";
  text += "<thead><tr>";
  for (const std::string& head : heads) text += "<th scope=\"col\">" + markup_text(head) + "</th>";
  return text + "</tr></thead><tbody>\n" + rows + "</tbody></table></div>\n";
}

std::string overview_html(const Result& result) {
  std::string rows;
  for (const PartState& state : result.parts) {
    if (!state.kept) continue;
    for (const Row& row : state.kept->part.rows) {
      rows += row_html(row, fmt::format("<td class=\"part\"><a href=\"#{}\">{}</a></td>", state.info->id,
                                        markup_text(state.info->label)));
    }
  }
  return table_html("rows", "", {"Part", "Quantity", "Paper", "Ours", "Verdict", "Remark"}, rows);
}

std::string table_html(const Table& table) {
  std::string rows;
  for (const auto& row : table.rows) {
    rows += "<tr>";
    for (const std::string& cell : row) rows += "<td>" + markup_text(cell) + "</td>";
    rows += "</tr>\n";
  }
  return table_html("numbers", table.caption, table.heads, rows);
}

// Drawings stand in the page itself, without the line that says that they are XML.
std::string picture_html(const Picture& picture, const std::string& folder) {
  const std::string bytes = read_text<InputError>(folder + "/" + picture.file);
  std::string image;
  if (picture.file.ends_with(".svg")) {
    const std::size_t begin = bytes.find("<svg");
    image = begin == std::string::npos ? "" : bytes.substr(begin);
  } else {
    image = fmt::format("<img alt=\"{}\" src=\"data:image/png;base64,", markup_text(picture.caption));
    append_base64(std::as_bytes(std::span(bytes)), image);
    image += "\">\n";
  }
  return fmt::format("<figure class=\"across{}\"><div class=\"sheet\">\n{}</div><figcaption>{}</figcaption></figure>\n",
                     picture.across, image, markup_text(picture.caption));
}

std::string command_html(const std::string& command) {
  return "<div class=\"command\"><pre>" + markup_text(command) + "</pre></div>\n";
}

std::string part_html(const PartState& state, const Store& store) {
  const PartInfo& info = *state.info;
  std::string text = fmt::format(
      "<section id=\"{}\">\n<h2><span class=\"label\">{}</span>{}</h2>\n<p class=\"quiet\">In the paper: {}</p>\n",
      info.id, markup_text(info.label), markup_text(info.title), markup_text(info.paper));
  if (!state.kept) {
    return text + "<div class=\"missing\"><p>Not made yet. This command makes it:</p>\n" +
           command_html(command_of(info)) + "</div>\n</section>\n";
  }
  const Part& part = state.kept->part;
  text += fmt::format("<p><span class=\"origin\">{}</span>{}</p>\n", to_string(part.origin), markup_text(part.source));
  text += "<div class=\"figures\">\n";
  for (const Picture& picture : part.pictures) text += picture_html(picture, store.folder_of(std::string(info.id)));
  text += "</div>\n";
  std::string rows;
  for (const Row& row : part.rows) rows += row_html(row, "");
  if (!rows.empty()) text += table_html("rows", "", {"Quantity", "Paper", "Ours", "Verdict", "Remark"}, rows);
  for (const Table& table : part.tables) {
    constexpr std::size_t kLongTable = 8;  // rows
    const std::string html = table_html(table);
    text += table.rows.size() <= kLongTable
                ? html
                : folded(fmt::format("{} ({} rows)", table.caption, table.rows.size()), html);
  }
  if (!part.notes.empty()) text += "<ul class=\"notes\">\n";
  for (const std::string& note : part.notes) text += "<li>" + markup_text(note) + "</li>\n";
  if (!part.notes.empty()) text += "</ul>\n";
  text += "<h3>This part alone</h3>\n" + command_html(command_of(info));
  if (!part.by_hand.empty()) {
    std::string steps;
    for (const std::string& command : part.by_hand) steps += command + "\n";
    steps.pop_back();
    text +=
        "<details><summary>Step by step, with the ordinary commands</summary>\n" + command_html(steps) + "</details>\n";
  }
  return text + fmt::format("<p class=\"quiet\">Made {}, {} of CPU time.</p>\n</section>\n",
                            markup_text(state.kept->date), seconds_text(state.kept->cpu_s));
}

std::string fact(std::string_view name, const std::string& value) {
  return fmt::format("<div><dt>{}</dt><dd>{}</dd></div>\n", name, markup_text(value));
}

std::string header_html(const Result& result) {
  const VerdictCounts counts = counts_of(result);
  std::string text =
      fmt::format("<h1>The paper, figure by figure</h1>\n<p>{}</p>\n<p><strong>{}</strong></p>\n<dl class=\"facts\">\n",
                  kAbout, kNotPublished);
  text += fact("Version", "gdtslam " + result.host.version) + fact("Report written", utc_text());
  text += fact("Processor", fmt::format("{}, {} threads", result.host.processor, result.host.threads));
  text += fact("Device", result.host.device);
  text += fact("Parts", fmt::format("{} of {} made, {} of CPU time", parts_made(result), result.parts.size(),
                                    seconds_text(cpu_s_of_parts(result))));
  text +=
      fact("Verdicts", fmt::format("{} within, {} outside, {} without", counts.within, counts.outside, counts.open));
  return text + "</dl>\n";
}

std::string times_html(const Result& result) {
  std::string rows;
  for (const PartState& state : result.parts) {
    rows += fmt::format("<tr><td><a href=\"#{}\">{}</a></td><td>{}</td><td>{}</td><td>{}</td></tr>\n", state.info->id,
                        markup_text(state.info->label), markup_text(state.info->title),
                        state.kept ? seconds_text(state.kept->cpu_s) : "not made",
                        state.kept ? markup_text(state.kept->date) : "");
  }
  return "<section id=\"times\">\n<h2>CPU time of each part</h2>\n<p class=\"quiet\">Of parts that share a simulated "
         "drive the first one has its time.</p>\n" +
         table_html("numbers", "", {"Part", "Shows", "CPU time", "Made"}, rows) + "</section>\n";
}

std::string filled(std::string_view skeleton, std::string_view name, std::string_view text) {
  const std::string mark = fmt::format("{{{{{}}}}}", name);
  std::string out(skeleton);
  out.replace(out.find(mark), mark.size(), text);
  return out;
}

// Drawings stand in the page as they lie in the folder, and may have been changed there: only the page's own script
// runs, and nothing is fetched.
std::string policy() {
  return fmt::format("default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src {}",
                     report_text::program_hash());
}

}  // namespace

std::string html_of(const Result& result, const Store& store) {
  const VerdictCounts counts = counts_of(result);
  std::string body = header_html(result) + contents_html(result);
  for (const PartState& state : result.parts) body += part_html(state, store);
  body += fmt::format(
      "<section id=\"verdicts\">\n<h2>Paper and reproduction</h2>\n<p class=\"quiet\">{}</p>\n{}</section>\n",
      kVerdicts,
      folded(fmt::format("All {} numbers in one table", counts.within + counts.outside + counts.open),
             overview_html(result)));
  body += times_html(result);
  std::string page = filled(report_text::skeleton(), "title", "The paper, figure by figure \u2013 gdtslam");
  page = filled(page, "policy", policy());
  page = filled(page, "style", report_text::style());
  page = filled(page, "script", report_text::program());
  return filled(page, "body", body);
}

}  // namespace gdtslam::reproduce
