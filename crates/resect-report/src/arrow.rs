//! The tables of [`csv`](crate::csv) as Arrow IPC files (Feather 2), which pandas, polars and DuckDB read without parsing text.
//!
//! Types are those of the columns, not of the values that happen to be in them: counts are integers, text is text, and everything
//! else is a float. Empty cells are null.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use arrow_array::{ArrayRef, Float64Array, Int64Array, RecordBatch, StringArray};
use arrow_ipc::writer::FileWriter;
use arrow_schema::ArrowError;

use crate::csv::tables;
use resect_core::analysis::Analysis;
use resect_core::deployment::Deployment;
use resect_io::atomic;
use resect_io::atomic::WriteError;

/// Columns of integers, and of text; all others are floats.
const INTEGERS: [&str; 4] = ["station", "interval", "from", "to"];
const TEXTS: [&str; 9] =
    ["fate", "verdict", "group", "subject", "name", "symbol", "unit", "reference", "significant"];

/// Writes all tables into a folder, which is created if missing, and returns their paths.
pub fn write_folder(
    deployment: &Deployment,
    analysis: &Analysis,
    folder: &Path,
) -> Result<Vec<PathBuf>, WriteError> {
    atomic::make_folder(folder)?;
    let mut ready = Vec::new();
    for (name, text) in tables(deployment, analysis) {
        let path = folder.join(file_of(name));
        ready.push(atomic::ready_with(&path, |file| {
            let batch = batch(&text).map_err(std::io::Error::other)?;
            let write = || {
                let mut writer = FileWriter::try_new(file, &batch.schema())?;
                writer.write(&batch)?;
                writer.finish()
            };
            write().map_err(io_error)
        })?);
    }
    atomic::place_all(ready)
}

/// Returns the file name of a table: `readings.arrow` for `readings.csv`.
pub fn file_of(table: &str) -> String {
    format!("{}.arrow", table.trim_end_matches(".csv"))
}

/// Returns the disk's error, which decides the remedy.
fn io_error(error: ArrowError) -> std::io::Error {
    match error {
        ArrowError::IoError(_, error) => error,
        other => std::io::Error::other(other),
    }
}

/// Converts the text of a table.
fn batch(text: &[u8]) -> Result<RecordBatch, Box<dyn std::error::Error + Send + Sync>> {
    let mut reader = ::csv::Reader::from_reader(text);
    let names: Vec<String> = reader.headers()?.iter().map(str::to_owned).collect();
    let mut columns: Vec<Vec<Option<String>>> = vec![Vec::new(); names.len()];
    for record in reader.records() {
        for (column, cell) in columns.iter_mut().zip(&record?) {
            column.push((!cell.is_empty()).then(|| cell.to_owned()));
        }
    }
    let arrays = names.iter().zip(columns).map(|(name, cells)| {
        let array: ArrayRef = if INTEGERS.contains(&&**name) {
            let whole = cells.iter().map(|cell| cell.as_ref().map(|cell| cell.parse()).transpose());
            Arc::new(Int64Array::from(whole.collect::<Result<Vec<Option<i64>>, _>>()?))
        } else if TEXTS.contains(&&**name) {
            Arc::new(StringArray::from(cells))
        } else {
            let reals = cells.iter().map(|cell| cell.as_ref().map(|cell| cell.parse()).transpose());
            Arc::new(Float64Array::from(reals.collect::<Result<Vec<Option<f64>>, _>>()?))
        };
        Ok::<_, Box<dyn std::error::Error + Send + Sync>>((name.clone(), array, true))
    });
    Ok(RecordBatch::try_from_iter_with_nullable(arrays.collect::<Result<Vec<_>, _>>()?)?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use arrow_array::Array;
    use arrow_array::cast::AsArray;
    use arrow_array::types::{Float64Type, Int64Type};

    #[test]
    fn types_are_those_of_the_columns_and_empty_cells_are_null() {
        let batch =
            batch(b"station,time_s,fate,own_clock_s\n1,1657569001.25,kept,\n2,3,\"a, b\",\n")
                .expect("a table");
        let column = |name: &str| batch.column_by_name(name).expect("there");
        assert_eq!(column("station").as_primitive::<Int64Type>().values(), &[1, 2]);
        assert_eq!(
            column("time_s").as_primitive::<Float64Type>().values(),
            &[1_657_569_001.25, 3.0]
        );
        assert_eq!(column("fate").as_string::<i32>().value(1), "a, b");
        assert_eq!(column("own_clock_s").null_count(), 2);
    }
}
