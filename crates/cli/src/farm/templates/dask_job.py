"""Computes the chunks of a render by Dask, and merges them.

python3 dask_job.py                              by a cluster on this machine
python3 dask_job.py --scheduler tcp://HOST:8786  by workers that see the job's folder by the same name
"""
import argparse
import os
import subprocess
import sys

from distributed import Client, LocalCluster, as_completed

JOB = @JOB@
CHUNKS = @CHUNKS@
WORKERS = @WORKERS@
MERGE = @MERGE@
TRIES = @TRIES@
TRY_AGAIN = 75


def compute(chunk, job, threads):
    """Computes a chunk and gives its number and exit code. What is worth another try is raised, which Dask retries."""
    command = ["steradian", "chunk", job, str(chunk), "--quiet", "--threads", str(threads)]
    code = subprocess.run(command, check=False).returncode
    if code == TRY_AGAIN or code < 0:
        raise RuntimeError(f"chunk {chunk} ended with code {code}")
    return chunk, code


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--scheduler", help="address; without it a cluster on this machine")
    arguments.add_argument("--workers", type=int, default=WORKERS, help="of the cluster on this machine")
    arguments = arguments.parse_args()
    if arguments.scheduler:
        client, threads = Client(arguments.scheduler), 0
    else:
        cluster = LocalCluster(n_workers=arguments.workers, threads_per_worker=1, dashboard_address=None)
        client, threads = Client(cluster), max(1, (os.cpu_count() or 1) // arguments.workers)
    with client:
        futures = client.map(compute, range(CHUNKS), job=JOB, threads=threads, retries=TRIES, pure=False)
        for done, future in enumerate(as_completed(futures), 1):
            chunk, code = future.result()
            if code != 0:
                client.cancel(futures)
                sys.exit(f"chunk {chunk} failed with code {code}")
            print(f"chunk {chunk}: {done} of {CHUNKS}", flush=True)
    sys.exit(subprocess.run(MERGE, check=False).returncode)


if __name__ == "__main__":
    main()
