/* gdtslam for programs in C and in every language that can call C: mapping, localisation, reading logs, pictures.
 *
 * Frames and units: metres, radians, seconds; x forward, y left, angles counter-clockwise. T_a_b is the pose of b in
 * the frame a. A grid's row 0 is the one of the lowest y.
 *
 * Every function that can fail returns a gdtslam_status and takes a gdtslam_error, which may be NULL, for its text.
 * There is no other state than what the handles hold: calls with different handles may run in different threads; one
 * handle belongs to one thread at a time, but where it is taken as const, to all. What is passed in is copied unless
 * said otherwise. Handles are freed by their own function, which takes NULL, too. Texts are UTF-8 and end in 0. In the
 * child of a fork() those of the parent are of no use, nor to be freed: their threads are not there; new ones are.
 *
 * Structs begin with their size, which GDTSLAM_INIT sets: the library takes what a program of an older version leaves
 * out for 0, which always means the default, and fills in only what such a program has. Later versions add functions
 * and, at their ends, members of structs; neither moves or goes while the library's name ends in .so.0. */
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
  GDTSLAM_FAILED = 1,         /* while running */
  GDTSLAM_USAGE = 2,          /* a call that makes no sense, such as NULL where something is needed */
  GDTSLAM_BAD_INPUT = 65,     /* data that cannot be used */
  GDTSLAM_UNAVAILABLE = 69,   /* something that was asked for is not in this build or not on this machine */
  GDTSLAM_OUT_OF_MEMORY = 71, /* of which the command says 1 */
  GDTSLAM_INPUT_OUTPUT = 74,  /* a file that cannot be read or written */
  GDTSLAM_BAD_CONFIG = 78,    /* an option that there is not, or a value out of its bounds */
  GDTSLAM_INTERRUPTED = 130   /* by the caller's own progress function */
};

/* What went wrong: one line that says what, where, and what to do. */
typedef struct gdtslam_error {
  size_t size;
  gdtslam_status status;
  char text[1012]; /* cut off where it is longer; a caller may have more room behind it, and say so in size */
} gdtslam_error;

/* "0.1.0", of the library that is loaded. */
GDTSLAM_API const char* gdtslam_version(void);
/* "bad input"; "unknown status" for what is none. */
GDTSLAM_API const char* gdtslam_status_name(gdtslam_status status);

/* ---- Options ------------------------------------------------------------------------------------------------- */

/* Every option of the command's configuration, by the same names and values: `gdtslam config show` lists them. Where
 * options are taken they are copied; NULL stands for the defaults. */
typedef struct gdtslam_options gdtslam_options;

GDTSLAM_API gdtslam_status gdtslam_options_new(gdtslam_options** options, gdtslam_error* error);
GDTSLAM_API void gdtslam_options_free(gdtslam_options* options);
/* "map.resolution", "5 cm". */
GDTSLAM_API gdtslam_status gdtslam_options_set(gdtslam_options* options, const char* path, const char* value,
                                               gdtslam_error* error);
/* A configuration file, YAML. */
GDTSLAM_API gdtslam_status gdtslam_options_read(gdtslam_options* options, const char* file, gdtslam_error* error);

/* One option as it stands. */
typedef struct gdtslam_option {
  size_t size;
  const char* path;
  const char* doc;
  const char* value; /* with its unit, as gdtslam_options_set takes it */
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

/* Of recordings (bags, MCAP): a topic whose scans are read, called once for each; "all". Without: the only one. */
GDTSLAM_API gdtslam_status gdtslam_options_add_topic(gdtslam_options* options, const char* topic, gdtslam_error* error);
/* The topic of the odometry, or "tf". Without: the first one, else the transforms. */
GDTSLAM_API gdtslam_status gdtslam_options_set_odometry(gdtslam_options* options, const char* topic,
                                                        gdtslam_error* error);
/* The topic of a nodding mount's crank, "TOPIC" or "TOPIC:JOINT". */
GDTSLAM_API gdtslam_status gdtslam_options_set_crank(gdtslam_options* options, const char* topic, gdtslam_error* error);
/* Where the laser sits on the robot, whatever the log says; of the laser of one topic, or, where it is NULL, of all. */
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
  double max_range_m; /* the limit; 0: not known */
  gdtslam_pose T_base_laser;
  /* Beam k was measured at stamp_s + first_beam_after_s + k * beam_period_s. */
  double first_beam_after_s;
  double beam_period_s;
  int32_t has_odometry;     /* whether T_odom_base counts */
  int32_t has_speed;        /* whether speed counts */
  gdtslam_pose T_odom_base; /* by the wheels, in any frame that stays */
  gdtslam_pose speed;       /* how the robot moved meanwhile: a second, in its own frame */
  uint64_t laser;           /* which of several, in the order of their first scans */
} gdtslam_scan;

/* Reads logs of every format that the command reads, plain or packed, one after the other as one. */
typedef struct gdtslam_reader gdtslam_reader;

/* Flags of what reads logs, maps and localises; each says which. */
enum {
  GDTSLAM_LENIENT = 1,          /* count and skip what is malformed (reader, map) */
  GDTSLAM_NO_LOOPS = 2,         /* match with one map of all that was seen (map, mapper) */
  GDTSLAM_NO_MAP = 4,           /* no occupancy map and no pictures of it (map) */
  GDTSLAM_NO_PICTURES = 8,      /* (map) */
  GDTSLAM_NO_CLOUD = 16,        /* of a laser that nods (map) */
  GDTSLAM_REPLACE_FOREIGN = 64, /* remove files in the folder that no run wrote; else it is refused (map) */
  GDTSLAM_NO_RUNNER_UP = 128    /* do not look for the best pose elsewhere (localizer) */
};

/* Called while the work goes on, in the thread of the call: "scans" with their number and the share of the log, then
 * the steps of closing loops and of writing, with their share; negative where it is not known. Not 0 ends the work.
 * While a log that is a pipe gives nothing, "scans" come again after each signal that interrupts the wait, and every
 * 0.2 s, for a signal may come just before it. */
typedef int32_t (*gdtslam_progress)(void* user_data, const char* step, uint64_t scans, double share);

typedef struct gdtslam_reader_request {
  size_t size;
  const char* const* logs; /* read one after the other as one */
  size_t log_count;
  const gdtslam_options* options; /* of which those of the log count */
  uint32_t flags;
  uint32_t reserved; /* 0 */
  /* Called only while the reader waits for a pipe: after a signal, and every 0.2 s. It may ask how far the reader is and
   * for its warnings, and nothing else of it. Not 0: the call that waits gives GDTSLAM_INTERRUPTED, and so does every later
   * gdtslam_reader_next, for what had come of a scan is lost. */
  gdtslam_progress progress;
  void* user_data;
} gdtslam_reader_request;

GDTSLAM_API gdtslam_status gdtslam_reader_new(const gdtslam_reader_request* request, gdtslam_reader** reader,
                                              gdtslam_error* error);
/* The same without progress(): a wait for a pipe goes on, whatever signals come. */
GDTSLAM_API gdtslam_status gdtslam_reader_open(const char* const* logs, size_t log_count,
                                               const gdtslam_options* options, uint32_t flags, gdtslam_reader** reader,
                                               gdtslam_error* error);
GDTSLAM_API void gdtslam_reader_free(gdtslam_reader* reader);
/* The next scan, with the odometry that belongs to it. *has_scan is 0 at the end. The ranges are valid until the next
 * call with this reader. */
GDTSLAM_API gdtslam_status gdtslam_reader_next(gdtslam_reader* reader, gdtslam_scan* scan, int32_t* has_scan,
                                               gdtslam_error* error);
/* Share of the logs that was read; negative where that is not known. */
GDTSLAM_API double gdtslam_reader_progress(const gdtslam_reader* reader);

/* What was skipped or mended, counted by kind. */
typedef struct gdtslam_log_warning {
  size_t size;
  const char* kind;
  const char* first; /* where and what the first one was */
  uint64_t count;
} gdtslam_log_warning;

/* Those so far; the texts are valid until the next call with this reader. *has_warning is 0 behind the last one. */
GDTSLAM_API gdtslam_status gdtslam_reader_warning(gdtslam_reader* reader, size_t index, gdtslam_log_warning* warning,
                                                  int32_t* has_warning, gdtslam_error* error);

/* ---- Grids --------------------------------------------------------------------------------------------------- */

/* The cells of a map or of a distance field, as they were when the handle was made. They stay where they are until it
 * is freed, whatever becomes of what they come from. */
typedef struct gdtslam_grid gdtslam_grid;

typedef struct gdtslam_grid_view {
  size_t size;
  const void* cells; /* column x of row y: (const unsigned char*)cells + y * row_bytes + x * cell_bytes */
  size_t row_bytes;
  size_t cell_bytes; /* 2, uint16_t, of a distance field: 1/256 cell; 1, uint8_t, of a map: see below */
  int32_t width;     /* columns */
  int32_t height;    /* rows */
  double resolution_m;
  double origin_x_m; /* the lower left corner of the lower left cell */
  double origin_y_m;
  uint32_t cap; /* of a distance field: what a cell holds that is so far away or unknown */
} gdtslam_grid_view;

/* The cells of a map, as map.pgm has them. */
enum { GDTSLAM_OCCUPIED = 0, GDTSLAM_UNKNOWN = 205, GDTSLAM_FREE = 254 };

/* Valid until the grid is freed. */
GDTSLAM_API gdtslam_status gdtslam_grid_look(const gdtslam_grid* grid, gdtslam_grid_view* view, gdtslam_error* error);
/* Of a distance field: what report.json calls map_sha256. "" of a map, and without memory. Valid until the grid is
 * freed. */
GDTSLAM_API const char* gdtslam_grid_sha256(const gdtslam_grid* grid);
GDTSLAM_API void gdtslam_grid_free(gdtslam_grid* grid);

/* ---- Runs ---------------------------------------------------------------------------------------------------- */

/* The folder that mapping a log gives. */
typedef struct gdtslam_run gdtslam_run;

/* One line that a user should see: a remark as it comes up; once the run is written, what was skipped or mended in the
 * log, a line a kind. */
typedef void (*gdtslam_warn)(void* user_data, const char* text);

typedef struct gdtslam_map_request {
  size_t size;
  const char* const* logs; /* mapped one after the other as one */
  size_t log_count;
  const char* folder; /* of the results; made if need be */
  const gdtslam_options* options;
  const char* linkage; /* of a laser that nods: preset or file; NULL: the file beside the log, else the default */
  uint32_t flags;
  uint32_t threads;    /* 0: as the command without --threads; UINT32_MAX: one per processor. Results are the same */
  uint64_t skip;       /* scans at the start */
  uint64_t scan_count; /* 0: all */
  gdtslam_progress progress;
  gdtslam_warn warn;
  void* user_data; /* of both functions */
} gdtslam_map_request;

/* What `gdtslam map LOG -o FOLDER` does, with the same bytes in the folder; the picture of a cloud is left out, for it
 * takes OpenGL. `run` may be NULL; else it is the folder's, with the poses in full. GDTSLAM_INTERRUPTED: what there is
 * was written, and *run is that, or NULL where there was no scan yet. */
GDTSLAM_API gdtslam_status gdtslam_map_log(const char* log, const char* folder, gdtslam_run** run,
                                           gdtslam_error* error);
GDTSLAM_API gdtslam_status gdtslam_map_logs(const gdtslam_map_request* request, gdtslam_run** run,
                                            gdtslam_error* error);
/* A run that was made before. */
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

/* One pose of the robot a scan, valid until the run is freed; all threads may ask. Of a run that was opened they are
 * those of trajectory.tum, nine decimals. */
GDTSLAM_API gdtslam_status gdtslam_run_trajectory(gdtslam_run* run, const gdtslam_stamped_pose** poses, size_t* count,
                                                  gdtslam_error* error);
/* The occupancy map and the distance field. */
GDTSLAM_API gdtslam_status gdtslam_run_map(const gdtslam_run* run, gdtslam_grid** map, gdtslam_error* error);
GDTSLAM_API gdtslam_status gdtslam_run_field(const gdtslam_run* run, gdtslam_grid** field, gdtslam_error* error);

/* Bytes that the library made. */
typedef struct gdtslam_bytes gdtslam_bytes;

GDTSLAM_API const void* gdtslam_bytes_data(const gdtslam_bytes* bytes);
GDTSLAM_API size_t gdtslam_bytes_count(const gdtslam_bytes* bytes);
GDTSLAM_API void gdtslam_bytes_free(gdtslam_bytes* bytes);

typedef struct gdtslam_picture_request {
  size_t size;
  const char* view;   /* "map" (NULL), "graph", "field", "distance": as `gdtslam render --view` draws them */
  const char* format; /* "png" (NULL), "svg", "pdf" */
  uint32_t width;     /* pixels; 0 and 0: what suits the map */
  uint32_t height;
  const char* title;      /* NULL: the log's name */
  const char* colour_map; /* of the field; NULL: the view's own */
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
  uint32_t threads; /* as of gdtslam_map_request */
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
/* "few-points"; "unknown doubt" for what is none. */
GDTSLAM_API const char* gdtslam_doubt_name(int32_t doubt);

typedef struct gdtslam_match {
  size_t size;
  double stamp_s;
  gdtslam_pose T_map_base;      /* the match, or where it was refused the prediction; it never leaps */
  gdtslam_pose T_map_predicted; /* by the odometry */
  /* Where the frame of these poses lies in the one with the loops closed that were found by then; it leaps. */
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
/* After the last scan: the rest of the loops is closed and the path adjusted, unless progress() (may be NULL) ends it
 * before. Nothing is to be done without loops. */
GDTSLAM_API gdtslam_status gdtslam_mapper_close(gdtslam_mapper* mapper, gdtslam_progress progress, void* user_data,
                                                gdtslam_error* error);
/* A pose a scan, those of the front end until the mapper is closed. Valid until the next call with this mapper. */
GDTSLAM_API gdtslam_status gdtslam_mapper_trajectory(gdtslam_mapper* mapper, const gdtslam_stamped_pose** poses,
                                                     size_t* count, gdtslam_error* error);
/* The distance field as of this call. With loops: of the keyframes so far, in the frame with the loops closed. */
GDTSLAM_API gdtslam_status gdtslam_mapper_field(gdtslam_mapper* mapper, gdtslam_grid** field, gdtslam_error* error);

/* ---- Localisation -------------------------------------------------------------------------------------------- */

/* Finds scans in the whole of a map, without odometry and with a proof. */
typedef struct gdtslam_localizer gdtslam_localizer;

typedef struct gdtslam_localizer_request {
  size_t size;
  const char* map; /* a run folder, its gdt.yaml, or the map.yaml of an occupancy map of any program */
  const gdtslam_options* options;
  uint32_t flags;
  uint32_t reserved;  /* 0 */
  double gap_m;       /* no pose has a mean distance that is smaller by more than this; 0: 5 mm */
  double max_seconds; /* for a pose; 0: until it is proven */
  double good_fit_m;  /* the largest mean distance that is one; 0: what the map tells */
} gdtslam_localizer_request;

GDTSLAM_API gdtslam_status gdtslam_localizer_new(const gdtslam_localizer_request* request,
                                                 gdtslam_localizer** localizer, gdtslam_error* error);
/* Trackers that were made of it stay whole. */
GDTSLAM_API void gdtslam_localizer_free(gdtslam_localizer* localizer);

/* What the search for a scan came to. */
enum {
  GDTSLAM_FOUND = 0,
  GDTSLAM_AMBIGUOUS = 1, /* a pose elsewhere may fit about as well */
  GDTSLAM_POOR_FIT = 2,  /* even the best pose fits worse than scans of the mapped place do */
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

/* Follows a robot in a map that stays, from a start that is found by itself. */
typedef struct gdtslam_tracker gdtslam_tracker;

GDTSLAM_API gdtslam_status gdtslam_tracker_new(const gdtslam_localizer* localizer, gdtslam_tracker** tracker,
                                               gdtslam_error* error);
GDTSLAM_API void gdtslam_tracker_free(gdtslam_tracker* tracker);

/* How the pose of a scan is known. */
enum {
  GDTSLAM_NOWHERE = 0,    /* not at all: not found yet, or lost */
  GDTSLAM_JUST_FOUND = 1, /* by a search of the whole map; too short a drive since then to tell whether it is right */
  GDTSLAM_TRACKED = 2,    /* by a good match near where it should be */
  GDTSLAM_PREDICTED = 3   /* by the wheels since the last good match */
};

typedef struct gdtslam_tracked {
  size_t size;
  int32_t whereabouts;
  int32_t is_ambiguous; /* another place fitted as well when it was found, and nothing has told them apart yet */
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
