// The folder that a merge writes to: a run folder for each site, and merge.json, which tells of them. Everything is
// staged and on the disk before the first file of the first site gets its name. A merge that fails, whatever the
// reason, leaves the folder as it was, or removes it where it was not there. The old merge.json is away while the sites
// are replaced one after the other, and the new one comes last: where the process is killed meanwhile, none tells of
// sites that do not lie there. Nobody else writes to the folder or its sites as long as the object lives. One object
// belongs to one thread.
#pragma once

#include <cstddef>
#include <deque>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "engine/runs/folder/report_reader.hpp"
#include "engine/runs/folder/run_folder.hpp"

namespace gdtslam {

/// The place of a site among them.
class SiteFolder {
 public:
  /// For a site of so many sessions. Throws what RunFolder throws; UsageError where files of these names lie there that
  /// no run wrote, unless they are replaced.
  SiteFolder(const std::string& path, std::size_t sessions, bool replaces_foreign_files);
  /// Of a site that goes without another one in its place. Throws likewise; FileError where one of its files cannot go.
  explicit SiteFolder(const std::string& path);

  [[nodiscard]] std::string path() const { return folder_->path(); }
  /// Its number.
  [[nodiscard]] std::string name() const { return std::filesystem::path(path()).filename().string(); }
  /// Where the site is written, as a run folder of its own, until take_over().
  [[nodiscard]] std::string written() const;
  /// All files of the run that was written there are staged in place of those of the run that lies here. Throws
  /// FileError where one of them cannot be replaced.
  void take_over();
  /// Throws what RunFolder::commit() throws. Leftovers stay, as it may be undone.
  void commit();
  /// What killed processes left there, after commit(); where no site is written, what a merge left.
  void remove_leftovers() const;
  /// The old files have their names again after commit(). Says what cannot be undone, and then keeps them.
  std::string undo();

 private:
  void leave_out_old();
  void require_replaceable() const;

  std::vector<std::string> names_;
  std::vector<std::string> gone_;
  bool replaces_foreign_files_ = false;
  std::unique_ptr<RunFolder> folder_;
};

/// "session-1.tum": the path of a site's first run, counted from 0.
std::string session_file(std::size_t run);

class MergeFolder {
 public:
  /// Makes the folder if need be. Throws what RunFolder throws; UsageError where it holds a merge.json that no
  /// merge wrote, unless that is replaced.
  MergeFolder(const std::string& path, bool replaces_foreign_files);

  /// The next site's folder, numbered from 1. Throws what SiteFolder throws.
  SiteFolder& add_site(std::size_t sessions);
  /// After the last one: sites of an earlier merge with higher numbers go with commit(), and their folders where
  /// nothing else lies in them. Throws what SiteFolder throws.
  void leave_out_others();
  [[nodiscard]] SiteFolder& site(std::size_t number) { return sites_.at(number - 1); }
  /// All sites, which were taken over, get their names, and then merge.json of that text. Throws FileError.
  void commit(std::string_view report);

 private:
  void set_old_report_aside() const;
  void remove_empty_folders();
  std::string put_back(std::size_t committed);

  std::string path_;
  bool replaces_foreign_files_;
  RunFolder folder_;
  std::deque<SiteFolder> sites_;   ///< those that are written, and then those that go
  std::size_t written_sites_ = 0;  ///< set once all are known
};

}  // namespace gdtslam
