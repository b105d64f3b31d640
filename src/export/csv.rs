//! Triplets and distance errors as a table for other programs.

use std::path::Path;

use crate::analysis::Analysis;

/// `triplets.csv`: time, interval, the three positions each in its station's frame (m), and with an answer
/// the three distance errors (mm). Full precision: what is read back is bit for bit what was solved.
pub fn write_triplets(analysis: &Analysis, path: &Path) -> Result<(), ::csv::Error> {
    let triplets = analysis.triplets();
    let errors = analysis.answer.as_ref().ok().map(|answer| &answer.evaluation.distance_errors_mm);
    let mut writer = ::csv::Writer::from_path(path)?;
    let mut header = vec!["time_s", "interval", "x1_m", "y1_m", "z1_m", "x2_m", "y2_m", "z2_m"];
    header.extend(["x3_m", "y3_m", "z3_m"]);
    if errors.is_some() {
        header.extend(["error_12_mm", "error_13_mm", "error_23_mm"]);
    }
    writer.write_record(header)?;
    for index in 0..triplets.len() {
        let mut row =
            vec![triplets.time_s[index].to_string(), triplets.interval[index].to_string()];
        for point in triplets.triplet_m(index) {
            row.extend(point.iter().map(ToString::to_string));
        }
        if let Some(errors) = errors {
            row.extend(errors.iter().map(|pair| pair[index].to_string()));
        }
        writer.write_record(row)?;
    }
    writer.flush()?;
    Ok(())
}
