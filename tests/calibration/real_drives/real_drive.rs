//! The drives of `../shared/datasets` with the transforms that their authors published.

use std::path::{Path, PathBuf};

use nalgebra::{Matrix3x4, Rotation3, Vector3};
use resect_core::deployment::Deployment;
use resect_core::geometry::RigidTransform;
use resect_core::network::PerStation;
use resect_core::statistics::median;
use resect_io::open::open;

use crate::common::field_data;

/// Drives outside of the folder `real`: one run, in two layouts.
const RUN_2: [&str; 2] = ["2022-07-11-2", "2022-07-11-2-published"];
/// Run 1 of the same set-up, whose published transforms are those of run 2 as well.
const RUN_1: &str = "real/20220711-1-part";

/// A real drive.
pub struct RealDrive {
    pub name: String,
    pub deployment: Deployment,
    pub published: Option<PublishedTransforms>,
}

/// An independent answer, which no method uses.
pub struct PublishedTransforms {
    pub method: &'static str,
    pub station1_from_station: PerStation<RigidTransform>,
}

/// Returns all real drives by name; none without the field data.
pub fn real_drives() -> Vec<RealDrive> {
    let Some(real) = field_data("real") else { return Vec::new() };
    let entries = std::fs::read_dir(real).expect("readable");
    let paths = entries.map(|entry| entry.expect("an entry").path());
    let mut folders: Vec<PathBuf> = paths.filter(|path| path.is_dir()).collect();
    folders.extend(RUN_2.into_iter().filter_map(field_data));
    folders.sort();
    folders.iter().map(|folder| RealDrive::open(folder)).collect()
}

impl RealDrive {
    fn open(folder: &Path) -> Self {
        let name = folder.file_name().expect("a name").to_string_lossy().into_owned();
        let deployment = open(folder).unwrap_or_else(|error| panic!("{name}: {error}"));
        // A drive with a rig was published with method B, one of a single prism with method C.
        let method = if deployment.rig.is_some() { "B, published" } else { "C, published" };
        let published = if name == RUN_2[0] {
            let run_1 = field_data(RUN_1);
            run_1.and_then(|run_1| PublishedTransforms::read(&run_1, "C of run 1, published"))
        } else {
            PublishedTransforms::read(folder, method)
        };
        Self { name, deployment, published }
    }

    /// Returns the median distance in plan and the median height of a station's track, compared with the published transforms
    /// (mm).
    pub fn off_published_mm(
        &self,
        station1_from_station: &PerStation<RigidTransform>,
        station: usize,
    ) -> Option<[f64; 2]> {
        let published = &self.published.as_ref()?.station1_from_station[station];
        let track = &self.deployment.tracks[station];
        let positions_m = track.measurements.iter().map(|reading| track.position_m(reading));
        let off_m: Vec<Vector3<f64>> = positions_m
            .map(|point_m| {
                station1_from_station[station].apply(&point_m) - published.apply(&point_m)
            })
            .collect();
        let plan_mm = median(off_m.iter().map(|off_m| 1e3 * off_m.xy().norm()))?;
        let height_mm = median(off_m.iter().map(|off_m| 1e3 * off_m.z))?;
        Some([plan_mm, height_mm])
    }
}

impl PublishedTransforms {
    /// Reads the `truth.txt` of a folder: 3×4 matrices of stations 2 and 3, row by row; `None` if it is absent.
    fn read(folder: &Path, method: &'static str) -> Option<Self> {
        let text = std::fs::read_to_string(folder.join("truth.txt")).ok()?;
        let words = text.split_whitespace();
        let numbers: Vec<f64> = words.map(|word| word.parse().expect("a number")).collect();
        assert_eq!(numbers.len(), 24, "two matrices in {}", folder.display());
        let transform = |row: usize| {
            let matrix = Matrix3x4::from_row_slice(&numbers[12 * row..12 * (row + 1)]);
            RigidTransform {
                rotation: Rotation3::from_matrix_unchecked(
                    matrix.fixed_columns::<3>(0).into_owned(),
                ),
                translation_m: matrix.column(3).into_owned(),
            }
        };
        let station1_from_station = [RigidTransform::IDENTITY, transform(0), transform(1)].into();
        Some(Self { method, station1_from_station })
    }
}
