// JSON files by nlohmann-json; the one public header of io that names it, so that only who needs JSON includes it. An
// object that is to be filled begins as Json::object(): operator[] of a null sets the type before it has the memory,
// and where that has ended the destructor follows a null. Thread-safe; O(text).
#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace gdtslam {

/// A member of an object is a line, indented by two, and so is an entry of a list that is a table's row: an object or
/// list without others in it, of up to 120 columns. A list of numbers is one line however long it is, another list of
/// plain values where it fits: a report with thousands of keyframes stays short. Numbers in the shortest form that
/// reads back as the same bits, not-finite ones as null, text in ASCII (\u00fc) and with replacement characters where
/// it is no UTF-8; ends in a newline.
std::string json_text(const nlohmann::ordered_json& value);
/// Atomic. Throws FileError.
void write_json(const std::string& path, const nlohmann::ordered_json& value);
/// The value of a file that others may have written. A hostile text costs no more memory than a large one of ours:
/// refused are more than `most_bytes`, brackets nested deeper than 16, more than 2.5 million values and objects of more
/// than 256 members, before any value is made. Throws FileError where it cannot be read, else InputError with the line
/// of what is no JSON; `advice` says what to do and ends the message.
nlohmann::ordered_json read_json(const std::string& path, std::size_t most_bytes, const std::string& advice = "");

/// The same for a text in memory; `name` stands in messages.
nlohmann::ordered_json parse_json(std::string_view text, const std::string& name, const std::string& advice = "");

}  // namespace gdtslam
