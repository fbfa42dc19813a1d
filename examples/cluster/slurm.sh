#!/usr/bin/env bash
#SBATCH --job-name=saltus
#SBATCH --array=1-20
#SBATCH --cpus-per-task=2
#SBATCH --time=02:00:00
#
# A study as an array job of Slurm: every task runs one shard, all into one folder on a file system that they share.
#
#   sbatch slurm.sh a1/barrel-roll --samples 1000 --out study
#
# Whichever shard ends last writes the table of all. The same command goes on with what is missing.
set -euo pipefail
exec "${SALTUS:-saltus}" envelope "$@" --quiet --jobs "${SLURM_CPUS_PER_TASK:-1}" \
    --shard "$SLURM_ARRAY_TASK_ID/$SLURM_ARRAY_TASK_COUNT"
