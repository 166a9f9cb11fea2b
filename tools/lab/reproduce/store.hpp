// Where finished parts are kept: DIR/parts/ID with part.json and the pictures. A part counts as finished while its key
// is the same, which stands for the program and all inputs. A part is made in a folder beside it that takes its place
// when all is written, so that what is kept is whole; folders that are not of this program stay as they are. Processes
// may use one folder at the same time for different parts.
#pragma once

#include <optional>
#include <string>

#include "part.hpp"

namespace gdtslam::reproduce {

/// A part as it is kept.
struct KeptPart {
  Part part;
  double cpu_s = 0.0;  ///< that making it took, with the drives that were made for it
  std::string date;    ///< when it was made, UTC
};

class Store {
 public:
  /// Makes DIR and DIR/parts if need be. Throws FileError, as the others do.
  explicit Store(const std::string& folder);

  /// The part where it was made with that key and all its pictures are there; what is damaged counts as not made.
  [[nodiscard]] std::optional<KeptPart> find(const std::string& id, const std::string& key) const;
  /// An empty folder to make the part in.
  std::string begin(const std::string& id);
  /// What begin() gave becomes the part.
  void keep(const std::string& id, const std::string& key, const KeptPart& part);
  /// Nothing of what begin() gave stays.
  void drop(const std::string& id) noexcept;
  /// Throws where a folder of somebody else has the name of the part's.
  void require_own(const std::string& id) const;
  /// "parts/fig3", relative to DIR.
  [[nodiscard]] static std::string place_of(const std::string& id) { return "parts/" + id; }
  [[nodiscard]] std::string folder_of(const std::string& id) const { return folder_ + "/" + place_of(id); }

 private:
  std::string folder_;
};

/// "2026-11-20 15:04 UTC".
std::string utc_text();

// Folders that `gdtslam reproduce` makes beside what its user has, and removes again. Each carries a mark, and nothing
// without the mark is removed, save empty folders.

/// True for a folder with the mark.
bool is_marked_folder(const std::string& path);
/// Throws FileError where something has this name that reproduce has not made.
void require_own_folder(const std::string& path);
/// Makes an empty folder with the mark; what had its name goes. Throws FileError, as the others do.
void make_marked_folder(const std::string& path);
/// The folder goes with all that is in it.
void remove_own_folder(const std::string& path);
/// The folder takes the name `to`, and what had that name goes afterwards: at each moment one of both has the name.
void replace_own_folder(const std::string& from, const std::string& to);

}  // namespace gdtslam::reproduce
