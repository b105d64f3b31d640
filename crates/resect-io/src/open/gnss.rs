//! Assignment of solution files to GNSS antennas.

use super::found::{FoundFile, Standing};
use super::reading::Reading;
use crate::error::OpenError;
use crate::findings::tracks::{gnss_antennas_missing, gnss_origins_differ};
use crate::format;
use crate::format::Format;
use resect_core::deployment::GnssFix;

/// Reads the solutions of antennas 1, 2, 3: the files named by the user or `deployment.toml`, otherwise the only three, by name.
pub fn read_gnss(reading: &mut Reading<'_, '_>) -> Result<Option<[Vec<GnssFix>; 3]>, OpenError> {
    let Reading { files, overrides, progress, used, findings, .. } = reading;
    let there: Vec<&FoundFile> = files.iter().filter(|f| f.serves_as(Format::RtklibPos)).collect();
    let named = there.iter().any(|f| f.standing == Standing::Named);
    let chosen: Vec<&FoundFile> = match &overrides.gnss {
        Some(names) if !named => names
            .iter()
            .map(|name| {
                there.iter().find(|f| f.file == *name).copied().ok_or_else(|| {
                    OpenError::file(
                        "deployment.toml",
                        format!("gnss names `{name}`, which is not an RTKLIB solution file here"),
                        "give names relative to the folder",
                    )
                })
            })
            .collect::<Result<_, _>>()?,
        _ => there,
    };
    let repeated =
        (1..chosen.len()).any(|i| chosen[..i].iter().any(|earlier| earlier.file == chosen[i].file));
    if repeated {
        return Err(OpenError::file(
            "deployment.toml",
            "gnss names a file twice",
            "each antenna needs its own file",
        ));
    }
    let three: [&FoundFile; 3] = match chosen.try_into() {
        Ok(three) => three,
        Err(others) => {
            if !others.is_empty() {
                findings.push(gnss_antennas_missing(others.len()));
            }
            return Ok(None);
        }
    };
    let mut antennas: [Vec<GnssFix>; 3] = Default::default();
    for (antenna, file) in antennas.iter_mut().zip(three) {
        let (fixes, said) = format::rtklib_pos::read(&file.file, &file.text(progress)?)?;
        *antenna = fixes;
        findings.extend(said);
        used.push(&file.file);
    }
    // Coordinates relative to a base station are short, those relative to the Earth's centre are not.
    let about_the_earth =
        |fixes: &Vec<GnssFix>| fixes.first().is_some_and(|f| f.position_m.norm() > 1e6);
    if !antennas.iter().all(|fixes| about_the_earth(fixes) == about_the_earth(&antennas[0])) {
        findings.push(gnss_origins_differ());
        return Ok(None);
    }
    Ok(Some(antennas))
}
