//! Films as MP4, which ffmpeg makes of the frames that it is sent.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::Path;
use std::process::{ChildStdin, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use super::ffmpeg::{failed, ffmpeg, find_encoder, not_started, quality};
use super::{FilmError, FilmSettings};
use crate::render::Picture;
use crate::write::WriteError;
use crate::write::file::{check_going_on, is_cancelled};
use crate::write::growing::Growing;
use crate::write::helper::Helper;

/// Between two looks whether ffmpeg has ended.
const LOOK_AGAIN: Duration = Duration::from_millis(10);

/// After ffmpeg has stopped reading, so long it may take to say why.
const LAST_WORDS: Duration = Duration::from_secs(5);

/// From red, green and blue to what players expect of a film, and say so.
const FILTER: &str = "scale=out_color_matrix=bt709:out_range=tv,format=yuv420p,\
     setparams=color_primaries=bt709:color_trc=bt709:colorspace=bt709:range=tv";

/// An MP4 in the making.
pub(super) struct Mp4Film {
    /// Ended when this is dropped, before its file goes.
    helper: Helper,
    frames: Option<ChildStdin>,
    /// What ffmpeg says.
    said: File,
    file: Growing,
}

impl Mp4Film {
    /// Starts ffmpeg, which writes to the place of `file`.
    pub(super) fn new(file: Growing, settings: &FilmSettings) -> Result<Self, FilmError> {
        let encoder = find_encoder()?;
        // ffmpeg's pixels of H.264 share colours in squares of two by two: both sides have to be even.
        let [width, height] = even(settings);
        let said = tempfile::tempfile().map_err(WriteError::from)?;
        let mut place = std::ffi::OsString::from("file:");
        place.push(file.unfinished_path().unwrap_or(Path::new("")));
        let mut command = ffmpeg();
        command
            .args(["-y", "-f", "rawvideo", "-pixel_format", "rgb24"])
            .args(["-video_size", &format!("{width}x{height}")])
            .args(["-framerate", &settings.rate.get().to_string()])
            .args(["-i", "pipe:0", "-an"])
            .args(["-vf", FILTER])
            .args(["-c:v", encoder])
            .args(quality(encoder, settings))
            .args(["-colorspace", "bt709", "-color_primaries", "bt709"])
            .args(["-color_trc", "bt709", "-color_range", "tv"])
            .args(["-movflags", "+faststart", "-f", "mp4"])
            .arg(place)
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .stderr(said.try_clone().map_err(WriteError::from)?);
        let (helper, frames) = match Helper::start(&mut command) {
            Ok(started) => started,
            Err(error) if is_cancelled(&error) => {
                return Err(WriteError::Cancelled.into());
            }
            Err(error) => return Err(not_started(error)),
        };
        Ok(Self {
            helper,
            frames,
            said,
            file,
        })
    }

    /// Sends a frame, its last column and row twice where their numbers are odd.
    pub(super) fn frame(&mut self, picture: &Picture) -> Result<(), FilmError> {
        let size = picture.size();
        let row = 3 * size.width() as usize;
        let bytes = picture.bytes();
        let sent = match self.frames.as_mut() {
            None => return Err(self.failure()),
            Some(pipe) if row.is_multiple_of(2) && size.height().is_multiple_of(2) => {
                pipe.write_all(bytes)
            }
            Some(pipe) => {
                let last = &bytes[bytes.len() - row..];
                let repeated = (!size.height().is_multiple_of(2)).then_some(last);
                let mut padded = Vec::with_capacity(bytes.len() + 2 * row + bytes.len() / row * 3);
                for row in bytes.chunks_exact(row).chain(repeated) {
                    padded.extend_from_slice(row);
                    if !size.width().is_multiple_of(2) {
                        padded.extend_from_slice(&row[row.len() - 3..]);
                    }
                }
                pipe.write_all(&padded)
            }
        };
        // That the pipe is broken says nothing; ffmpeg says why.
        sent.map_err(|_| self.failure())
    }

    pub(super) fn finish(mut self) -> Result<Growing, FilmError> {
        // ffmpeg ends with its input.
        self.frames = None;
        loop {
            match self.helper.status().map_err(WriteError::from)? {
                Some(status) if status.success() && self.has_film() => return Ok(self.file),
                Some(_) => return Err(self.failure()),
                None => sleep(LOOK_AGAIN),
            }
        }
    }

    /// Whether ffmpeg has written something.
    fn has_film(&mut self) -> bool {
        let about = self.file.file().metadata();
        about.is_ok_and(|about| about.len() > 0)
    }

    /// Why ffmpeg has stopped.
    fn failure(&mut self) -> FilmError {
        self.frames = None;
        let start = Instant::now();
        while let Ok(None) = self.helper.status()
            && start.elapsed() < LAST_WORDS
        {
            sleep(LOOK_AGAIN);
        }
        if let Err(cancelled) = check_going_on() {
            return cancelled.into();
        }
        let mut said = vec![];
        let read = self.said.seek(SeekFrom::Start(0));
        let _ = read.and_then(|_| self.said.read_to_end(&mut said));
        failed(&said)
    }
}

/// The least even width and height that hold a frame.
fn even(settings: &FilmSettings) -> [u32; 2] {
    [settings.size.width(), settings.size.height()].map(|side| side.next_multiple_of(2))
}
