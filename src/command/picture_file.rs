//! Pictures that a command writes: SVG or PNG, by the ending of the file.

use std::path::{Path, PathBuf};

use super::Failure;
use super::output::is_standard_output;
use resect_report::drawing::Drawing;
use resect_report::svg::{Colours, to_png, to_svg};

/// Pixels for each point of a PNG.
const PIXELS_PER_POINT: f32 = 2.0;

/// Parses the name of a picture; standard output is SVG.
pub fn picture_file(name: &str) -> Result<PathBuf, String> {
    let file = PathBuf::from(name);
    let is_known =
        is_standard_output(&file) || has_ending(&file, "svg") || has_ending(&file, "png");
    is_known.then_some(file).ok_or_else(|| "give a file that ends in .svg or .png".to_owned())
}

fn has_ending(file: &Path, ending: &str) -> bool {
    file.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(ending))
}

/// Returns the bytes of a picture in light colours, in the format of its file.
pub fn picture(file: &Path, drawing: &Drawing) -> Result<Vec<u8>, Failure> {
    let svg = to_svg(drawing, Colours::Light);
    match has_ending(file, "png") {
        true => Ok(to_png(&svg, PIXELS_PER_POINT)?),
        false => Ok(svg.into_bytes()),
    }
}
