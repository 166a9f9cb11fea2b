/* Maps a log and prints what the map is, by its hash:  map LOG FOLDER  (docs/howto/c.md) */
#include <gdtslam.h>
#include <stdio.h>

int main(int argc, char** argv) {
  gdtslam_error error;
  GDTSLAM_INIT(error);
  if (argc != 3) {
    fprintf(stderr, "Usage: map LOG FOLDER\n");
    return GDTSLAM_USAGE;
  }
  gdtslam_run* run = NULL;
  if (gdtslam_map_log(argv[1], argv[2], &run, &error) != GDTSLAM_OK) {
    fprintf(stderr, "map: %s\n", error.text);
    return error.status;
  }
  printf("%s %s\n", gdtslam_run_map_sha256(run), gdtslam_run_trajectory_sha256(run));
  gdtslam_run_free(run);
  return 0;
}
