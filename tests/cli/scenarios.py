#!/usr/bin/env python3
"""Scenarios of the command that take more than one run: `scenarios.py NAME`. Exit 0 passed, 1 failed, 77 skipped."""

import sys

import scenario_bad_input
import scenario_bags
import scenario_bench
import scenario_bombs
import scenario_calibrate
import scenario_changes
import scenario_compare
import scenario_continue
import scenario_convert
import scenario_devices
import scenario_doctor
import scenario_edit
import scenario_files
import scenario_fleet
import scenario_hostile_files
import scenario_keyframes
import scenario_linkage
import scenario_live
import scenario_live_failures
import scenario_live_folder
import scenario_live_inputs
import scenario_live_page
import scenario_localize
import scenario_localize_occupancy
import scenario_loops
import scenario_measure
import scenario_merge
import scenario_nodding
import scenario_nodding_faults
import scenario_nodding_runs
import scenario_one_thing
import scenario_outputs
import scenario_printing
import scenario_register
import scenario_render
import scenario_render_faults
import scenario_render_formats
import scenario_render_runs
import scenario_results
import scenario_same_bytes
import scenario_shell
import scenario_signals
import scenario_slurm
import scenario_surroundings
import scenario_tilt3d
import scenario_tiles
import scenario_tracking

MODULES = (scenario_bad_input, scenario_bags, scenario_bench, scenario_bombs, scenario_calibrate, scenario_changes, scenario_compare, scenario_continue, scenario_convert, scenario_devices,
           scenario_doctor, scenario_edit, scenario_files, scenario_fleet, scenario_hostile_files, scenario_keyframes, scenario_linkage, scenario_live, scenario_live_failures, scenario_live_folder, scenario_live_inputs, scenario_live_page, scenario_localize, scenario_localize_occupancy, scenario_loops,
            scenario_measure, scenario_merge,
           scenario_nodding,
           scenario_nodding_faults, scenario_nodding_runs, scenario_one_thing, scenario_outputs, scenario_printing, scenario_register, scenario_render,
           scenario_render_faults, scenario_render_formats, scenario_render_runs, scenario_results, scenario_same_bytes,
           scenario_shell, scenario_signals, scenario_slurm, scenario_surroundings,
           scenario_tilt3d, scenario_tiles, scenario_tracking)


def main():
    for module in MODULES:
        if hasattr(module, sys.argv[1]):
            getattr(module, sys.argv[1])()
            return
    sys.exit(f"there is no scenario {sys.argv[1]}")


if __name__ == "__main__":
    main()
