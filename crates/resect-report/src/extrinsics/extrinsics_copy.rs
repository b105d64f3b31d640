//! The pose of b in a, as text for other programs.

use std::fmt::Write;

use super::extrinsics_text::{conclusion, quantities};
use crate::named_transform::{NamedTransform, TransformFormat, one_line, transforms_text};
use resect_core::calibration::Verdict;
use resect_tools::extrinsics::Extrinsics;

/// Returns the transform with σ and verdict as comments; `frames` are the names of both bodies in tf and URDF.
pub fn extrinsics_copy(
    extrinsics: &Extrinsics,
    frames: Option<[String; 2]>,
    format: TransformFormat,
) -> String {
    let [parent, child] =
        frames.unwrap_or_else(|| extrinsics.names.clone().map(|name| identifier(&name)));
    let [a, b] = extrinsics.names.each_ref().map(|name| one_line(name));
    let mut comments = format!("# {b} in {a}, verdict {}\n", extrinsics.verdict.name());
    for row in quantities(extrinsics) {
        _ = writeln!(comments, "# {}: {}", row.label, row.value);
    }
    if extrinsics.solution.rotation_sigma_rad.is_none() {
        _ = writeln!(
            comments,
            "# {b} has positions only, so the rotation is not determined and stands as none"
        );
    }
    if extrinsics.verdict != Verdict::Good {
        _ = writeln!(
            comments,
            "# WARNING: verdict {}: {}",
            extrinsics.verdict.name().to_uppercase(),
            conclusion(extrinsics)
        );
    }
    let transform = NamedTransform {
        name: format!("{parent}_from_{child}").replace(['/', '.', '-'], "_"),
        maps: format!("{b} into {a}"),
        parent,
        child,
        parent_from_child: extrinsics.solution.a_from_b,
    };
    transforms_text(format, &comments, &[transform])
}

/// Replaces what a name of a frame cannot have in a shell.
fn identifier(name: &str) -> String {
    let is_plain = |c: &char| c.is_ascii_alphanumeric() || matches!(c, '_' | '-' | '.' | '/');
    name.chars().map(|c| if is_plain(&c) { c } else { '_' }).collect()
}
