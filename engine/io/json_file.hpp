// JSON files by nlohmann-json; the only public header of io that includes it. Begin an object as Json::object():
// operator[] of a null sets the type before it allocates, and if that fails, the destructor follows a null pointer.
// Thread-safe; O(text).
#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace gdtslam {

/// Each member of an object is a line, indented by two, and so is each row of a table: a list's entry without nested
/// values, of up to 120 columns. A list of numbers is one line of any length, another list of plain values is one line
/// if it fits, so a report with thousands of keyframes stays short. Numbers in the shortest form that reads back as the
/// same bits, not-finite ones as null; text in ASCII (\u00fc), with replacement characters for invalid UTF-8; ends in a
/// newline.
std::string json_text(const nlohmann::ordered_json& value);
/// Atomic. Throws FileError.
void write_json(const std::string& path, const nlohmann::ordered_json& value);
/// The value of a file that others may have written. A hostile text costs no more memory than a large one of ours: more
/// than `most_bytes`, brackets nested deeper than 16, more than 2.5 million values and objects of more than 256 members
/// are refused before any value is made. Throws FileError if it cannot be read, else InputError with the line of the
/// fault; `advice` ends the message.
nlohmann::ordered_json read_json(const std::string& path, std::size_t most_bytes, const std::string& advice = "");

/// The same for a text in memory; `name` is for messages.
nlohmann::ordered_json parse_json(std::string_view text, const std::string& name, const std::string& advice = "");

}  // namespace gdtslam
