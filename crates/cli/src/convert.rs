//! `steradian convert`: a picture in another format.

use crate::{
    args::ConvertArgs,
    failure::{self, Failure, Outcome},
    output,
};
use std::path::Path;
use steradian::{
    Inputs,
    image::{self, Limits},
};

/// Reads, maps, writes.
pub fn run(args: &ConvertArgs) -> Outcome {
    for path in [&args.input, &args.output] {
        if is_scene(path) {
            let what = format!(
                "'{}' is a scene, and converting scenes is not implemented; convert takes pictures",
                path.display()
            );
            return Err(Failure::bad_input(what));
        }
    }
    output::kind(&args.output)?;
    output::keep_inputs([args.output.as_path()], &Inputs::of([args.input.as_path()]))?;
    output::check_writable(&args.output)?;
    let options = args.files.write_options().map_err(Failure::bad_input)?;
    let picture = image::read(&args.input, &Limits::default()).map_err(|e| Failure::bad_input(e.to_string()))?;
    image::write(&args.output, &picture, &options).map_err(|e| Failure::failed(e.to_string()))?;
    Ok(failure::DONE)
}

fn is_scene(path: &Path) -> bool {
    let name = path.to_string_lossy().to_ascii_lowercase();
    let name = name.strip_suffix(".gz").unwrap_or(&name);
    let extension = Path::new(name).extension().and_then(|e| e.to_str());
    extension.is_some_and(|e| steradian::load::EXTENSIONS.iter().any(|known| known.0 == e))
}
