//! Tables among the files of tracks: those of one station each, and those with columns that the user has to name.

use resect_core::network::MOST_STATIONS;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use super::found::{Content, FoundFile};
use crate::error::{OpenError, Question};
use crate::format::joined_stamps::are_joined;
use crate::format::table::shown;
use crate::format::{Format, bonn_csv, mapped_csv, polar_csv};
use crate::recording::Recording;
use resect_core::deployment::ColumnMapping;
use resect_core::progress::Progress;

/// Returns the tables that serve as tracks if nothing else does: those that the mapping fits. Without a mapping, asks about the
/// only kind of table; `None` if there is no table, or several kinds.
pub fn unknown<'a>(
    columns: Option<&ColumnMapping>,
    files: &'a [FoundFile],
) -> Result<Option<Vec<&'a FoundFile>>, OpenError> {
    let tables: Vec<_> = files.iter().filter(|f| f.format == Format::UnknownTable).collect();
    let heads = tables.iter().map(|f| f.head()).collect::<Result<Vec<_>, _>>()?;
    if let Some(columns) = columns {
        let fits = |head: &str| mapped_csv::header_of(head, columns).is_some();
        let fitting = tables.iter().zip(&heads).filter(|(_, head)| fits(head));
        let fitting: Vec<_> = fitting.map(|(file, _)| *file).collect();
        return Ok((!fitting.is_empty()).then_some(fitting));
    }
    let headers: Vec<String> = heads.iter().map(|head| mapped_csv::likely_header(head)).collect();
    match tables.first() {
        Some(first) if headers.iter().all(|header| *header == headers[0]) => {
            Err(which_columns(first)?)
        }
        _ => Ok(None),
    }
}

/// Returns true if a file contains the track of one station without its number.
pub fn is_one_stations(file: &FoundFile, columns: Option<&ColumnMapping>) -> bool {
    match (file.format, columns) {
        (Format::PolarCsv, Some(columns)) => polar_csv::with_own_names(columns).station.is_none(),
        (Format::BonnCsv | Format::UnknownTable, Some(columns)) => columns.station.is_none(),
        (Format::BonnCsv, None) => true,
        _ => false,
    }
}

/// Returns the station number of each file that does not contain it: the files are of stations 1, 2, …, in the order that the user
/// or their names give.
pub fn stations(
    folder: &str,
    tracks: &[&FoundFile],
    columns: Option<&ColumnMapping>,
    files: &[FoundFile],
    is_ordered: bool,
) -> Result<Vec<Option<i64>>, OpenError> {
    if !tracks.iter().any(|file| is_one_stations(file, columns)) {
        return Ok(vec![None; tracks.len()]);
    }
    let names: Vec<_> = tracks.iter().map(|file| file.file.as_str()).collect();
    let all_are = tracks.iter().all(|file| is_one_stations(file, columns));
    let same_kind = |f: &&FoundFile| tracks.iter().any(|track| track.format == f.format);
    let is_only_one = files.iter().filter(same_kind).count() == 1;
    let is_ordered = (is_ordered && tracks.len() > 1) || is_only_one;
    match by_number(&names) {
        _ if is_ordered && all_are && tracks.len() <= MOST_STATIONS => {
            Ok((1..).map(Some).take(tracks.len()).collect())
        }
        Some(numbers) if all_are => Ok(numbers.into_iter().map(Some).collect()),
        _ => {
            let files = files.iter().filter(same_kind).map(|f| f.file.clone()).collect();
            Err(Question::StationFiles { folder: folder.to_owned(), files }.into())
        }
    }
}

/// Returns the name of a file without folder and extension.
pub fn stem(file: &str) -> &str {
    Path::new(file).file_stem().and_then(OsStr::to_str).unwrap_or(file)
}

/// Returns the numbers 1, 2, … of names that differ in nothing else.
fn by_number(names: &[&str]) -> Option<Vec<i64>> {
    let [a, b, ..] = names else { return None };
    let digit = |name: &str, at: usize| name.get(at..at + 1)?.parse::<i64>().ok();
    let differs = |at: &usize| digit(a, *at).is_some() && a.get(*at..at + 1) != b.get(*at..at + 1);
    let at = (0..a.len()).find(differs)?;
    let without = |name: &str| Some([name.get(..at)?, name.get(at + 1..)?].concat());
    if names.iter().any(|name| without(name) != without(a)) {
        return None;
    }
    let numbers: Vec<i64> = names.iter().map(|name| digit(name, at)).collect::<Option<_>>()?;
    let mut sorted = numbers.clone();
    sorted.sort_unstable();
    sorted.into_iter().eq(1..=names.len() as i64).then_some(numbers)
}

/// Reads a table of tracks into a recording.
pub fn read(
    file: &FoundFile,
    station: Option<i64>,
    columns: Option<&ColumnMapping>,
    progress: &Progress,
    into: &mut Recording,
) -> Result<(), OpenError> {
    let (name, reader) = (&file.file, file.reader()?);
    match (columns, file.format) {
        (Some(columns), Format::PolarCsv) => {
            let columns = polar_csv::with_own_names(columns);
            mapped_csv::read(name, reader, &columns, station, progress, into)
        }
        (Some(columns), _) => mapped_csv::read(name, reader, columns, station, progress, into),
        (None, Format::UnknownTable) => Err(which_columns(file)?),
        (None, Format::BonnCsv) => match station {
            Some(station) => bonn_csv::read(name, reader, station, progress, into),
            None => {
                Err(Question::StationFiles { folder: name.clone(), files: vec![name.clone()] }
                    .into())
            }
        },
        (None, _) => {
            polar_csv::read(name, reader, progress, into)?;
            let goes_back = into.late_and_repeated().iter().any(|[late, _]| *late > 0);
            if goes_back && are_joined(name, file.reader()?, polar_csv::COLUMNS[0])? {
                let what = "the stamps join seconds and nanoseconds without leading zeros";
                return Err(OpenError::file(name, what, "write the nanoseconds with nine digits"));
            }
            Ok(())
        }
    }
}

fn which_columns(file: &FoundFile) -> Result<OpenError, OpenError> {
    let path = match &file.content {
        Content::Disk(path) => path.clone(),
        Content::Memory(_) => PathBuf::new(),
    };
    let header = shown(&mapped_csv::likely_header(&file.head()?));
    Ok(Question::Columns { file: file.file.clone(), path, header }.into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_differ_in_a_number_number_the_stations() {
        let cases = [
            (["t1.csv", "t2.csv", "t3.csv"], Some(vec![1, 2, 3])),
            (["a/rts3_11.csv", "a/rts1_11.csv", "a/rts2_11.csv"], Some(vec![3, 1, 2])),
            (["1", "2", "2"], None),
            (["raw_1f.csv", "raw_2e.csv", "raw_3d.csv"], None),
            (["a.csv", "b.csv", "c.csv"], None),
            (["ä1", "ä2", "ä3"], Some(vec![1, 2, 3])),
        ];
        for (names, expected) in cases {
            assert_eq!(by_number(&names), expected, "{names:?}");
        }
    }
}
