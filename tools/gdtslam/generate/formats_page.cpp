#include <array>

#include "man_pages.hpp"

namespace gdtslam {
namespace {

struct RunFile {
  const char* name;
  const char* text;
};

// The files that a run, an edit or a merge writes (engine/runs/folder); a test holds the names against a run folder.
constexpr std::array kRunFiles{
    RunFile{"map.pgm, map.yaml",
            "The occupancy map, for map_server of ROS and Nav2: an image and how it lies in the frame "
            "map."},
    RunFile{"gdt.png, gdt.yaml",
            "The distance field: distances to the nearest obstacle in 1/256 of a cell as 16-bit grey values, and where "
            "the field lies. 'gdtslam localize' searches in it."},
    RunFile{"trajectory.tum",
            "The pose of the robot at each scan, a line each: stamp x y z qx qy qz qw, in metres and seconds."},
    RunFile{"keyframes.bin.gz",
            "The scans that the map consists of, with their poses: what 'gdtslam merge', 'edit' and "
            "'tiles' work on."},
    RunFile{"covariance.csv", "How uncertain each pose is, where loops were closed."},
    RunFile{"graph.g2o", "The pose graph with its loops, for g2o and GTSAM."},
    RunFile{"overview.png, graph.png", "Pictures of the map with the path and of the loops."},
    RunFile{"cloud.ply, cloud.png", "The points of a laser that nods, and a picture of them."},
    RunFile{"linkage.yaml", "How the laser nods: the linkage that the cloud was made with."},
    RunFile{"config.yaml", "Every option with its value, to repeat the run with -c."},
    RunFile{"report.json",
            "What happened, in numbers: counts, times, hashes of the results, loops, and each scan that is "
            "in doubt."},
    RunFile{"continue.json", "What 'gdtslam map --continue' needs: the request, and each log with its SHA-256."},
    RunFile{"log-1.jsonl.zst", "A log that came through a pipe, as JSON lines (log-2.jsonl.zst and so on)."},
    RunFile{"edits.json", "The steps of 'gdtslam edit', to do them again."},
    RunFile{"session-1.tum", "Of a site of 'gdtslam merge': the path of its first run (session-2.tum and so on)."},
    RunFile{"tiles/",
            "The map in tiles of 2048 cells a side, where it is too large for one piece or 'gdtslam tiles' made "
            "them."},
};

}  // namespace

ManPage formats_page(const PageStamp& stamp) {
  RoffPage page("gdtslam-formats", 5, stamp, "files that gdtslam reads and writes");
  page.section("Files of a run");
  page.paragraph(
      plain("A run folder (") + bold("gdtslam map -o") + " " + italic("DIR") +
      plain(") has all of its files or none: they appear together once they are written. Poses are those of the "
            "robot; x points ahead, y to the left, in metres."));
  for (const RunFile& file : kRunFiles) page.item(bold(file.name), plain(file.text));
  page.section("Logs");
  page.paragraph(
      plain("Read are CARMEN logs (.log, .clf), CSV, JSON lines, ROS 1 bags (.bag), ROS 2 bags (a folder, or .db3) "
            "and MCAP, each plain or packed by gzip, bzip2, xz or zstd, and told by content. ") +
      bold("gdtslam doctor") + plain(" says what a log holds, ") + bold("gdtslam convert") +
      plain(" writes it in another format."));
  page.section("Other files");
  page.item(bold("NAME.linkage.yaml"), plain("Beside a log: the linkage of its laser, which is taken by itself."));
  page.item(bold("NAME.truth.tum"), plain("Beside a simulated log: the true poses."));
  page.item(bold("*.relations"), plain("Verified relations of poses, a line each: t1 t2 x y z roll pitch yaw."));
  page.paragraph(plain("docs/formats.md of the sources describes each format to the last field."));
  page.section("See also");
  page.paragraph(bold("gdtslam-map") + "(1), " + bold("gdtslam-convert") + "(1), " + bold("gdtslam-options") + "(5)");
  return {"gdtslam-formats", 5, page.text()};
}

}  // namespace gdtslam
