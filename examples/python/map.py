#!/usr/bin/env python3
"""Maps a log and prints what the map is, by its hash:  map.py LOG FOLDER  (docs/howto/python.md)"""
import sys

import gdtslam


def main(arguments):
    if len(arguments) != 2:
        sys.exit("Usage: map.py LOG FOLDER")
    try:
        run = gdtslam.map(arguments[0], arguments[1])
    except gdtslam.Error as error:
        print(f"map: {error}", file=sys.stderr)
        return error.status
    print(run.map_sha256, run.trajectory_sha256)
    return 0


sys.exit(main(sys.argv[1:]))
