//! Several bags of one drive: recorders split their files, and an interrupted recording is still one drive.

use crate::findings::bags::{bag_missing, bag_splits_unread, bags_joined};
use std::path::Path;

use super::found::{Content, FoundFile};
use crate::error::OpenError;
use crate::format::bag;
use crate::format::bag::{Piece, natural_key};
use resect_core::deployment::Finding;
use resect_core::progress::Progress;

/// Longest pause between bags of one drive (s): nobody moves three stations in less.
const LONGEST_PAUSE_S: f64 = 600.0;

/// Returns a bag on disk as its reader takes it; `None` for any other file.
pub fn piece(file: &FoundFile) -> Option<Piece<'_>> {
    match &file.content {
        Content::Disk(path) if file.format.is_bag() => Some(Piece { path, file: &file.file }),
        _ => None,
    }
}

/// Returns the bags in the order of their recording, if they follow each other without overlap; `None` otherwise, as for the same
/// drive in several containers.
pub fn of_one_drive<'a>(
    candidates: &[&'a FoundFile],
    progress: &Progress,
) -> Result<Option<Vec<&'a FoundFile>>, OpenError> {
    if !candidates.iter().all(|file| file.format.is_bag()) {
        return Ok(None);
    }
    let mut spans = Vec::new();
    for file in candidates {
        let Some(piece) = piece(file) else { return Ok(None) };
        match bag::span_s(&piece, progress) {
            Ok(Some(span_s)) => spans.push((span_s, *file)),
            Err(OpenError::Cancelled) => return Err(OpenError::Cancelled),
            // The span of this bag is unknown, so the order is not determined.
            Ok(None) | Err(_) => return Ok(None),
        }
    }
    spans.sort_by(|(a, _), (b, _)| a[0].total_cmp(&b[0]));
    let follows = |pair: &[([f64; 2], &FoundFile)]| {
        let pause_s = pair[1].0[0] - pair[0].0[1];
        (0.0..=LONGEST_PAUSE_S).contains(&pause_s)
    };
    Ok(spans.windows(2).all(follows).then(|| spans.into_iter().map(|(_, file)| file).collect()))
}

/// Returns a finding if the chosen bags are several, or one of several files of a split recording.
pub fn finding(chosen: &[&FoundFile], files: &[FoundFile]) -> Option<Finding> {
    let bags: Vec<_> = chosen.iter().filter(|file| file.format.is_bag()).collect();
    match bags[..] {
        [] => None,
        [only] => {
            let name = split_name(&only.file)?;
            let others = files.iter().filter(|f| f.format.is_bag() && f.file != only.file);
            let mut others: Vec<_> = others
                .filter(|f| split_name(&f.file).is_some_and(|other| other.stem == name.stem))
                .map(|f| f.file.as_str())
                .collect();
            others.sort_by_cached_key(|file| natural_key(file));
            (!others.is_empty()).then(|| bag_splits_unread(&only.file, &others))
        }
        _ => {
            let names: Vec<_> = bags.iter().map(|file| file.file.as_str()).collect();
            Some(match missing_piece(&names) {
                Some(missing) => bag_missing(&names, missing),
                None => bags_joined(&names),
            })
        }
    }
}

/// Name of a file of a split recording: `drive_3.bag`, `drive/drive_3.db3.zstd`.
struct SplitName<'a> {
    /// The path up to the last underscore.
    stem: &'a str,
    number: u64,
}

fn split_name(file: &str) -> Option<SplitName<'_>> {
    let base = Path::new(file).file_name()?.to_str()?;
    let folder = file.len() - base.len();
    let before_endings = folder + base.find('.').unwrap_or(base.len());
    let (stem, number) = file[..before_endings].rsplit_once('_')?;
    Some(SplitName { stem, number: number.parse().ok()? })
}

/// Returns the first missing number, if all files belong to the same split recording.
fn missing_piece(names: &[&str]) -> Option<u64> {
    let pieces: Vec<_> = names.iter().map(|name| split_name(name)).collect::<Option<_>>()?;
    let first = pieces.first()?;
    if pieces.iter().any(|piece| piece.stem != first.stem) {
        return None;
    }
    let last = pieces.iter().map(|piece| piece.number).max()?;
    // Dates look like numbers of split files, too.
    let there = |number: &u64| pieces.iter().any(|piece| piece.number == *number);
    (last < 1000).then(|| (0..last).find(|number| !there(number))).flatten()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_are_known_by_their_names() {
        assert_eq!(missing_piece(&["d/x_0.db3", "d/x_1.db3", "d/x_2.db3"]), None);
        assert_eq!(missing_piece(&["x_0.bag", "x_2.bag"]), Some(1));
        assert_eq!(missing_piece(&["x_1.mcap.zstd", "x_2.mcap.zstd"]), Some(0));
        assert_eq!(missing_piece(&["x_0.bag", "y_2.bag"]), None);
        assert_eq!(missing_piece(&["a.bag", "b.bag"]), None);
        assert_eq!(missing_piece(&["run_20220711.bag", "run_20220713.bag"]), None);
    }
}
