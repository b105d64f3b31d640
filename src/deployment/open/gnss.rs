//! Which solution file belongs to which GNSS antenna.

use super::Source;
use crate::deployment::format::{self, Format, OpenError, deployment_toml::Overrides};
use crate::deployment::{Finding, GnssFix};

/// Antennas 1, 2, 3: the files that `deployment.toml` names, or the three that are there, by name.
pub fn read_gnss<'a>(
    sources: &'a [Source],
    overrides: &Overrides,
    used: &mut Vec<&'a str>,
    findings: &mut Vec<Finding>,
) -> Result<Option<[Vec<GnssFix>; 3]>, OpenError> {
    let there: Vec<&Source> = sources.iter().filter(|s| s.format == Format::RtklibPos).collect();
    let chosen: Vec<&Source> = match &overrides.gnss {
        None => there,
        Some(names) => names
            .iter()
            .map(|name| {
                there.iter().find(|s| s.file == *name).copied().ok_or_else(|| {
                    OpenError::file(
                        "deployment.toml",
                        format!("gnss names `{name}`, which is no RTKLIB solution file here"),
                        "give names relative to the folder",
                    )
                })
            })
            .collect::<Result<_, _>>()?,
    };
    let repeated =
        (1..chosen.len()).any(|i| chosen[..i].iter().any(|earlier| earlier.file == chosen[i].file));
    if repeated {
        return Err(OpenError::file(
            "deployment.toml",
            "gnss names a file twice",
            "each antenna has a file of its own",
        ));
    }
    let three: [&Source; 3] = match chosen.try_into() {
        Ok(three) => three,
        Err(others) => {
            if !others.is_empty() {
                findings.push(Finding::warning(format!(
                    "{} GNSS solution file(s) left out: three antennas are needed; name them in deployment.toml: \
                     gnss = [\"…\", \"…\", \"…\"]",
                    others.len()
                )));
            }
            return Ok(None);
        }
    };
    let mut antennas: [Vec<GnssFix>; 3] = Default::default();
    for (antenna, source) in antennas.iter_mut().zip(three) {
        let (fixes, said) = format::rtklib_pos::read(&source.file, &source.text()?)?;
        *antenna = fixes;
        findings.extend(said);
        used.push(&source.file);
    }
    // Coordinates about a base station are short, those about the Earth's centre are not.
    let about_the_earth =
        |fixes: &Vec<GnssFix>| fixes.first().is_some_and(|f| f.position_m.norm() > 1e6);
    if !antennas.iter().all(|fixes| about_the_earth(fixes) == about_the_earth(&antennas[0])) {
        findings.push(Finding::warning(
            "the GNSS antennas are left out: some positions are about the Earth's centre, others about a base station; \
             solve them with the same settings",
        ));
        return Ok(None);
    }
    Ok(Some(antennas))
}
