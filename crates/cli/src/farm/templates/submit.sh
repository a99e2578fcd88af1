#!/bin/sh
# Submits the chunks, and the merge after them, with options of sbatch: submit.sh --partition=NAME --cpus-per-task=16
set -e
cd -- @JOB@
id=$(sbatch --parsable "$@" chunks.sbatch)
sbatch --dependency="afterok:${id%%;*}" --kill-on-invalid-dep=yes "$@" merge.sbatch
