//! Films of a sequence: its pictures for displays in one file that moves.

use crate::failure::Failure;
use std::{
    ffi::OsStr,
    fs::File,
    io::{self, BufReader, BufWriter, Write},
    path::{Path, PathBuf},
    process::{Command, Stdio},
};
use steradian::image::{self, TemporaryFolder};

/// Kinds of films by their extensions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Animated PNG: all colours, and alpha.
    Apng,
    /// GIF: 256 colours a frame.
    Gif,
    /// A video or an animated WebP, by the program ffmpeg.
    Ffmpeg,
}

/// Extensions of films.
pub const EXTENSIONS: [(&str, Kind); 5] =
    [("apng", Kind::Apng), ("gif", Kind::Gif), ("mp4", Kind::Ffmpeg), ("webm", Kind::Ffmpeg), ("webp", Kind::Ffmpeg)];

/// The kind of a film; `None` for names of other files.
pub fn kind(path: &Path) -> Option<Kind> {
    let extension = path.extension()?;
    EXTENSIONS.iter().find(|(name, _)| extension.eq_ignore_ascii_case(name)).map(|(_, kind)| *kind)
}

/// Films that are made of the frames of a sequence, in a temporary folder.
pub struct Films {
    films: Vec<(PathBuf, Kind)>,
    folder: TemporaryFolder,
}

impl Films {
    /// Takes the films out of some outputs; `None` where there are none.
    ///
    /// # Errors
    /// Films that cannot be made here, found out before anything is rendered.
    pub fn among(outputs: &mut Vec<PathBuf>) -> Result<Option<Self>, Failure> {
        let films: Vec<(PathBuf, Kind)> = outputs.iter().filter_map(|path| Some((path.clone(), kind(path)?))).collect();
        outputs.retain(|path| kind(path).is_none());
        if films.is_empty() {
            return Ok(None);
        }
        if let Some((path, _)) = films.iter().find(|film| film.1 == Kind::Ffmpeg).filter(|_| !has_ffmpeg()) {
            let why = "takes the program ffmpeg, which is not found; .apng and .gif take none";
            return Err(Failure::bad_input(format!("'{}' {why}", path.display())));
        }
        let folder = TemporaryFolder::new("steradian-")
            .map_err(|e| Failure::failed(format!("there is no temporary folder for the frames: {e}")))?;
        Ok(Some(Self { films, folder }))
    }

    /// The films' names.
    pub fn paths(&self) -> impl Iterator<Item = &Path> {
        self.films.iter().map(|film| &*film.0)
    }

    /// The picture of a frame, as an output that frames are numbered by.
    pub fn picture(&self) -> PathBuf {
        self.folder.path().join("frame.png")
    }

    /// Makes the films of the frames that are there, so many a second.
    ///
    /// # Errors
    /// The film and what keeps it from being made.
    pub fn make(&self, frames: &[PathBuf], fps: f64) -> Result<(), Failure> {
        for (path, kind) in &self.films {
            let failed = |e: &dyn std::fmt::Display| Failure::failed(format!("cannot make '{}': {e}", path.display()));
            match kind {
                Kind::Apng => image::stream_whole(path, |out| apng(out, frames, fps)).map_err(|e| failed(&e))?,
                Kind::Gif => image::stream_whole(path, |out| gif_film(out, frames, fps)).map_err(|e| failed(&e))?,
                Kind::Ffmpeg => {
                    let made =
                        self.by_ffmpeg(path.extension().unwrap_or_default(), frames, fps).map_err(|e| failed(&e))?;
                    let copied = image::stream_whole(path, |out| io::copy(&mut File::open(&made)?, out).map(drop));
                    copied.map_err(|e| failed(&e))?;
                }
            }
        }
        Ok(())
    }

    /// A film in the temporary folder.
    fn by_ffmpeg(&self, extension: &OsStr, frames: &[PathBuf], fps: f64) -> io::Result<PathBuf> {
        let list = self.folder.path().join("frames.txt");
        let mut lines = BufWriter::new(File::create(&list)?);
        for frame in frames {
            writeln!(lines, "file '{}'\nduration {}", frame.display(), 1.0 / fps)?;
        }
        lines.into_inner().map_err(io::IntoInnerError::into_error)?;
        let made = self.folder.path().join("film").with_extension(extension);
        let mut command = Command::new("ffmpeg");
        command.args(["-y", "-loglevel", "error", "-f", "concat", "-safe", "0", "-i"]).arg(&list);
        if extension.eq_ignore_ascii_case("webp") {
            command.args(["-loop", "0", "-lossless", "1"]);
        } else {
            // Players want even sizes and colours at half the resolution.
            command.args(["-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-pix_fmt", "yuv420p"]);
        }
        let run = command.args(["-r", &fps.to_string()]).arg(&made).stdin(Stdio::null()).output()?;
        match run.status.success() {
            true => Ok(made),
            false => Err(io::Error::other(format!("ffmpeg says: {}", String::from_utf8_lossy(&run.stderr).trim()))),
        }
    }
}

fn has_ffmpeg() -> bool {
    let mut run = Command::new("ffmpeg");
    run.arg("-version").stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    run.status().is_ok_and(|status| status.success())
}

/// A picture of a frame: width, height, and bytes in rows, four for each pixel.
fn frame(path: &Path) -> io::Result<(u32, u32, Vec<u8>)> {
    let mut decoder = png::Decoder::new(BufReader::new(File::open(path)?));
    decoder.set_transformations(png::Transformations::normalize_to_color8() | png::Transformations::ALPHA);
    let mut reader = decoder.read_info()?;
    let size = reader.output_buffer_size().ok_or(io::ErrorKind::InvalidData)?;
    let mut bytes = vec![0; size];
    let info = reader.next_frame(&mut bytes)?;
    bytes.truncate(info.buffer_size());
    if info.color_type == png::ColorType::GrayscaleAlpha {
        bytes = bytes.chunks_exact(2).flat_map(|p| [p[0], p[0], p[0], p[1]]).collect();
    }
    Ok((info.width, info.height, bytes))
}

/// Frames per second as a fraction of small whole numbers: seconds of a frame.
fn delay(fps: f64) -> (u16, u16) {
    let whole = (fps - fps.round()).abs() < 1e-6 && fps >= 1.0 && fps <= f64::from(u16::MAX);
    if whole { (1, fps as u16) } else { ((1000.0 / fps).round().clamp(1.0, f64::from(u16::MAX)) as u16, 1000) }
}

fn apng(out: &mut dyn Write, frames: &[PathBuf], fps: f64) -> io::Result<()> {
    let Some(first) = frames.first() else { return Ok(()) };
    let (width, height, _) = frame(first)?;
    let mut encoder = png::Encoder::new(out, width, height);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_animated(u32::try_from(frames.len()).map_err(|_| io::ErrorKind::InvalidInput)?, 0)?;
    let (numerator, denominator) = delay(fps);
    encoder.set_frame_delay(numerator, denominator)?;
    let mut writer = encoder.write_header()?;
    for path in frames {
        writer.write_image_data(&frame(path)?.2)?;
    }
    writer.finish()?;
    Ok(())
}

fn gif_film(out: &mut dyn Write, frames: &[PathBuf], fps: f64) -> io::Result<()> {
    let Some(first) = frames.first() else { return Ok(()) };
    let (width, height, _) = frame(first)?;
    let too_large = |_| io::Error::other("a GIF has at most 65535 pixels a side");
    let (width, height) = (u16::try_from(width).map_err(too_large)?, u16::try_from(height).map_err(too_large)?);
    let mut encoder = gif::Encoder::new(out, width, height, &[]).map_err(io::Error::other)?;
    encoder.set_repeat(gif::Repeat::Infinite).map_err(io::Error::other)?;
    for (k, path) in frames.iter().enumerate() {
        // Hundredths of a second: what is rounded is made up by the frames that follow.
        let moment = |k: usize| (100.0 * k as f64 / fps).round();
        let mut bytes = frame(path)?.2;
        let mut frame = gif::Frame::from_rgba_speed(width, height, &mut bytes, 10);
        frame.delay = (moment(k + 1) - moment(k)).clamp(1.0, f64::from(u16::MAX)) as u16;
        encoder.write_frame(&frame).map_err(io::Error::other)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian::image::{Image, WriteOptions};

    fn frames(folder: &Path, count: usize) -> Vec<PathBuf> {
        let make = |k: usize| {
            let pixels: Vec<[f32; 3]> =
                (0..12).map(|i| if i == k { [1.0, 0.0, 0.0] } else { [0.0, 0.0, 1.0] }).collect();
            let path = folder.join(format!("{k}.png"));
            image::write(&path, &Image::from_rgb(4, 3, &pixels).unwrap(), &WriteOptions::default()).unwrap();
            path
        };
        (0..count).map(make).collect()
    }

    #[test]
    fn films_hold_their_frames() {
        let folder = tempfile::tempdir().unwrap();
        let frames = frames(folder.path(), 5);
        let mut file = Vec::new();
        apng(&mut file, &frames, 12.5).unwrap();
        let mut reader = png::Decoder::new(io::Cursor::new(&file)).read_info().unwrap();
        assert_eq!(reader.info().animation_control().unwrap().num_frames, 5);
        for k in 0..5 {
            let mut bytes = vec![0; 48];
            reader.next_frame(&mut bytes).unwrap();
            assert_eq!(bytes[4 * k..4 * k + 4], [255, 0, 0, 255]);
            let control = reader.info().frame_control().unwrap();
            assert_eq!((control.delay_num, control.delay_den), (80, 1000));
        }
        let mut file = Vec::new();
        gif_film(&mut file, &frames, 24.0).unwrap();
        let mut options = gif::DecodeOptions::new();
        options.set_color_output(gif::ColorOutput::RGBA);
        let mut decoder = options.read_info(&*file).unwrap();
        let (mut count, mut time) = (0, 0);
        while let Some(frame) = decoder.read_next_frame().unwrap() {
            assert_eq!(frame.buffer[4 * count..4 * count + 4], [255, 0, 0, 255]);
            (count, time) = (count + 1, time + frame.delay);
        }
        // 5/24 s.
        assert_eq!((count, time), (5, 21));
    }

    #[test]
    fn films_are_told_from_pictures() {
        let mut outputs: Vec<PathBuf> = ["a.png", "b.GIF", "c.exr"].map(PathBuf::from).into();
        let films = Films::among(&mut outputs).unwrap().unwrap();
        assert_eq!(films.paths().collect::<Vec<_>>(), [Path::new("b.GIF")]);
        assert_eq!(outputs, ["a.png", "c.exr"].map(PathBuf::from));
        assert!(Films::among(&mut outputs).unwrap().is_none());
        assert_eq!((delay(24.0), delay(12.5), delay(0.001)), ((1, 24), (80, 1000), (65535, 1000)));
    }
}
