#!/usr/bin/env bash
# Makes the pictures of the README and the docs anew, with the program itself: of simulated logs, and of the public logs where
# GDTSLAM_DATA names them; the gallery's pictures, too, by the commands on its page (make_gallery.py).
# Usage: tools/scripts/make_images.sh PROGRAM [FOLDER]   (FOLDER: docs/images)
set -euo pipefail
root=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.." && pwd)
if [[ $# -lt 1 || $# -gt 2 ]]; then
  sed -n '2,4s/^# //p' "${BASH_SOURCE[0]}" >&2
  exit 2
fi
program=$(readlink -f "$1")
images=$(mkdir -p "${2:-$root/docs/images}" && readlink -f "${2:-$root/docs/images}")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
gdtslam() { "$program" "$@" --force >/dev/null; }

for scene in office-loop office-7f three-boxes; do
  echo "$scene"
  gdtslam simulate "$scene" -o "$scene.log"
done
gdtslam map office-loop.log -o office-loop
gdtslam map office-7f.log -o office-7f
gdtslam map three-boxes.log -o three-boxes --set cloud.voxel=0

gdtslam render office-loop -o "$images/office-loop.png" --size 1280x800
gdtslam render office-loop --view field -o "$images/office-loop-field.png" --size 1280x800
gdtslam render office-7f -o "$images/office-7f-cloud.png" --size 1280x720
gdtslam render three-boxes --view scan -o "$images/scanning.png" --size 960x540
gdtslam render paper-b -o "$images/linkage-paper-b.gif" --size 640x360 --fps 20
gdtslam linkage paper-b --picture "$images/linkage-paper-b.svg"
# Two levels and a ramp by a robot that sways: poses in the plane and in space (docs/howto/map-in-3d.md).
gdtslam simulate two-levels -o levels.log --sway 0.4deg,1cm --elevation-error 0.5deg
for dof in 3 6; do
  gdtslam map levels.log --dof $dof -o "levels-$dof" --no-pictures
  gdtslam render "levels-$dof/cloud.ply" --from front --background light --hide none --size 1280x400 \
    --title "map --dof $dof" -o "$images/two-levels-$dof.png"
done
gdtslam evaluate three-boxes/cloud.ply --boxes --picture "$images/measured-boxes.svg"
gdtslam simulate wall -o wall.log --linkage paper-b-calibrated
gdtslam map office-loop.log -o coarse --set map.resolution=5cm --set merge.threshold=5cm --set map.truncation=1m
gdtslam localize coarse/map.yaml office-loop.log --every 10 --picture "$images/office-loop-found.png"
# What changed: a partition is gone, the copier was moved, a box is new (docs/howto/localize.md).
sed -e '/points: \[\[22, 20\], \[22, 25\]\]/d' -e 's/copier, at: \[32.9, 5.38\]/copier, at: [21.6, 5.38]/' \
  -e 's/^boxes:/&\n  - {centre: [28.4, 23.6], size: [1.2, 0.8], height: 1.5 m}/' \
  "$root/assets/scenes/office-loop.yaml" >office-now.yaml
gdtslam simulate office-now.yaml -o today.log --seed 5
gdtslam localize office-loop today.log --track --changes "$images/office-loop-changes.png"
rm "$images/office-loop-changes.csv"
# One scan in a corridor whose niches repeat, and the pose a period away that fits as well (docs/loops.md).
python3 - >niches.yaml <<'SCENE'
wall = [[0, 0]]
for k in range(8):
    x = 3 + 7 * k
    wall += [[x, 0], [x, -0.35], [x + 1.6, -0.35], [x + 1.6, 0]]
wall += [[60, 0], [60, 2.4], [0, 2.4], [0, 0]]
print(f"""gdtslam_scene: 1
name: niches
walls: [{{points: {wall}}}]
robot: {{laser: {{preset: sick-lms, max_range: 8 m, no_return: 8.191 m, range_resolution: 1 mm}}}}
recording: {{scan_rate: 5 Hz, odometry_rate: 10 Hz}}
waypoints: [[2, 1.2], [58, 1.2]]""")
SCENE
gdtslam simulate niches.yaml -o niches.log
gdtslam map niches.log -o niches
gdtslam localize niches niches.log --scan 150 --picture "$images/repeated-corridor.svg"
gdtslam calibrate wall.log -o "$work/wall.yaml" --picture "$images/calibration.png"
# Of a real log, where there is one: GDTSLAM_DATA names the folder of slam2d/intel.clf.gz.
if [[ -n ${GDTSLAM_DATA:-} ]]; then
  "$program-lab" compare "$GDTSLAM_DATA/slam2d/intel.clf.gz" --picture "$images/matchers-intel.svg" -q --force
  gdtslam map "$GDTSLAM_DATA/slam2d/intel.clf.gz" -o intel
  gdtslam render intel --view loops -o "$images/loops-intel.png" --size 740x410
  gdtslam edit intel --rotate-to-walls --crop -21,-23.3,8.4,6.3 --erase '0.5,-2 1.4,-2 1.4,-1.1 0.5,-1.1' \
    --erase '1.6,5.3 6.9,-0.1 8.1,-1.4 60,-1.4 60,60 1.6,60' -o clean
  gdtslam render intel -o "$images/intel-before.png" --size 620x540
  gdtslam render clean -o "$images/intel-edited.png" --size 620x540
  "$root/tools/scripts/make_gallery.py" "$program" "$images/gallery"
fi
"$root/tools/scripts/shrink_png.sh" "$images"/*.png
ls -l "$images"
