"""Submits the chunks of a render, and the merge after them, to OpenCue: python3 opencue_job.py [--show NAME --shot NAME]"""
import argparse
import getpass
import shlex

import outline
import outline.cuerun
from outline.modules.shell import Shell

JOB = @JOB@
CHUNKS = @CHUNKS@

arguments = argparse.ArgumentParser()
arguments.add_argument("--show", default="testing")
arguments.add_argument("--shot", default="steradian")
arguments = arguments.parse_args()
job = outline.Outline(@NAME@, show=arguments.show, shot=arguments.shot, user=getpass.getuser())
# The words of a command are put together with spaces between them, and read by a shell.
chunks = Shell("chunks", command=["sh", shlex.quote(JOB + "/chunk.sh"), "#IFRAME#"], range=f"0-{CHUNKS - 1}", chunk=1)
merge = Shell("merge", command=["sh", shlex.quote(JOB + "/merge.sh")], range="0-0", chunk=1)
merge.depend_on(chunks)
job.add_layer(chunks)
job.add_layer(merge)
outline.cuerun.launch(job, use_pycuerun=False)
