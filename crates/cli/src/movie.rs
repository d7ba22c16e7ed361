//! Frames joined to a movie by the program ffmpeg.

use std::ffi::OsString;
use std::fs;
use std::io;
use std::path::Path;
use std::path::PathBuf;
use std::process::Command;
use std::process::Stdio;

use crate::exit::Failure;
use crate::many_args::FrameRange;

/// Kinds of movies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Mp4,
    Gif,
    Webp,
}

fn kind(movie: &Path) -> Result<Kind, Failure> {
    let extension = movie.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    match extension.as_str() {
        "mp4" => Ok(Kind::Mp4),
        "gif" => Ok(Kind::Gif),
        "webp" => Ok(Kind::Webp),
        _ => Err(Failure::Usage(format!("--movie {}: expected .mp4, .gif or .webp", movie.display()))),
    }
}

/// Whether the movie can be made: told before the frames are.
pub fn check(movie: &Path, pattern: &Path) -> Result<(), Failure> {
    kind(movie)?;
    let extension = pattern.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    if !["png", "bmp", "jpg", "jpeg", "ppm", "tif", "tiff"].contains(&extension.as_str()) {
        return Err(Failure::Usage(format!(
            "--movie takes frames of 8 bits a channel, such as PNG; these are .{extension}"
        )));
    }
    match Command::new("ffmpeg").arg("-version").stdin(Stdio::null()).output() {
        Ok(output) if output.status.success() => Ok(()),
        Ok(output) => Err(Failure::Failed(format!("--movie: `ffmpeg -version` ended with {}", output.status))),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Err(Failure::Failed(
            "--movie needs the program `ffmpeg`, which is not on the path; install it, or leave --movie out and join \
             the frames elsewhere"
                .to_owned(),
        )),
        Err(error) => Err(Failure::Failed(format!("--movie: cannot run `ffmpeg`: {error}"))),
    }
}

/// Joins the frames; the movie appears whole or not at all.
pub fn join(movie: &Path, pattern: &Path, frames: FrameRange, fps: u16) -> Result<(), Failure> {
    let kind = kind(movie)?;
    let name = movie.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let temporary = movie.with_file_name(format!(".dotray-{}-{name}", std::process::id()));
    let output = Command::new("ffmpeg")
        .args(arguments(kind, pattern, frames, fps))
        .arg(&temporary)
        .stdin(Stdio::null())
        .output()
        .map_err(|error| Failure::Failed(format!("cannot run `ffmpeg`: {error}")))?;
    let joined = if output.status.success() {
        fs::rename(&temporary, movie).map_err(|error| Failure::file("write", movie, &error))
    } else {
        let said = String::from_utf8_lossy(&output.stderr).trim().to_owned();
        Err(Failure::Failed(format!("`ffmpeg` could not make `{}`: {said}", movie.display())))
    };
    if joined.is_err() {
        // The first error counts.
        let _ = fs::remove_file(&temporary);
    }
    joined
}

fn arguments(kind: Kind, pattern: &Path, frames: FrameRange, fps: u16) -> Vec<OsString> {
    let mut arguments: Vec<OsString> = ["-y", "-v", "error", "-framerate"].map(OsString::from).to_vec();
    arguments.push(fps.to_string().into());
    arguments.push("-start_number".into());
    arguments.push(frames.first.to_string().into());
    arguments.extend(["-i".into(), printf(pattern).into_os_string(), "-frames:v".into()]);
    arguments.push((frames.last - frames.first + 1).to_string().into());
    let own: &[&str] = match kind {
        // What every player plays needs even edges and halved colours.
        Kind::Mp4 => {
            &["-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-c:v", "libx264", "-pix_fmt", "yuv420p", "-f", "mp4"]
        }
        Kind::Gif => &["-vf", "split[a][b];[a]palettegen[p];[b][p]paletteuse", "-loop", "0", "-f", "gif"],
        Kind::Webp => &["-c:v", "libwebp_anim", "-lossless", "1", "-loop", "0", "-f", "webp"],
    };
    arguments.extend(own.iter().map(OsString::from));
    arguments
}

/// The pattern as ffmpeg writes it: `out.%04d.png`.
fn printf(pattern: &Path) -> PathBuf {
    let name = pattern.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let last = name.rfind('#').unwrap_or(0);
    let width = name[..=last].bytes().rev().take_while(|byte| *byte == b'#').count();
    let percent = |text: &str| text.replace('%', "%%");
    let (before, after) = (&name[..last + 1 - width], &name[last + 1..]);
    // A folder's name is a part of ffmpeg's pattern, too.
    let folder = pattern.parent().map(|folder| percent(&folder.to_string_lossy())).unwrap_or_default();
    Path::new(&folder).join(format!("{}%0{width}d{}", percent(before), percent(after)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns_are_translated() {
        assert_eq!(printf("a/out.####.png".as_ref()), Path::new("a/out.%04d.png"));
        assert_eq!(printf("50%#.png".as_ref()), Path::new("50%%%01d.png"));
    }
}
