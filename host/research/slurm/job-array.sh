#!/bin/sh
# A Slurm job array: task N runs line N of a file of commands, as `myointent-research ... --list` prints them.
#
#   target/release/myointent-research cross-validate --preset cpu --data DIR --list > jobs
#   sbatch --array=1-$(wc -l < jobs) host/research/slurm/job-array.sh jobs
#
# A task that was killed goes on where it stopped when the same array is submitted again; finished ones end at once.
#SBATCH --cpus-per-task=1
#SBATCH --requeue
#SBATCH --output=slurm-%A-%a.log
#SBATCH --open-mode=append
set -eu
jobs=${1:?the file of commands}
command=$(sed -n "${SLURM_ARRAY_TASK_ID:?start it with sbatch --array}p" "$jobs")
if [ -z "$command" ]; then
    echo "$jobs has no line $SLURM_ARRAY_TASK_ID" >&2
    exit 2
fi
# As many threads as the task has processors.
export RAYON_NUM_THREADS="${SLURM_CPUS_PER_TASK:-1}"
exec sh -c "$command"
