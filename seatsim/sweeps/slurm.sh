#!/bin/bash
# {runs} runs of {file}, in {tasks} shares. Submit with: sbatch {script}
# A task that ends early goes on where it was when it is submitted again: sbatch --array=NUMBER {script}
#SBATCH --job-name={name}
#SBATCH --array=1-{tasks}
#SBATCH --cpus-per-task=1
#SBATCH --output={logs}
exec {command} --part "$SLURM_ARRAY_TASK_ID/{tasks}" --jobs "${{SLURM_CPUS_PER_TASK:-1}}" --resume
