//! The program in a folder: built, if its language needs that, and the command that runs it.

use crate::{
    Fault, Language,
    folder::Folder,
    process::{Stopping, output},
};
use serde::Deserialize;
use std::{path::PathBuf, process::Command};

/// Most errors of the compiler that are shown, and most lines of all of them.
const ERRORS: usize = 3;
const LINES: usize = 40;

/// Result of building.
pub(crate) enum Built {
    /// The command that runs the program.
    Command(Command),
    /// The compiler's errors.
    Errors(String),
}

/// A line of `cargo build --message-format=json`.
#[derive(Deserialize)]
struct Message {
    executable: Option<PathBuf>,
    message: Option<Diagnostic>,
}

#[derive(Deserialize)]
struct Diagnostic {
    level: String,
    rendered: Option<String>,
}

/// Name of Python's program.
const PYTHON: &str = if cfg!(windows) { "python" } else { "python3" };

impl Folder {
    /// Builds the program.
    ///
    /// # Errors
    /// [`Fault::Tool`] if there is no compiler, [`Fault::Stopped`].
    pub fn build(&self, stopping: Stopping<'_>) -> Result<Built, Fault> {
        match self.language {
            Language::Python => {
                let mut command = Command::new(PYTHON);
                // Without files of bytecode, which may be older than they look.
                command.args(["-B", "protocol.py"]).current_dir(&self.path).env("PYTHONIOENCODING", "utf-8");
                Ok(Built::Command(command))
            }
            Language::Rust => self.cargo(stopping),
        }
    }

    fn cargo(&self, stopping: Stopping<'_>) -> Result<Built, Fault> {
        let mut cargo = Command::new("cargo");
        cargo.args(["build", "--release", "--offline", "--quiet", "--message-format=json"]).current_dir(&self.path);
        let output =
            output(&mut cargo, stopping).map_err(|error| self.no_tool("cargo", error))?.ok_or(Fault::Stopped)?;
        let text = String::from_utf8_lossy(&output.stdout);
        let messages: Vec<Message> = text.lines().filter_map(|line| serde_json::from_str(line).ok()).collect();
        let executable = messages.iter().find_map(|m| m.executable.clone());
        if let (true, Some(executable)) = (output.status.success(), executable) {
            let mut command = Command::new(executable);
            command.current_dir(&self.path);
            return Ok(Built::Command(command));
        }
        let diagnostics = messages.iter().filter_map(|m| m.message.as_ref()).filter(|d| d.level == "error");
        let errors: Vec<&str> = diagnostics.filter_map(|d| d.rendered.as_deref()).take(ERRORS).collect();
        // Faults of the manifest are told on stderr alone.
        let all =
            if errors.is_empty() { String::from_utf8_lossy(&output.stderr).into_owned() } else { errors.concat() };
        Ok(Built::Errors(shortened(&all, LINES)))
    }

    /// A tool of the language that cannot be started.
    pub fn no_tool(&self, tool: &'static str, error: std::io::Error) -> Fault {
        Fault::Tool { tool, error, language: self.language.name() }
    }

    /// The tool that runs the program.
    pub fn tool(&self) -> &'static str {
        match self.language {
            Language::Python => PYTHON,
            Language::Rust => "the program",
        }
    }
}

/// The first lines of a text.
pub(crate) fn shortened(text: &str, most: usize) -> String {
    let lines: Vec<&str> = text.trim_end().lines().collect();
    let mut short = lines.iter().take(most).copied().collect::<Vec<_>>().join("\n");
    if lines.len() > most {
        short += &format!("\n… ({} lines more)", lines.len() - most);
    }
    short
}
