//! Running a program that is not trusted: in a group of its own, with limits, a time-out, and files instead of pipes.

use std::fs::File;
use std::io;
use std::io::Read;
use std::path::Path;
use std::path::PathBuf;
use std::process::Child;
use std::process::Command;
use std::process::ExitStatus;
use std::process::Stdio;
use std::sync::atomic::AtomicU64;
use std::sync::atomic::Ordering;
use std::time::Duration;
use std::time::Instant;

use crate::settings::RunLimits;
use crate::sweep::MARK;
use crate::sweep::end_all;

/// What is to be run and where.
#[derive(Clone, Debug)]
pub struct Job<'a> {
    /// The program and its arguments.
    pub words: &'a [String],
    /// Its working folder, which is also that for its temporary files.
    pub folder: &'a Path,
    /// Where its standard output and error go.
    pub logs: &'a Path,
    /// What it may take.
    pub limits: &'a RunLimits,
}

/// How a run ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum End {
    /// By itself, with this code.
    Code(i32),
    /// By a signal, mostly a crash.
    Signal(i32),
    /// It ran too long.
    TimedOut,
    /// It wrote too much.
    TooMuchWritten,
    /// It could not be started.
    NotStarted(String),
    /// Whoever waits for the grades does not want them any more.
    Stopped,
}

/// A run that has ended; nothing of it runs any more.
#[derive(Clone, Debug)]
pub struct Ended {
    /// How.
    pub end: End,
    /// Seconds by the clock.
    pub seconds: f64,
    /// Beginning and end of standard output, printable.
    pub stdout: String,
    /// Beginning and end of standard error, printable.
    pub stderr: String,
}

/// Runs a program to its end, or to the end of its limits. `stop` is asked often.
pub fn run(job: &Job, stop: &(dyn Fn() -> bool + Sync)) -> Ended {
    static COUNTER: AtomicU64 = AtomicU64::new(0);
    let mark = format!("{}-{}", std::process::id(), COUNTER.fetch_add(1, Ordering::Relaxed));
    let [stdout, stderr] = ["stdout", "stderr"].map(|name| job.logs.join(name));
    let start = Instant::now();
    let end = match spawn(job, &mark, &stdout, &stderr) {
        Ok(mut child) => {
            let end = wait(&mut child, job, start, stop);
            end_all(&mut child, &mark);
            end
        }
        Err(error) => End::NotStarted(error.to_string()),
    };
    let seconds = start.elapsed().as_secs_f64();
    Ended { end, seconds, stdout: excerpt(&stdout), stderr: excerpt(&stderr) }
}

fn spawn(job: &Job, mark: &str, stdout: &Path, stderr: &Path) -> io::Result<Child> {
    let mut command = limited(job)?;
    command
        .current_dir(job.folder)
        .env(MARK, mark)
        .env("TMPDIR", job.folder)
        .stdin(Stdio::null())
        .stdout(File::create(stdout)?)
        .stderr(File::create(stderr)?);
    command.spawn()
}

/// A shell that sets the limits and then becomes the program. A limit that the system does not know, or that is lower
/// already, stays as it is.
#[cfg(unix)]
fn limited(job: &Job) -> io::Result<Command> {
    use std::os::unix::process::CommandExt;
    let mut script = "ulimit -c 0 2>/dev/null || :\n".to_owned();
    let mut limit = |option: &str, value: u64| {
        script += &format!("ulimit -{option} {value} 2>/dev/null || :\n");
    };
    if let Some(mebibytes) = job.limits.memory {
        limit("v", mebibytes.saturating_mul(1024));
    }
    // In blocks of 512 bytes.
    limit("f", job.limits.file.saturating_mul(2048));
    if let Some(processes) = job.limits.processes {
        limit("u", processes);
    }
    // For those that no signal finds: as much as all cores give until the time is over.
    let cores = std::thread::available_parallelism().map_or(1, |cores| cores.get() as u64);
    limit("t", (job.limits.time.as_secs() + 1).saturating_mul(cores) + 1);
    script += "exec \"$@\"\n";
    let mut command = Command::new("/bin/sh");
    command.arg("-c").arg(script).arg("limits").args(job.words).process_group(0);
    Ok(command)
}

/// Other systems have a time-out, and files are looked at, but there are no further limits.
#[cfg(not(unix))]
fn limited(job: &Job) -> io::Result<Command> {
    let (program, arguments) = job.words.split_first().ok_or(io::ErrorKind::InvalidInput)?;
    let mut command = Command::new(program);
    command.args(arguments);
    Ok(command)
}

fn wait(child: &mut Child, job: &Job, start: Instant, stop: &(dyn Fn() -> bool + Sync)) -> End {
    let mut pause = Duration::from_millis(1);
    let mut next_look = Duration::from_millis(200);
    loop {
        match child.try_wait() {
            Ok(Some(status)) => return end_of(status),
            Ok(None) => {}
            Err(error) => return End::NotStarted(error.to_string()),
        }
        let elapsed = start.elapsed();
        if elapsed >= job.limits.time {
            return End::TimedOut;
        }
        if stop() {
            return End::Stopped;
        }
        if elapsed >= next_look {
            next_look = elapsed + Duration::from_millis(200);
            let most = job.limits.file.saturating_mul(4 << 20);
            if written(job.folder, most) + written(job.logs, most) > most {
                return End::TooMuchWritten;
            }
        }
        std::thread::sleep(pause.min(job.limits.time.saturating_sub(elapsed)));
        // Short runs are not kept waiting, long ones are not disturbed.
        pause = (pause * 2).min(Duration::from_millis(20));
    }
}

#[cfg(unix)]
fn end_of(status: ExitStatus) -> End {
    use std::os::unix::process::ExitStatusExt;
    match (status.code(), status.signal()) {
        (Some(code), _) => End::Code(code),
        (None, signal) => End::Signal(signal.unwrap_or_default()),
    }
}

#[cfg(not(unix))]
fn end_of(status: ExitStatus) -> End {
    End::Code(status.code().unwrap_or(-1))
}

/// Bytes of all files below a folder; stops when there are more than `most`, or very many files.
fn written(folder: &Path, most: u64) -> u64 {
    const MOST_ENTRIES: usize = 10_000;
    let mut folders: Vec<PathBuf> = vec![folder.to_owned()];
    let (mut bytes, mut entries) = (0_u64, 0);
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
            // Of the entry itself: links are not followed.
            let Ok(metadata) = entry.metadata() else { continue };
            if metadata.is_dir() {
                folders.push(entry.path());
            }
            bytes = bytes.saturating_add(metadata.len());
            entries += 1;
            if bytes > most {
                return bytes;
            }
            if entries > MOST_ENTRIES {
                return u64::MAX;
            }
        }
    }
    bytes
}

/// Opens a file that a program may have made into anything: links are not followed, and nothing is waited for.
///
/// # Errors
/// The system's, or that it is no regular file.
pub fn open_regular(path: &Path) -> io::Result<File> {
    let mut options = File::options();
    options.read(true);
    #[cfg(unix)]
    {
        use nix::fcntl::OFlag;
        use std::os::unix::fs::OpenOptionsExt;
        options.custom_flags((OFlag::O_NOFOLLOW | OFlag::O_NONBLOCK).bits());
    }
    // Elsewhere the look before the opening has to do.
    if std::fs::symlink_metadata(path)?.is_file() {
        let file = options.open(path)?;
        if file.metadata()?.is_file() {
            return Ok(file);
        }
    }
    Err(io::Error::other("it is no regular file"))
}

/// Beginning and end of a log, without what could upset a terminal or a report.
fn excerpt(path: &Path) -> String {
    use std::io::Seek;
    use std::io::SeekFrom;
    const HALF: u64 = 2000;
    let mut bytes = Vec::new();
    let mut read = || {
        let mut file = open_regular(path)?;
        let length = file.metadata()?.len();
        file.by_ref().take(2 * HALF).read_to_end(&mut bytes)?;
        if length > 2 * HALF {
            bytes.truncate(HALF as usize);
            bytes.extend_from_slice("\n…\n".as_bytes());
            file.seek(SeekFrom::Start(length - HALF))?;
            file.take(HALF).read_to_end(&mut bytes)?;
        }
        io::Result::Ok(())
    };
    // What cannot be read is not shown.
    let _ = read();
    printable(&String::from_utf8_lossy(&bytes))
}

/// Text without control characters other than line ends.
pub fn printable(text: &str) -> String {
    let shown = |c: char| match c {
        '\n' => '\n',
        '\t' => ' ',
        c if c.is_control()
            || ('\u{202a}'..='\u{202e}').contains(&c)
            || c == '\u{fffe}'
            || c == '\u{ffff}' =>
        {
            '·'
        }
        c => c,
    };
    text.replace("\r\n", "\n").chars().map(shown).collect()
}

/// Whether the system would find this program.
pub fn exists(program: &str) -> bool {
    let path = Path::new(program);
    if path.components().count() > 1 || path.is_absolute() {
        return path.is_file();
    }
    let folders = std::env::var_os("PATH").unwrap_or_default();
    std::env::split_paths(&folders).any(|folder| {
        let file = folder.join(program);
        file.is_file() || file.with_extension(std::env::consts::EXE_EXTENSION).is_file()
    })
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    fn limits(seconds: f64) -> RunLimits {
        RunLimits { time: Duration::from_secs_f64(seconds), memory: Some(512), file: 1, processes: None }
    }

    fn run_shell(script: &str, seconds: f64) -> (Ended, tempfile::TempDir) {
        let [folder, logs] = [(); 2].map(|()| tempfile::tempdir().unwrap());
        let words = ["/bin/sh", "-c", script].map(str::to_owned);
        let limits = limits(seconds);
        let job = Job { words: &words, folder: folder.path(), logs: logs.path(), limits: &limits };
        (run(&job, &|| false), folder)
    }

    #[test]
    fn ends_are_told_apart() {
        let (ended, _) = run_shell("echo hello; printf 'a\\033[1mb' >&2; exit 3", 5.0);
        assert_eq!(
            (ended.end, ended.stdout.as_str(), ended.stderr.as_str()),
            (End::Code(3), "hello\n", "a·[1mb")
        );
        assert_eq!(run_shell("kill -SEGV $$", 5.0).0.end, End::Signal(11));
        let words = ["/nowhere/program".to_owned()];
        let folder = tempfile::tempdir().unwrap();
        let limits = limits(5.0);
        let job = Job { words: &words, folder: folder.path(), logs: folder.path(), limits: &limits };
        let ended = run(&job, &|| false);
        assert_eq!(ended.end, End::Code(127));
        assert!(ended.stderr.contains("/nowhere/program"), "{}", ended.stderr);
        let words = ["sleep", "9"].map(str::to_owned);
        let job = Job { words: &words, ..job };
        assert_eq!(run(&job, &|| true).end, End::Stopped);
    }

    #[test]
    fn time_is_up_for_children_too() {
        let start = Instant::now();
        let marker = format!("{}", 100_000 + std::process::id());
        let (ended, _) = run_shell(&format!("sleep {marker} & setsid sleep {marker} & sleep {marker}"), 0.5);
        assert_eq!(ended.end, End::TimedOut);
        assert!(start.elapsed() < Duration::from_secs(4), "{:?}", start.elapsed());
        std::thread::sleep(Duration::from_millis(100));
        assert_eq!(sleeping(&marker), 0);
        // Those left behind by a program that ended well are ended as well.
        let (ended, _) = run_shell(&format!("setsid sleep {marker} & sleep {marker} & exit 0"), 5.0);
        assert_eq!(ended.end, End::Code(0));
        std::thread::sleep(Duration::from_millis(100));
        assert_eq!(sleeping(&marker), 0);
    }

    /// How many processes have the word on their command line and are alive.
    fn sleeping(word: &str) -> usize {
        let entries = std::fs::read_dir("/proc").into_iter().flatten().flatten();
        let line = |path: PathBuf| std::fs::read(path.join("cmdline")).unwrap_or_default();
        let lines = entries.map(|entry| String::from_utf8_lossy(&line(entry.path())).into_owned());
        lines.filter(|line| line.starts_with("sleep") && line.contains(word)).count()
    }

    #[test]
    fn files_and_memory_are_limited() {
        let (ended, folder) = run_shell("exec yes > big", 5.0);
        assert_eq!(ended.end, End::Signal(25));
        assert_eq!(std::fs::metadata(folder.path().join("big")).unwrap().len(), 1 << 20);
        assert_eq!(run_shell("exec yes", 5.0).0.end, End::Signal(25));
        let many = "i=0; while :; do head -c 1000000 /dev/zero > $i; i=$((i+1)); done";
        assert_eq!(run_shell(many, 20.0).0.end, End::TooMuchWritten);
        let (ended, _) = run_shell("x=$(head -c 900000000 /dev/zero | tr '\\0' x); echo ${#x}", 20.0);
        assert_ne!(ended.stdout, "900000000\n");
        assert_ne!(ended.end, End::Code(0));
    }

    #[test]
    fn no_link_and_no_pipe_is_opened() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("link");
        std::os::unix::fs::symlink("/dev/zero", &path).unwrap();
        assert!(open_regular(&path).is_err());
        let pipe = folder.path().join("pipe");
        assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        assert!(open_regular(&pipe).is_err());
        assert!(open_regular(folder.path()).is_err());
        std::fs::write(folder.path().join("file"), "x").unwrap();
        assert!(open_regular(&folder.path().join("file")).is_ok());
    }
}
