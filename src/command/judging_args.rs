//! How trajectories of other systems are judged: the flags that `resect evaluate` and `resect report --judge` share.

use super::choice::{ESTIMATE_ALIGNMENTS, choice};
use clap::Args;

use super::Failure;
use super::settings_args::metres;
use resect_core::estimates::{Alignment, Body, Options};

#[derive(Args)]
pub struct JudgingArguments {
    /// What an estimate's frame may be turned, moved and stretched by; with none it is in station 1's. This flag and the next
    /// two are given once for all estimates, or once for each in their order
    #[arg(long, value_parser = choice(ESTIMATE_ALIGNMENTS), default_values = ["rigid"])]
    align: Vec<Alignment>,
    /// What is added to an estimate's times (s), or found
    #[arg(long, value_name = "SECONDS|found", default_value = "found", allow_negative_numbers = true, value_parser = offset)]
    time_offset: Vec<Option<f64>>,
    /// Where an estimate's body is in the vehicle: found, the same as the vehicle's frame, or its origin there, known; of one
    /// prism where that is in the body's frame (m)
    #[arg(long, alias = "lever-arm", value_name = "found|same|X,Y,Z", default_value = "found", allow_hyphen_values = true, value_parser = body)]
    body: Vec<Body>,
}

impl JudgingArguments {
    /// Whether anything else is wanted than without these flags.
    pub fn are_given(&self) -> bool {
        self.options_of_each(1).ok() != Some(vec![Options::default()])
    }

    /// How each of so many files is judged.
    pub fn options_of_each(&self, count: usize) -> Result<Vec<Options>, Failure> {
        let align = one_or_each("--align", &self.align, count)?;
        let time_offset_s = one_or_each("--time-offset", &self.time_offset, count)?;
        let body = one_or_each("--body", &self.body, count)?;
        let each = align.into_iter().zip(time_offset_s).zip(body);
        Ok(each
            .map(|((alignment, time_offset_s), body)| Options { alignment, time_offset_s, body })
            .collect())
    }
}

/// A value for each file, of a flag that is given once for all or once for each.
fn one_or_each<T: Copy>(flag: &str, values: &[T], count: usize) -> Result<Vec<T>, Failure> {
    match values {
        [one] => Ok(vec![*one; count]),
        each if each.len() == count => Ok(each.to_vec()),
        several => Err(Failure::Usage(format!(
            "{flag} is given {} times and the number of trajectories is {count}; give it once for all, or once for each in their \
             order",
            several.len()
        ))),
    }
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
            "give found, same, or three numbers with commas between them, in metres".to_owned()
        }),
    }
}
