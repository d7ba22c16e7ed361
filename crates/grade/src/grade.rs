//! Running a program over a suite.

use dotray_image::Image;
use dotray_image::Limits;
use dotray_image::decode;
use std::io::Read;
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::AtomicUsize;
use std::sync::atomic::Ordering;

use crate::case::Case;
use crate::case::clamped;
use crate::error::GradeError;
use crate::hint::Hint;
use crate::hint::hints;
use crate::process;
use crate::process::End;
use crate::process::Ended;
use crate::process::Job;
use crate::score::Score;
use crate::score::Verdict;
use crate::score::score;
use crate::suite::Suite;
use crate::suite::Test;
use crate::template::Template;
use crate::template::Values;

/// What came of one test.
#[derive(Debug)]
pub struct Outcome {
    /// The test's place in the suite.
    pub number: usize,
    /// How good the picture is.
    pub verdict: Verdict,
    /// The points that it is worth.
    pub points: f64,
    /// Why it is not worth more.
    pub reasons: Vec<String>,
    /// Likely faults.
    pub hints: Vec<Hint>,
    /// Seconds that the program took.
    pub seconds: f64,
    /// The command, as one could type it.
    pub command: String,
    /// Beginning and end of its standard output.
    pub stdout: String,
    /// Beginning and end of its standard error.
    pub stderr: String,
    /// The picture that is wanted.
    pub truth: Image,
    /// The picture that came, whatever its size.
    pub picture: Option<Image>,
    /// The judgement, for a picture of the right size.
    pub score: Option<Score>,
}

/// What watches over a grading.
pub trait Observer: Sync {
    /// Called for each test that is finished, in any order.
    fn finished(&self, test: &Test, outcome: &Outcome) {
        let _ = (test, outcome);
    }

    /// Whether to end early; asked often.
    fn stop(&self) -> bool {
        false
    }
}

/// Nobody watches.
#[derive(Clone, Copy, Debug)]
pub struct Nobody;

impl Observer for Nobody {}

/// Runs the program over all tests, `jobs` at a time, and judges its pictures; the outcomes stand in the suite's order,
/// those that an early end has cost are missing. All scenes are read, and all truths made, before the program runs.
///
/// # Errors
/// A scene of the suite that has no picture, or a program that is not there.
pub fn grade(
    suite: &Suite,
    template: &Template,
    jobs: usize,
    observer: &dyn Observer,
) -> Result<Vec<Outcome>, GradeError> {
    if !process::exists(template.program()) {
        return Err(GradeError::Program(format!("cannot find the program `{}`", template.program())));
    }
    let cases = in_parallel(jobs, &suite.tests, observer, |_, test| Case::new(suite, test));
    let cases: Vec<Case> = cases.into_iter().collect::<Result<_, _>>()?;
    let outcomes = in_parallel(jobs, &cases, observer, |number, case| {
        let Some(test) = suite.tests.get(number) else { return Ok(None) };
        let outcome = one(suite, number, test, case, template, observer)?;
        if let Some(outcome) = &outcome {
            observer.finished(test, outcome);
        }
        Ok(outcome)
    });
    let outcomes: Result<Vec<_>, GradeError> = outcomes.into_iter().collect();
    Ok(outcomes?.into_iter().flatten().collect())
}

/// Does the work for every item on several threads; the results stand in the items' order. What has not begun when the
/// observer stops it is left out.
fn in_parallel<T: Sync, R: Send>(
    jobs: usize,
    items: &[T],
    observer: &dyn Observer,
    work: impl Fn(usize, &T) -> R + Sync,
) -> Vec<R> {
    let next = AtomicUsize::new(0);
    let results = Mutex::new(Vec::new());
    std::thread::scope(|scope| {
        for _ in 0..jobs.clamp(1, items.len().max(1)) {
            scope.spawn(|| {
                while !observer.stop() {
                    let number = next.fetch_add(1, Ordering::Relaxed);
                    let Some(item) = items.get(number) else { return };
                    let result = work(number, item);
                    if let Ok(mut results) = results.lock() {
                        results.push((number, result));
                    }
                }
            });
        }
    });
    let mut results = results.into_inner().unwrap_or_default();
    results.sort_by_key(|(number, _)| *number);
    results.into_iter().map(|(_, result)| result).collect()
}

/// One test; none where it was stopped.
fn one(
    suite: &Suite,
    number: usize,
    test: &Test,
    case: &Case,
    template: &Template,
    observer: &dyn Observer,
) -> Result<Option<Outcome>, GradeError> {
    let machine =
        |error: std::io::Error| GradeError::Machine(format!("cannot make a temporary folder: {error}"));
    let folder = tempfile::Builder::new().prefix("dotray-grade-").tempdir().map_err(machine)?;
    let [work, logs] = ["work", "logs"].map(|name| folder.path().join(name));
    for folder in [&work, &logs] {
        std::fs::create_dir(folder).map_err(machine)?;
    }
    case.files.write_below(&work).map_err(machine)?;
    let extension = suite.format.extensions().first().copied().unwrap_or("png");
    let output = work.join(format!("picture.{extension}"));
    let words = template.fill(&Values {
        scene: &work.join(&test.scene),
        output: &output,
        width: test.options.width,
        height: test.options.height,
        recursion: test.options.recursion,
        cutoff: test.options.threshold,
        arguments: &test.arguments,
    });
    let job = Job { words: &words, folder: &work, logs: &logs, limits: &test.limits };
    let ended = process::run(&job, &|| observer.stop());
    if ended.end == End::Stopped {
        return Ok(None);
    }
    let (picture, mut reasons) = picture(&ended, &output, test);
    let score = picture.as_ref().map(|picture| score(case, picture, test, &suite.credit));
    let (verdict, credit, score) = match score {
        Some(Ok(score)) => {
            reasons.extend(score.reasons.iter().cloned());
            (score.verdict, score.credit, Some(score))
        }
        Some(Err(size)) => {
            reasons.push(size);
            (Verdict::NoPicture, 0.0, None)
        }
        None => (Verdict::NoPicture, 0.0, None),
    };
    let hints = match (&score, &picture) {
        (Some(score), Some(picture)) if score.verdict != Verdict::Right => hints(case, picture, test),
        (Some(_) | None, _) => Vec::new(),
    };
    let quoted = shlex::try_join(words.iter().map(String::as_str)).unwrap_or_else(|_| words.join(" "));
    Ok(Some(Outcome {
        number,
        verdict,
        points: credit * test.points,
        reasons,
        hints,
        seconds: ended.seconds,
        // Names of temporary folders differ from run to run and tell nobody anything.
        command: process::printable(&quoted.replace(&format!("{}/", work.display()), "")),
        stdout: ended.stdout,
        stderr: ended.stderr,
        truth: case.truth.clone(),
        picture,
        score,
    }))
}

/// The picture of a run that has ended well enough, and what is to be said about the run.
fn picture(ended: &Ended, output: &Path, test: &Test) -> (Option<Image>, Vec<String>) {
    let seconds = test.limits.time.as_secs_f64();
    let fault = match &ended.end {
        End::Code(_) => None,
        End::Signal(number) => Some(signal(*number, test)),
        End::TimedOut => Some(format!("the program was stopped after {seconds} seconds")),
        End::TooMuchWritten => Some("the program was stopped because it wrote too much".to_owned()),
        End::NotStarted(error) => Some(format!("the program could not be started: {error}")),
        End::Stopped => Some("the grading was stopped".to_owned()),
    };
    if let Some(fault) = fault {
        return (None, vec![fault]);
    }
    let mut reasons = Vec::new();
    match &ended.end {
        End::Code(0) => {}
        End::Code(code) => reasons.push(format!("the program ended with exit code {code}")),
        End::Signal(_) | End::TimedOut | End::TooMuchWritten | End::NotStarted(_) | End::Stopped => {}
    }
    match read(output, test) {
        Ok(image) => (Some(clamped(image)), reasons),
        Err(error) => {
            reasons.push(error);
            (None, reasons)
        }
    }
}

/// What a signal mostly means.
fn signal(number: i32, test: &Test) -> String {
    let meaning = match number {
        4 => " (illegal instruction)",
        6 => " (it gave up by itself)",
        8 => " (division by zero)",
        9 => " (mostly out of memory)",
        7 | 10 | 11 => " (it used memory that it does not have)",
        24 => " (it used too much processor time)",
        25 => {
            return format!(
                "the program was stopped because it wrote a file of over {} MiB",
                test.limits.file
            );
        }
        _ => "",
    };
    format!("the program crashed: signal {number}{meaning}")
}

fn read(output: &Path, test: &Test) -> Result<Image, String> {
    let name = output.file_name().unwrap_or_default().display();
    let file = match process::open_regular(output) {
        Ok(file) => file,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
            return Err(format!("the program wrote no `{name}`"));
        }
        Err(error) => return Err(format!("`{name}` cannot be read: {error}")),
    };
    let most = test.limits.file.saturating_mul(1 << 20);
    let mut bytes = Vec::new();
    let read = file.take(most).read_to_end(&mut bytes);
    read.map_err(|error| format!("`{name}` cannot be read: {error}"))?;
    let wanted = u64::from(test.options.width) * u64::from(test.options.height);
    let limits = Limits { max_pixels: wanted.saturating_mul(16).max(1 << 20), max_bytes: 1 << 30 };
    decode(&bytes, dotray_image::Format::from_path(output).ok(), &limits)
        .map_err(|error| format!("`{name}` cannot be read: {error}"))
}
