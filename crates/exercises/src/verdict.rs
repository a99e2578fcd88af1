//! From a folder to a verdict.

use crate::{
    Exercise, Fault, Report,
    diagnosis::Compared,
    exercise::Function,
    folder::Folder,
    numbers::point,
    process::{Asked, Stop, ask},
    program::Built,
    protocol::{Question, Reply},
    report::{OfFunction, OfLaw},
};
use std::{path::Path, time::Duration};

/// Builds the program in a folder, asks it, and judges its answers, until `stopping` says true. No process is left.
///
/// # Errors
/// Where there is no program to be asked: no exercise in the folder, no compiler or interpreter. [`Fault::Stopped`].
pub fn check(folder: &Path, timeout: Duration, stopping: &dyn Fn() -> bool) -> Result<Report, Fault> {
    let folder = Folder::open(folder)?;
    let exercise = folder.exercise;
    let questions = Questions::of(exercise);
    let (asked, fault) = match folder.build(stopping)? {
        Built::Errors(text) => {
            let fault = format!("{} does not compile:\n{text}", folder.language.answer());
            (Asked { replies: Vec::new(), stop: None, printed: String::new() }, Some(fault))
        }
        Built::Command(mut command) => {
            let asked = ask(&mut command, &questions.all, timeout, stopping);
            let asked = asked.map_err(|e| folder.no_tool(folder.tool(), e))?;
            if asked.stop == Some(Stop::Asked) {
                return Err(Fault::Stopped);
            }
            let fault = asked.stop.as_ref().map(|stop| {
                let question = questions.all.get(asked.replies.len());
                let at = question
                    .map_or_else(String::new, |q| format!("{}: {}", q.function.name, point(q.function, &q.inputs)));
                told(&folder, stop, timeout, &at)
            });
            (asked, fault)
        }
    };
    Ok(judged(&folder, &questions, asked, fault))
}

/// A reason to stop, in words.
fn told(folder: &Folder, stop: &Stop, timeout: Duration, at: &str) -> String {
    let seconds = timeout.as_secs_f64();
    match stop {
        Stop::Ended(how) => format!("the program {how} when it was asked {at}"),
        Stop::Timeout => format!("the program gave no answer within {seconds} s to {at}; does a loop never end?"),
        Stop::NoReply(line) => format!(
            "the program wrote a line that is no answer, when it was asked {at}:\n    {line}\nPrint for yourself \
            with \
             eprintln!; standard output is for answers."
        ),
        Stop::Flood => format!("the program writes a line without end, when it was asked {at}"),
        Stop::Asked => "the check was stopped".into(),
        Stop::Broken(text) => format!("{} cannot be loaded:\n{text}", folder.language.answer()),
    }
}

/// All questions of an exercise in their order: those of each function, then those of each law.
pub(crate) struct Questions {
    pub all: Vec<Question>,
    /// Number of questions of each function and of each law.
    counts: Vec<usize>,
}

impl Questions {
    pub fn of(exercise: &'static Exercise) -> Self {
        let of_function = |function: &'static Function| -> Vec<Question> {
            (function.points)().into_iter().map(|inputs| Question { function, inputs }).collect()
        };
        let mut parts: Vec<Vec<Question>> = exercise.functions.iter().map(of_function).collect();
        parts.extend(exercise.laws.iter().map(|law| {
            let asked = (law.questions)().into_iter();
            asked.filter_map(|(name, inputs)| Some(Question { function: exercise.function(name)?, inputs })).collect()
        }));
        let counts = parts.iter().map(Vec::len).collect();
        Self { all: parts.concat(), counts }
    }

    /// Questions and replies of each function, then of each law; none where the program stopped before.
    fn parts<'a>(&'a self, replies: &'a [Reply]) -> Vec<Option<(&'a [Question], &'a [Reply])>> {
        let mut first = 0;
        let part = |count: &usize| {
            let range = first..first + count;
            first = range.end;
            self.all.get(range.clone()).zip(replies.get(range))
        };
        self.counts.iter().map(part).collect()
    }
}

fn judged(folder: &Folder, questions: &Questions, asked: Asked, fault: Option<String>) -> Report {
    let exercise = folder.exercise;
    let parts = questions.parts(&asked.replies);
    let (of_functions, of_laws) = parts.split_at(exercise.functions.len().min(parts.len()));
    let functions: Vec<OfFunction> = exercise
        .functions
        .iter()
        .zip(of_functions)
        .map(|(function, part)| match part {
            Some((questions, replies)) => of_function(folder, function, questions, replies),
            None => OfFunction {
                function: function.name,
                verdict: "not asked",
                points: 0,
                right: 0,
                mistake: None,
                text: String::new(),
            },
        })
        .collect();
    let functions = after_wrong_ones(functions);
    let is_fine =
        |name: &&str| functions.iter().any(|f| f.function == *name && matches!(f.verdict, "right" | "answered"));
    let laws: Vec<OfLaw> = exercise
        .laws
        .iter()
        .zip(of_laws)
        .filter(|(law, _)| law.functions.iter().all(is_fine))
        .filter_map(|(law, part)| {
            let (questions, replies) = (*part)?;
            let found = match numbers(questions, replies) {
                Ok(answers) => (law.judge)(exercise, &answers),
                Err((_, text)) => return Some(OfLaw { law: law.name, holds: false, mistake: None, text }),
            };
            Some(OfLaw { law: law.name, holds: found.holds, mistake: found.mistake, text: found.text })
        })
        .collect();
    let passed = fault.is_none()
        && functions.iter().all(|f| is_fine(&f.function))
        && laws.len() == exercise.laws.len()
        && laws.iter().all(|l| l.holds);
    let (exercise, language) = (exercise.name, folder.language.name());
    Report { schema: 1, exercise, language, passed, fault, functions, laws, printed: asked.printed }
}

/// Verdicts where functions that no known mistake explains point at wrong ones that they may call.
fn after_wrong_ones(mut functions: Vec<OfFunction>) -> Vec<OfFunction> {
    let mut first = None;
    for of in functions.iter_mut().filter(|f| f.verdict == "wrong") {
        match first {
            None => first = Some(of.function),
            Some(first) if of.mistake.is_none() => {
                of.text = format!("If it calls {first}, put that right first.\n{}", of.text)
            }
            _ => {}
        }
    }
    functions
}

/// The numbers of all replies, or the verdict and words on the first that has none.
fn numbers(questions: &[Question], replies: &[Reply]) -> Result<Vec<Vec<f64>>, (&'static str, String)> {
    let number = |(question, reply): (&Question, &Reply)| match reply {
        Reply::Numbers(numbers) => Ok(numbers.clone()),
        Reply::NotWritten => Err(("not written", String::new())),
        Reply::Error(text) | Reply::Broken(text) => {
            Err(("error", format!("At {}:\n{text}", point(question.function, &question.inputs))))
        }
    };
    questions.iter().zip(replies).map(number).collect()
}

fn of_function(folder: &Folder, function: &'static Function, questions: &[Question], replies: &[Reply]) -> OfFunction {
    let of = |verdict, right, mistake, text| OfFunction {
        function: function.name,
        verdict,
        points: questions.len(),
        right,
        mistake,
        text,
    };
    let given = match numbers(questions, replies) {
        Ok(given) => given,
        Err(("not written", _)) => {
            return of("not written", 0, None, format!("the gap in {} is not filled", folder.language.answer()));
        }
        Err((verdict, text)) => return of(verdict, 0, None, text),
    };
    let points: Vec<Vec<f64>> = questions.iter().map(|q| q.inputs.clone()).collect();
    let Some(reference) = function.reference else {
        let count = function.outputs.len();
        let bad = given.iter().zip(&points).find(|(g, _)| g.len() != count || g.iter().any(|x| !x.is_finite()));
        return match bad {
            Some((given, inputs)) => {
                let text = format!(
                    "At {} it gives {}; {count} numbers are asked for: {}.",
                    point(function, inputs),
                    crate::numbers::listed(given),
                    function.outputs.join(", ")
                );
                of("wrong", 0, None, text)
            }
            None => of("answered", points.len(), None, String::new()),
        };
    };
    let compared = Compared { exercise: folder.exercise, function, reference, points: &points, given: &given };
    let found = compared.diagnose();
    let verdict = if found.right == points.len() { "right" } else { "wrong" };
    of(verdict, found.right, found.mistake.map(|m| m.key), found.text)
}
