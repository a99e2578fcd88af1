// Job type of Flamenco: the chunks of a render, and the merge after them. Belongs into the folder `scripts` beside the
// manager; flamenco_job.json is a job of this type.
const JOB_TYPE = {
    label: "Steradian",
    settings: [
        { key: "job", type: "string", required: true, description: "Folder of the job, the same on all workers" },
        { key: "chunks", type: "int32", required: true, description: "Number of chunks" },
    ],
};

function compileJob(job) {
    const settings = job.settings;
    const merge = author.Task("merge", "misc");
    merge.addCommand(author.Command("exec", { exe: "sh", args: [settings.job + "/merge.sh"] }));
    for (let chunk = 0; chunk < settings.chunks; chunk++) {
        const task = author.Task("chunk-" + chunk, "misc");
        task.addCommand(author.Command("exec", { exe: "sh", args: [settings.job + "/chunk.sh", String(chunk)] }));
        merge.addDependency(task);
        job.addTask(task);
    }
    job.addTask(merge);
}
