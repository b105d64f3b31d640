//! Reads the JSON of a calibration again, for `validate`.

use resect_core::network::PerPair;
use std::path::{Path, PathBuf};

use nalgebra::{DMatrix, DVector, Matrix3, Matrix4, Rotation3};
use serde::Deserialize;

use super::schema::SCHEMA;
use resect_core::calibration::{Method, Verdict};
use resect_core::deployment::TrackFrame;
use resect_core::geometry::RigidTransform;
use resect_core::network::PerStation;
use resect_tools::validation::Earlier;

/// Tolerances for rotations and covariances, which are written with some fifteen digits.
const NO_ROTATION: f64 = 1e-6;
const NO_COVARIANCE: f64 = 1e-9;

/// Reason why a file is not a usable calibration.
#[derive(Debug, thiserror::Error)]
pub enum EarlierError {
    #[error("{}: {error}; give the file of `resect calibrate FOLDER --json` first, then the runs", path.display())]
    Io { path: PathBuf, error: std::io::Error },
    #[error(
        "{file}: not the JSON of a calibration: {why}; write it with `resect calibrate FOLDER --json`"
    )]
    NotOne { file: String, why: serde_json::Error },
    #[error(
        "{file}: schema {found}, but this version reads {SCHEMA}; write it with `resect calibrate FOLDER --json`"
    )]
    OtherSchema { file: String, found: u32 },
    #[error("{file}: it has several calibrations; write one, with one --method")]
    Several { file: String },
    #[error(
        "{file}: a calibration of one station has no transform to validate; write one of several stations with \
         `resect calibrate FOLDER --json`"
    )]
    OneStation { file: String },
    #[error("{file}: {what}; write it with `resect calibrate FOLDER --json`")]
    Wrong { file: String, what: String },
}

#[derive(Deserialize)]
struct WrittenSchema {
    schema: u32,
}

/// Fields that a validation needs. Files of older versions may lack newer keys.
#[derive(Deserialize)]
struct Written {
    deployment: String,
    method: Method,
    track_frame: Option<TrackFrame>,
    inter_prism_m: Option<PerPair<f64>>,
    transforms: Vec<WrittenTransform>,
    covariance: Option<Vec<Vec<f64>>>,
    diagnosis: WrittenDiagnosis,
}

#[derive(Deserialize)]
struct WrittenTransform {
    from: usize,
    to: usize,
    matrix: [[f64; 4]; 4],
    sigma: Option<WrittenSigma>,
}

#[derive(Deserialize)]
struct WrittenSigma {
    translation_m: [f64; 3],
    yaw_rad: f64,
}

#[derive(Deserialize)]
struct WrittenDiagnosis {
    verdict: Verdict,
    #[serde(default)]
    doubts: Vec<WrittenFinding>,
}

#[derive(Deserialize)]
struct WrittenFinding {
    message: String,
}

/// Reads the output of `calibrate --json`, by any method.
pub fn read_earlier(path: &Path) -> Result<Earlier, EarlierError> {
    let text = std::fs::read_to_string(path)
        .map_err(|error| EarlierError::Io { path: path.to_owned(), error })?;
    earlier(&path.display().to_string(), &text)
}

fn earlier(file: &str, text: &str) -> Result<Earlier, EarlierError> {
    let not_one = |why| EarlierError::NotOne { file: file.to_owned(), why };
    if text.trim_start().starts_with('[') {
        return Err(EarlierError::Several { file: file.to_owned() });
    }
    let WrittenSchema { schema } = serde_json::from_str(text).map_err(not_one)?;
    if schema != SCHEMA {
        return Err(EarlierError::OtherSchema { file: file.to_owned(), found: schema });
    }
    let written: Written = serde_json::from_str(text).map_err(not_one)?;
    let wrong = |what: &str| EarlierError::Wrong { file: file.to_owned(), what: what.to_owned() };
    let others = &written.transforms;
    if others.is_empty() {
        return Err(EarlierError::OneStation { file: file.to_owned() });
    }
    let is_numbered = others.iter().zip(2..).all(|(one, number)| [one.from, one.to] == [number, 1]);
    if !is_numbered {
        return Err(wrong("the transforms are not those of stations 2, 3, … into station 1"));
    }
    let mut transforms: PerStation<RigidTransform> = [RigidTransform::IDENTITY].into();
    for one in others {
        let transform = rigid(&one.matrix);
        transforms
            .push(transform.ok_or_else(|| wrong("a matrix is not a rotation and translation"))?);
    }
    let unknowns = 4 * others.len();
    let covariance = match written.covariance {
        Some(rows) => {
            if rows.len() != unknowns || rows.iter().any(|row| row.len() != unknowns) {
                return Err(wrong(
                    "invalid covariance: not four rows and columns for each station",
                ));
            }
            Some(DMatrix::from_fn(unknowns, unknowns, |row, column| rows[row][column]))
        }
        None => {
            let sigmas = others.iter().map(|one| one.sigma.as_ref());
            sigmas.collect::<Option<Vec<_>>>().map(|sigmas| uncorrelated(&sigmas))
        }
    };
    if covariance.as_ref().is_some_and(|covariance| !is_covariance(covariance)) {
        return Err(wrong("invalid covariance: not symmetric, or not positive definite"));
    }
    Ok(Earlier {
        name: format!("{file} ({})", written.deployment),
        method: written.method,
        verdict: written.diagnosis.verdict,
        doubt: written.diagnosis.doubts.into_iter().next().map(|doubt| doubt.message),
        track_frame: written.track_frame,
        station1_from_station: transforms,
        covariance,
        inter_prism_m: written.inter_prism_m,
    })
}

/// Returns the rigid transform of a homogeneous matrix, given by rows; `None` if it is not rigid.
fn rigid(rows: &[[f64; 4]; 4]) -> Option<RigidTransform> {
    let matrix = Matrix4::from_fn(|row, column| rows[row][column]);
    let rotation: Matrix3<f64> = matrix.fixed_view::<3, 3>(0, 0).into();
    let off = (rotation.tr_mul(&rotation) - Matrix3::identity()).norm();
    let below = matrix.row(3) - Matrix4::<f64>::identity().row(3);
    let rigid = off < NO_ROTATION && below.norm() < NO_ROTATION && rotation.determinant() > 0.0;
    rigid.then(|| RigidTransform {
        rotation: Rotation3::from_matrix_unchecked(rotation),
        translation_m: matrix.fixed_view::<3, 1>(0, 3).into(),
    })
}

fn uncorrelated(sigmas: &[&WrittenSigma]) -> DMatrix<f64> {
    DMatrix::from_diagonal(&DVector::from_fn(4 * sigmas.len(), |k, _| {
        let WrittenSigma { translation_m, yaw_rad } = sigmas[k / 4];
        translation_m.get(k % 4).unwrap_or(yaw_rad).powi(2)
    }))
}

fn is_covariance(matrix: &DMatrix<f64>) -> bool {
    let (count, sigma) = (matrix.nrows(), matrix.diagonal().map(f64::sqrt));
    let correlation = DMatrix::from_fn(count, count, |i, j| matrix[(i, j)] / (sigma[i] * sigma[j]));
    let rounded = &correlation + DMatrix::identity(count, count) * NO_COVARIANCE;
    (&correlation - correlation.transpose()).norm() < NO_COVARIANCE && rounded.cholesky().is_some()
}

#[cfg(test)]
mod tests {
    use std::sync::{Arc, LazyLock};

    use super::*;
    use crate::json;
    use resect_core::analysis::{Analyst, Settings};
    use resect_io::sample::Sample;
    use serde_json::Value;

    /// An answer, and its JSON.
    static SAMPLE: LazyLock<(Earlier, Value)> = LazyLock::new(|| {
        let deployment = Arc::new(Sample::Warthog.open().expect("built in"));
        let analysis = Analyst::new(Arc::clone(&deployment)).run(&Settings::default());
        let answer = analysis.answer.clone().expect("an answer");
        let written = json::calibration(&deployment, &analysis, &answer, 0.0);
        (Earlier::of(&deployment, &answer), written)
    });

    fn read(value: &Value) -> Result<Earlier, EarlierError> {
        earlier("a.json", &value.to_string())
    }

    #[test]
    fn what_is_written_is_read_again() {
        let (answered, written) = &*SAMPLE;
        let found = read(written).expect("its own text");
        // Fifteen digits of each number are preserved.
        let near = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-14);
        for (a, b) in found.station1_from_station.iter().zip(&answered.station1_from_station) {
            assert!(near(a.matrix().as_slice(), b.matrix().as_slice()), "{a:?} {b:?}");
        }
        let [a, b] = [&found, answered].map(|one| one.covariance.as_ref().expect("held"));
        assert!((a - b).norm() < 1e-12 * b.norm(), "{a}{b}");
        assert_eq!(found.name, format!("a.json ({})", answered.name));
        let Earlier { station1_from_station, covariance, name, .. } = answered.clone();
        assert_eq!(Earlier { station1_from_station, covariance, name, ..found }, *answered);
    }

    #[test]
    fn without_a_covariance_sigma_does_and_without_both_nothing() {
        let (answered, written) = &*SAMPLE;
        let mut older = written.clone();
        for key in ["covariance", "track_frame", "inter_prism_m"] {
            older.as_object_mut().expect("an object").remove(key);
        }
        let covariance = read(&older).expect("an older file").covariance.expect("σ");
        let diagonal = answered.covariance.as_ref().expect("held").diagonal();
        assert!((covariance - DMatrix::from_diagonal(&diagonal)).norm() < 1e-15);
        older["transforms"][1]["sigma"] = Value::Null;
        assert_eq!(read(&older).expect("free").covariance, None);
    }

    /// Changes one value, and returns the error.
    fn complaint(pointer: &str, value: Value) -> String {
        let mut changed = SAMPLE.1.clone();
        *changed.pointer_mut(pointer).expect("it is written") = value;
        read(&changed).expect_err("wrong").to_string()
    }

    #[test]
    fn what_is_no_calibration_is_one_line_with_file_and_remedy() {
        let whole = SAMPLE.1.to_string();
        let of = |text: &str| earlier("a.json", text).expect_err("none").to_string();
        // The cut is after a comma: within a number, whose length depends on the run time, the error would be another.
        let cut = whole[..whole.len() / 2].rfind(',').expect("several values");
        let lines = [
            (of(""), "EOF while parsing"),
            (of("x,y\n1,2\n"), "line 1 column 1"),
            (of("NaN"), "not the JSON of a calibration"),
            (of(&whole[..=cut]), "EOF while parsing"),
            (of("{}"), "missing field `schema`"),
            (of("{\"schema\":2}"), "missing field `deployment`"),
            (of(&format!("[{whole},{whole}]")), "several calibrations"),
            (complaint("/schema", 1.into()), "schema 1, but this version reads 2"),
            (complaint("/method", "guess".into()), "unknown variant `guess`"),
            (complaint("/diagnosis/verdict", "fine".into()), "unknown variant `fine`"),
            (complaint("/transforms/0/matrix/0/3", Value::Null), "invalid type: null"),
            (complaint("/transforms/0/matrix/0/0", 7.0.into()), "not a rotation and translation"),
            (complaint("/transforms/1/from", 2.into()), "not those of stations 2, 3, …"),
            (complaint("/transforms", Vec::<Value>::new().into()), "one station has no transform"),
            (complaint("/covariance/0/1", 1.0.into()), "invalid covariance"),
            (complaint("/covariance/3/3", (-1.0).into()), "invalid covariance"),
            (complaint("/covariance/3/3", 0.0.into()), "invalid covariance"),
        ];
        for (line, words) in lines {
            assert!(line.starts_with("a.json: ") && line.contains(words), "{words}: {line}");
            assert!(line.contains("; write ") && !line.contains('\n'), "{line}");
        }
    }

    #[test]
    fn a_folder_is_no_calibration() {
        let line = read_earlier(Path::new("src")).expect_err("a folder").to_string();
        assert!(line.contains("src: ") && line.contains("calibrate FOLDER --json"), "{line}");
    }
}
