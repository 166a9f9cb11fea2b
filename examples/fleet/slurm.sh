#!/bin/sh
# Maps the logs of a folder, a task a shard: sbatch slurm.sh LOGS ATLAS (docs/howto/fleet.md)
#SBATCH --job-name=fleet
#SBATCH --array=1-20
#SBATCH --cpus-per-task=4
#SBATCH --mem=8G
#SBATCH --time=2:00:00
#SBATCH --requeue
#SBATCH --output=fleet-%A_%a.txt
# A node that computes something else than others does nothing.
gdtslam verify logs --device cpu > /dev/null || exit
exec gdtslam fleet run "$1" -o "$2" --shard "$SLURM_ARRAY_TASK_ID/$SLURM_ARRAY_TASK_COUNT" -j "$SLURM_CPUS_PER_TASK"
