/* gdtslam for programs in C and in every language that can call C: mapping, localisation, reading logs, pictures.
 *
 * Frames and units: metres, radians, seconds; x forward, y left, angles counter-clockwise. T_a_b is the pose of b in
 * the frame a. Row 0 of a grid has the lowest y.
 *
 * Every function that can fail returns a gdtslam_status and takes a gdtslam_error, which may be NULL, for its text.
 * All state is in the handles: calls with different handles may run in different threads. One handle belongs to one
 * thread at a time; functions that take it as const may run in several. Arguments are copied unless stated otherwise.
 * Each kind of handle is freed by its own function, which accepts NULL. Texts are UTF-8 and end in 0. In the child of a
 * fork() the parent's handles must be neither used nor freed, because their threads are missing; new handles work.
 *
 * Structs begin with their size, which GDTSLAM_INIT sets. Members that an older program lacks count as 0, which always
 * means the default, and only members that it has are filled in. Later versions add functions and, at their ends,
 * members of structs; neither is moved or removed while the library's name ends in .so.0. */
#ifndef GDTSLAM_H
#define GDTSLAM_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define GDTSLAM_API __attribute__((visibility("default")))

/* gdtslam_scan scan; GDTSLAM_INIT(scan); scan.stamp_s = ...: all members 0, the size set. */
#ifdef __cplusplus
#define GDTSLAM_INIT(variable)          \
  do {                                  \
    (variable) = decltype(variable)();  \
    (variable).size = sizeof(variable); \
  } while (0)
#else
#define GDTSLAM_INIT(variable)                           \
  do {                                                   \
    size_t gdtslam_byte = sizeof(variable);              \
    while (gdtslam_byte > 0) {                           \
      ((unsigned char*)&(variable))[--gdtslam_byte] = 0; \
    }                                                    \
    (variable).size = sizeof(variable);                  \
  } while (0)
#endif

/* ---- Status and errors --------------------------------------------------------------------------------------- */

/* The exit codes of the command. */
typedef int32_t gdtslam_status;
enum {
  GDTSLAM_OK = 0,
  GDTSLAM_FAILED = 1,         /* failed while running */
  GDTSLAM_USAGE = 2,          /* an invalid call, such as NULL for a required pointer */
  GDTSLAM_BAD_INPUT = 65,     /* unusable data */
  GDTSLAM_UNAVAILABLE = 69,   /* not in this build or not on this machine */
  GDTSLAM_OUT_OF_MEMORY = 71, /* the command exits with 1 */
  GDTSLAM_INPUT_OUTPUT = 74,  /* a file cannot be read or written */
  GDTSLAM_BAD_CONFIG = 78,    /* an unknown option, or a value out of bounds */
  GDTSLAM_INTERRUPTED = 130   /* ended by the caller's progress function */
};

/* The text of an error: one line with the fault, its place, and what to do. */
typedef struct gdtslam_error {
  size_t size;
  gdtslam_status status;
  char text[1012]; /* longer texts are cut; a caller may have more room after it, and state that in size */
} gdtslam_error;

/* "0.1.0", the version of the loaded library. */
GDTSLAM_API const char* gdtslam_version(void);
/* "bad input"; "unknown status" for other values. */
GDTSLAM_API const char* gdtslam_status_name(gdtslam_status status);

/* ---- Options ------------------------------------------------------------------------------------------------- */

/* Every option of the command's configuration, by the same names and values: `gdtslam config show` lists them.
 * Functions copy options; NULL means the defaults. */
typedef struct gdtslam_options gdtslam_options;

GDTSLAM_API gdtslam_status gdtslam_options_new(gdtslam_options** options, gdtslam_error* error);
GDTSLAM_API void gdtslam_options_free(gdtslam_options* options);
/* "map.resolution", "5 cm". */
GDTSLAM_API gdtslam_status gdtslam_options_set(gdtslam_options* options, const char* path, const char* value,
                                               gdtslam_error* error);
/* A configuration file, YAML. */
GDTSLAM_API gdtslam_status gdtslam_options_read(gdtslam_options* options, const char* file, gdtslam_error* error);

/* One option with its current value. */
typedef struct gdtslam_option {
  size_t size;
  const char* path;
  const char* doc;
  const char* value; /* with its unit, as for gdtslam_options_set */
} gdtslam_option;

GDTSLAM_API size_t gdtslam_options_count(const gdtslam_options* options);
/* The texts are valid until the next call with these options. */
GDTSLAM_API gdtslam_status gdtslam_options_at(gdtslam_options* options, size_t index, gdtslam_option* option,
                                              gdtslam_error* error);

typedef struct gdtslam_pose {
  double x_m;
  double y_m;
  double theta_rad;
} gdtslam_pose;

/* For recordings (bags, MCAP): adds a topic of scans to read; call once for each, or "all". Default: the only one. */
GDTSLAM_API gdtslam_status gdtslam_options_add_topic(gdtslam_options* options, const char* topic, gdtslam_error* error);
/* The topic of the odometry, or "tf". Default: the first one, else the transforms. */
GDTSLAM_API gdtslam_status gdtslam_options_set_odometry(gdtslam_options* options, const char* topic,
                                                        gdtslam_error* error);
/* The topic of a nodding mount's crank, "TOPIC" or "TOPIC:JOINT". */
GDTSLAM_API gdtslam_status gdtslam_options_set_crank(gdtslam_options* options, const char* topic, gdtslam_error* error);
/* Mount of the laser on the robot, replacing the log's; for the laser of one topic, or for all if topic is NULL. */
GDTSLAM_API gdtslam_status gdtslam_options_add_mount(gdtslam_options* options, const char* topic,
                                                     const gdtslam_pose* T_base_laser, gdtslam_error* error);

/* ---- Logs and scans ------------------------------------------------------------------------------------------ */

/* A sweep of the laser. Beam k points to first_bearing_rad + k * bearing_step_rad in the laser's frame, 0 is ahead. */
typedef struct gdtslam_scan {
  size_t size;
  double stamp_s;
  double first_bearing_rad;
  double bearing_step_rad;
  const float* ranges_m; /* not finite, or 0, or at the limit: no return */
  size_t range_count;
  double max_range_m; /* the limit; 0: unknown */
  gdtslam_pose T_base_laser;
  /* Beam k was measured at stamp_s + first_beam_after_s + k * beam_period_s. */
  double first_beam_after_s;
  double beam_period_s;
  int32_t has_odometry;     /* whether T_odom_base counts */
  int32_t has_speed;        /* whether speed counts */
  gdtslam_pose T_odom_base; /* by the wheels, in any fixed frame */
  gdtslam_pose speed;       /* the robot's motion during the scan: a second, in its own frame */
  uint64_t laser;           /* number of the laser, in the order of their first scans */
} gdtslam_scan;

/* Reads logs of every format that the command reads, plain or packed, in order as one log. */
typedef struct gdtslam_reader gdtslam_reader;

/* Flags for reader, map, mapper and localizer; each comment names its users. */
enum {
  GDTSLAM_LENIENT = 1,          /* count and skip malformed lines (reader, map) */
  GDTSLAM_NO_LOOPS = 2,         /* match with one map of all scans (map, mapper) */
  GDTSLAM_NO_MAP = 4,           /* no occupancy map and no pictures (map) */
  GDTSLAM_NO_PICTURES = 8,      /* (map) */
  GDTSLAM_NO_CLOUD = 16,        /* no cloud of a nodding laser (map) */
  GDTSLAM_REPLACE_FOREIGN = 64, /* remove foreign files in the folder; otherwise it is refused (map) */
  GDTSLAM_NO_RUNNER_UP = 128    /* do not search the best pose elsewhere (localizer) */
};

/* Called during the work, in the thread of the call: "scans" with their number and the share of the log, then the steps
 * of closing loops and of writing, with their share; negative if unknown. A result other than 0 ends the work. While a
 * pipe gives nothing, "scans" is repeated after each signal that interrupts the wait, and every 0.2 s, because a signal
 * may come just before the wait. */
typedef int32_t (*gdtslam_progress)(void* user_data, const char* step, uint64_t scans, double share);

typedef struct gdtslam_reader_request {
  size_t size;
  const char* const* logs; /* read in order as one log */
  size_t log_count;
  const gdtslam_options* options; /* only options of the log count */
  uint32_t flags;
  uint32_t reserved; /* 0 */
  /* Called only while the reader waits for a pipe: after a signal, and every 0.2 s. It may call only the reader's
   * functions for progress and warnings. A result other than 0: the waiting call returns GDTSLAM_INTERRUPTED, and so
   * does every later gdtslam_reader_next, because a partly read scan is lost. */
  gdtslam_progress progress;
  void* user_data;
} gdtslam_reader_request;

GDTSLAM_API gdtslam_status gdtslam_reader_new(const gdtslam_reader_request* request, gdtslam_reader** reader,
                                              gdtslam_error* error);
/* The same without progress(): signals do not end a wait for a pipe. */
GDTSLAM_API gdtslam_status gdtslam_reader_open(const char* const* logs, size_t log_count,
                                               const gdtslam_options* options, uint32_t flags, gdtslam_reader** reader,
                                               gdtslam_error* error);
GDTSLAM_API void gdtslam_reader_free(gdtslam_reader* reader);
/* The next scan with its odometry. *has_scan is 0 at the end. The ranges are valid until the next call with this
 * reader. */
GDTSLAM_API gdtslam_status gdtslam_reader_next(gdtslam_reader* reader, gdtslam_scan* scan, int32_t* has_scan,
                                               gdtslam_error* error);
/* Share of the logs read so far; negative if unknown. */
GDTSLAM_API double gdtslam_reader_progress(const gdtslam_reader* reader);

/* Skipped or corrected parts, counted by kind. */
typedef struct gdtslam_log_warning {
  size_t size;
  const char* kind;
  const char* first; /* place and text of the first one */
  uint64_t count;
} gdtslam_log_warning;

/* Warnings so far; the texts are valid until the next call with this reader. *has_warning is 0 after the last one. */
GDTSLAM_API gdtslam_status gdtslam_reader_warning(gdtslam_reader* reader, size_t index, gdtslam_log_warning* warning,
                                                  int32_t* has_warning, gdtslam_error* error);

/* ---- Grids --------------------------------------------------------------------------------------------------- */

/* The cells of a map or of a distance field, as of the creation of the handle. They stay valid and in place until it is
 * freed, independent of their source. */
typedef struct gdtslam_grid gdtslam_grid;

typedef struct gdtslam_grid_view {
  size_t size;
  const void* cells; /* column x of row y: (const unsigned char*)cells + y * row_bytes + x * cell_bytes */
  size_t row_bytes;
  size_t cell_bytes; /* distance field: 2, uint16_t in 1/256 cell; map: 1, uint8_t, see below */
  int32_t width;     /* columns */
  int32_t height;    /* rows */
  double resolution_m;
  double origin_x_m; /* the lower left corner of the lower left cell */
  double origin_y_m;
  uint32_t cap; /* distance field: value of cells at least this far away, or unknown */
} gdtslam_grid_view;

/* The cells of a map, as in map.pgm. */
enum { GDTSLAM_OCCUPIED = 0, GDTSLAM_UNKNOWN = 205, GDTSLAM_FREE = 254 };

/* Valid until the grid is freed. */
GDTSLAM_API gdtslam_status gdtslam_grid_look(const gdtslam_grid* grid, gdtslam_grid_view* view, gdtslam_error* error);
/* Hash of a distance field, map_sha256 in report.json. "" for a map, and if memory runs out. Valid until the grid is
 * freed. */
GDTSLAM_API const char* gdtslam_grid_sha256(const gdtslam_grid* grid);
GDTSLAM_API void gdtslam_grid_free(gdtslam_grid* grid);

/* ---- Runs ---------------------------------------------------------------------------------------------------- */

/* The folder of a mapped log. */
typedef struct gdtslam_run gdtslam_run;

/* One line that a user should see: a remark during the run; after the run is written, one line for each kind of skipped
 * or corrected part of the log. */
typedef void (*gdtslam_warn)(void* user_data, const char* text);

typedef struct gdtslam_map_request {
  size_t size;
  const char* const* logs; /* mapped in order as one log */
  size_t log_count;
  const char* folder; /* folder of the results; made if need be */
  const gdtslam_options* options;
  const char* linkage; /* for a nodding laser: preset or file; NULL: the file beside the log, else the default */
  uint32_t flags;
  uint32_t threads;    /* 0: as the command without --threads; UINT32_MAX: one per processor. Results are the same */
  uint64_t skip;       /* scans at the start */
  uint64_t scan_count; /* 0: all */
  gdtslam_progress progress;
  gdtslam_warn warn;
  void* user_data; /* for both functions */
} gdtslam_map_request;

/* Maps like `gdtslam map LOG -o FOLDER`, with the same bytes in the folder, but without the picture of a cloud, which
 * needs OpenGL. `run` may be NULL; else it gets the run with poses in full precision. GDTSLAM_INTERRUPTED: the results
 * so far are written, and *run has them, or NULL if there was no scan yet. */
GDTSLAM_API gdtslam_status gdtslam_map_log(const char* log, const char* folder, gdtslam_run** run,
                                           gdtslam_error* error);
GDTSLAM_API gdtslam_status gdtslam_map_logs(const gdtslam_map_request* request, gdtslam_run** run,
                                            gdtslam_error* error);
/* Opens an existing run. */
GDTSLAM_API gdtslam_status gdtslam_run_open(const char* folder, gdtslam_run** run, gdtslam_error* error);
GDTSLAM_API void gdtslam_run_free(gdtslam_run* run);

/* Texts of a run are valid until it is freed. */
GDTSLAM_API const char* gdtslam_run_folder(const gdtslam_run* run);
GDTSLAM_API const char* gdtslam_run_map_sha256(const gdtslam_run* run);
GDTSLAM_API const char* gdtslam_run_trajectory_sha256(const gdtslam_run* run);
/* report.json. */
GDTSLAM_API const char* gdtslam_run_report(const gdtslam_run* run);

typedef struct gdtslam_stamped_pose {
  double stamp_s;
  double x_m;
  double y_m;
  double theta_rad;
} gdtslam_stamped_pose;

/* One pose of the robot for each scan, valid until the run is freed; thread-safe. For an opened run, the poses of
 * trajectory.tum, nine decimals. */
GDTSLAM_API gdtslam_status gdtslam_run_trajectory(gdtslam_run* run, const gdtslam_stamped_pose** poses, size_t* count,
                                                  gdtslam_error* error);
/* The occupancy map and the distance field. */
GDTSLAM_API gdtslam_status gdtslam_run_map(const gdtslam_run* run, gdtslam_grid** map, gdtslam_error* error);
GDTSLAM_API gdtslam_status gdtslam_run_field(const gdtslam_run* run, gdtslam_grid** field, gdtslam_error* error);

/* Bytes made by the library. */
typedef struct gdtslam_bytes gdtslam_bytes;

GDTSLAM_API const void* gdtslam_bytes_data(const gdtslam_bytes* bytes);
GDTSLAM_API size_t gdtslam_bytes_count(const gdtslam_bytes* bytes);
GDTSLAM_API void gdtslam_bytes_free(gdtslam_bytes* bytes);

typedef struct gdtslam_picture_request {
  size_t size;
  const char* view;   /* "map" (NULL), "graph", "field", "distance": as `gdtslam render --view` draws them */
  const char* format; /* "png" (NULL), "svg", "pdf" */
  uint32_t width;     /* pixels; 0 and 0: a size that suits the map */
  uint32_t height;
  const char* title;      /* NULL: the log's name */
  const char* colour_map; /* colours of the field; NULL: the view's own */
} gdtslam_picture_request;

/* A picture as the bytes of a file. `request` may be NULL. */
GDTSLAM_API gdtslam_status gdtslam_run_render(const gdtslam_run* run, const gdtslam_picture_request* request,
                                              gdtslam_bytes** picture, gdtslam_error* error);

/* ---- Mapping live -------------------------------------------------------------------------------------------- */

/* Takes one scan and gives one pose. */
typedef struct gdtslam_mapper gdtslam_mapper;

typedef struct gdtslam_mapper_request {
  size_t size;
  const gdtslam_options* options;
  uint32_t flags;
  uint32_t threads; /* as in gdtslam_map_request */
} gdtslam_mapper_request;

/* `request` may be NULL. */
GDTSLAM_API gdtslam_status gdtslam_mapper_new(const gdtslam_mapper_request* request, gdtslam_mapper** mapper,
                                              gdtslam_error* error);
GDTSLAM_API void gdtslam_mapper_free(gdtslam_mapper* mapper);

/* Why a match is in doubt. */
enum {
  GDTSLAM_DOUBT_NONE = 0,
  GDTSLAM_DOUBT_FEW_POINTS = 1,    /* refused: too few returns to match */
  GDTSLAM_DOUBT_LOW_OVERLAP = 2,   /* refused: too few points near known obstacles */
  GDTSLAM_DOUBT_CONTRADICTION = 3, /* refused: too many points beside known obstacles */
  GDTSLAM_DOUBT_WEAK_EVIDENCE = 4, /* accepted all the same */
  GDTSLAM_DOUBT_FAR = 5            /* accepted, though far from the prediction */
};
/* "few-points"; "unknown doubt" for other values. */
GDTSLAM_API const char* gdtslam_doubt_name(int32_t doubt);

typedef struct gdtslam_match {
  size_t size;
  double stamp_s;
  gdtslam_pose T_map_base;      /* the match, or the prediction if it was refused; never leaps */
  gdtslam_pose T_map_predicted; /* by the odometry */
  /* Pose of the frame of these poses in the frame with the loops found so far closed; it leaps. */
  gdtslam_pose correction;
  double mean_distance_m; /* of the points to the map's obstacles, capped */
  double overlap;         /* share of the points near known obstacles */
  double contradiction;   /* share of the points beside known obstacles */
  uint32_t points;
  int32_t doubt;
  int32_t is_accepted;
  int32_t is_keyframe; /* the scan went into the map */
} gdtslam_match;

/* The origin of the map is the robot's pose at the first scan. */
GDTSLAM_API gdtslam_status gdtslam_mapper_process(gdtslam_mapper* mapper, const gdtslam_scan* scan,
                                                  gdtslam_match* match, gdtslam_error* error);
/* Call after the last scan: closes the rest of the loops and adjusts the path, unless progress() (may be NULL) ends it
 * before. Does nothing without loops. */
GDTSLAM_API gdtslam_status gdtslam_mapper_close(gdtslam_mapper* mapper, gdtslam_progress progress, void* user_data,
                                                gdtslam_error* error);
/* One pose for each scan, of the front end until the mapper is closed. Valid until the next call with this mapper. */
GDTSLAM_API gdtslam_status gdtslam_mapper_trajectory(gdtslam_mapper* mapper, const gdtslam_stamped_pose** poses,
                                                     size_t* count, gdtslam_error* error);
/* The distance field as of this call. With loops: from the keyframes so far, in the frame with closed loops. */
GDTSLAM_API gdtslam_status gdtslam_mapper_field(gdtslam_mapper* mapper, gdtslam_grid** field, gdtslam_error* error);

/* ---- Localisation -------------------------------------------------------------------------------------------- */

/* Finds scans anywhere in a map, without odometry and with a proof. */
typedef struct gdtslam_localizer gdtslam_localizer;

typedef struct gdtslam_localizer_request {
  size_t size;
  const char* map; /* a run folder, its gdt.yaml, or the map.yaml of an occupancy map of any program */
  const gdtslam_options* options;
  uint32_t flags;
  uint32_t reserved;  /* 0 */
  double gap_m;       /* no pose has a mean distance that is smaller by more than this; 0: 5 mm */
  double max_seconds; /* limit for a pose; 0: until it is proven */
  double good_fit_m;  /* largest mean distance of a good fit; 0: from the map */
} gdtslam_localizer_request;

GDTSLAM_API gdtslam_status gdtslam_localizer_new(const gdtslam_localizer_request* request,
                                                 gdtslam_localizer** localizer, gdtslam_error* error);
/* Trackers made from it stay valid. */
GDTSLAM_API void gdtslam_localizer_free(gdtslam_localizer* localizer);

/* Result of the search for a scan. */
enum {
  GDTSLAM_FOUND = 0,
  GDTSLAM_AMBIGUOUS = 1, /* a pose elsewhere may fit about as well */
  GDTSLAM_POOR_FIT = 2,  /* even the best pose fits worse than scans of the mapped place */
  GDTSLAM_NO_POSE = 3    /* too few returns, or max_seconds too short */
};

typedef struct gdtslam_location {
  size_t size;
  int32_t verdict;
  int32_t has_runner_up;
  gdtslam_pose T_map_base;
  double mean_distance_m; /* of the scan's points to the map's obstacles, capped */
  double proven_gap_m;    /* no pose has a smaller one by more than this */
  gdtslam_pose runner_up; /* the best pose elsewhere: 1 m or 20 degrees away */
  double runner_up_mean_distance_m;
  uint32_t points;
} gdtslam_location;

GDTSLAM_API gdtslam_status gdtslam_localizer_find(const gdtslam_localizer* localizer, const gdtslam_scan* scan,
                                                  gdtslam_location* location, gdtslam_error* error);

/* Follows a robot in a fixed map, and finds its start by itself. */
typedef struct gdtslam_tracker gdtslam_tracker;

GDTSLAM_API gdtslam_status gdtslam_tracker_new(const gdtslam_localizer* localizer, gdtslam_tracker** tracker,
                                               gdtslam_error* error);
GDTSLAM_API void gdtslam_tracker_free(gdtslam_tracker* tracker);

/* Source of a scan's pose. */
enum {
  GDTSLAM_NOWHERE = 0,    /* none: not found yet, or lost */
  GDTSLAM_JUST_FOUND = 1, /* a search of the whole map; the drive since then is too short to confirm it */
  GDTSLAM_TRACKED = 2,    /* a good match near the prediction */
  GDTSLAM_PREDICTED = 3   /* the wheels since the last good match */
};

typedef struct gdtslam_tracked {
  size_t size;
  int32_t whereabouts;
  int32_t is_ambiguous; /* another place fitted equally well at the search, and nothing has distinguished them yet */
  gdtslam_pose T_map_base;
  double explained;       /* share of the scan's points near an obstacle of the map */
  double mean_distance_m; /* of the points to the map's obstacles, capped */
  double covariance[6];   /* xx, xy, x theta, yy, y theta, theta theta along the map's axes */
} gdtslam_tracked;

GDTSLAM_API gdtslam_status gdtslam_tracker_follow(gdtslam_tracker* tracker, const gdtslam_scan* scan,
                                                  gdtslam_tracked* tracked, gdtslam_error* error);

#ifdef __cplusplus
}
#endif

#endif
