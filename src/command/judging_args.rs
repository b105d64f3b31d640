//! Options of the evaluation of trajectories of other systems: the flags that `resect evaluate` and `resect report --judge` share.

use super::choice::{ESTIMATE_ALIGNMENTS, PLANES, choice};
use std::path::PathBuf;

use clap::Args;

use super::Failure;
use super::settings_args::metres;
use resect_io::estimate_file;
use resect_tools::estimates::conventions::Convention;
use resect_tools::estimates::{Body, EstimatedTrajectory, Options, Plane, TrajectoryAlignment};

#[derive(Args)]
pub struct JudgingArguments {
    /// Alignment of an estimate's frame: rotation, translation and scale; with none it is in the ground truth's. This flag and the next three are
    /// given once for all estimates, or once for each in their order
    #[arg(long, value_parser = choice(ESTIMATE_ALIGNMENTS), default_values = ["rigid"])]
    align: Vec<TrajectoryAlignment>,
    /// Offset that is added to an estimate's times (s), or estimated
    #[arg(long, value_name = "SECONDS|found", default_value = "found", allow_negative_numbers = true, value_parser = offset)]
    time_offset: Vec<Option<f64>>,
    /// Body frame of an estimate in the vehicle: estimated, identical to the vehicle's frame,
    /// or its known origin there; for one prism, the prism's position in the body's frame (m)
    #[arg(long, alias = "lever-arm", value_name = "found|same|X,Y,Z", default_value = "found", allow_hyphen_values = true, value_parser = body)]
    body: Vec<Body>,
    /// Convention of an estimate's file that differs from x y z w, metres, seconds and poses of the body in the world: words separated by commas.
    /// wxyz, euler=xyz or euler=clockwise, left-handed, inverse or inverse-poses (those of the world in the body), world=AXES (of the
    /// orientations), axes=AXES (of the positions), mm, cm, km, in, ft or length=FACTOR, ms, us, ns or time=FACTOR, held (repeated poses are left
    /// out; or held=positions, held=orientations), unset (poses of zeros are left out). AXES are ned, nwu, optical, or letters such as yx-z
    #[arg(long, value_name = "WORDS", default_value = "xyzw", value_parser = convention)]
    convention: Vec<Convention>,
    /// Align each estimate by its first poses only (evo's `--n_to_align`)
    #[arg(long, value_name = "POSES", value_parser = clap::value_parser!(u32).range(4..))]
    align_first: Option<u32>,
    /// Project both trajectories to a plane of the ground truth's frame after the alignment (evo's `--project_to_plane`)
    #[arg(long, value_name = "PLANE", value_parser = choice(PLANES))]
    plane: Option<Plane>,
    /// Assume what evo assumes: equal clocks, one body frame, nearest stamps. The errors are then those of evo_ape and evo_rpe
    #[arg(long)]
    as_evo: bool,
}

impl JudgingArguments {
    /// Returns true if the flags ask for anything but the defaults.
    pub fn are_given(&self) -> bool {
        self.options_of_each(1).ok() != Some(vec![Options::default()])
    }

    /// Reads the trajectories of files, each with its options.
    pub fn read_each(
        &self,
        paths: &[PathBuf],
    ) -> Result<Vec<(EstimatedTrajectory, Options)>, Failure> {
        let mut estimates = Vec::new();
        for (path, options) in paths.iter().zip(self.options_of_each(paths.len())?) {
            estimates
                .extend(estimate_file::read(path)?.into_iter().map(|estimate| (estimate, options)));
        }
        Ok(estimates)
    }

    /// Returns the options for each of `count` files.
    pub fn options_of_each(&self, count: usize) -> Result<Vec<Options>, Failure> {
        let align = one_or_each("--align", &self.align, count)?;
        let time_offset_s = one_or_each("--time-offset", &self.time_offset, count)?;
        let body = one_or_each("--body", &self.body, count)?;
        let convention = one_or_each("--convention", &self.convention, count)?;
        let each = align.into_iter().zip(time_offset_s).zip(body).zip(convention);
        let options = each.map(|(((alignment, time_offset_s), body), convention)| Options {
            alignment,
            time_offset_s,
            body,
            convention,
            align_first: self.align_first.map(|count| count as usize),
            plane: self.plane,
            ..Options::default()
        });
        let as_asked = |options: Options| if self.as_evo { options.as_evo() } else { options };
        Ok(options.map(as_asked).collect())
    }
}

/// Returns a value for each file, from a flag that is given once for all or once for each.
pub fn one_or_each<T: Copy>(flag: &str, values: &[T], count: usize) -> Result<Vec<T>, Failure> {
    match values {
        [one] => Ok(vec![*one; count]),
        each if each.len() == count => Ok(each.to_vec()),
        several => Err(Failure::Usage(format!(
            "{flag} values: {}, trajectories: {count}; give one value for all, or one for each in their order",
            several.len()
        ))),
    }
}

/// Reads a convention; shared with the ground truth.
pub fn convention(text: &str) -> Result<Convention, String> {
    text.parse()
}

fn offset(text: &str) -> Result<Option<f64>, String> {
    match text.trim() {
        "found" => Ok(None),
        number => match number.parse() {
            Ok(offset_s) if f64::is_finite(offset_s) => Ok(Some(offset_s)),
            _ => Err("give a number of seconds, or found".to_owned()),
        },
    }
}

fn body(text: &str) -> Result<Body, String> {
    match text.trim() {
        "found" => Ok(Body::Found),
        "same" => Ok(Body::Same),
        lever => metres(lever).map(Body::Lever).map_err(|_| {
            "give found, same, or three numbers separated by commas, in metres".to_owned()
        }),
    }
}
