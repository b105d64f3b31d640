//! Writing of the corrections to the folder's own `deployment.toml`.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::State;
use crate::app::model::{Asked, AskedToml};
use resect_core::deployment::{Deployment, OneOrMany, Overrides};
use resect_io::atomic;
use resect_io::format::deployment_toml;
use resect_io::override_changes::override_changes;
use resect_io::source::{Extras, Source};
use resect_io::windows;

impl State {
    /// Prepares the new content of the file in the background.
    pub(super) fn propose_deployment_toml(&mut self) {
        let Some(open) = self.active() else { return };
        let Some(source) = open.source.clone() else { return };
        let (id, deployment) = (open.id, Arc::clone(&open.deployment));
        let number = self.jobs.start(
            move || propose(id, &source, &deployment).map(Box::new),
            Self::take_proposed_toml,
        );
        self.path_requests.push(number);
    }

    pub(super) fn take_proposed_toml(
        &mut self,
        number: u64,
        proposed: Result<Box<AskedToml>, String>,
    ) {
        self.path_requests.retain(|looking| *looking != number);
        match proposed {
            // Without an existing file nothing can be lost.
            Ok(proposed) if proposed.before.is_none() => self.write_deployment_toml(proposed),
            Ok(proposed) => self.ask_user(Asked::Toml(proposed), None),
            Err(line) => self.toasts.error(&line),
        }
    }

    pub(super) fn write_deployment_toml(&mut self, proposed: Box<AskedToml>) {
        let number =
            self.jobs.start(move || write(&proposed).map(|()| proposed), Self::take_written_toml);
        self.path_requests.push(number);
    }

    pub(super) fn take_written_toml(
        &mut self,
        number: u64,
        written: Result<Box<AskedToml>, String>,
    ) {
        self.path_requests.retain(|looking| *looking != number);
        let AskedToml { id, path, stays, .. } = match written {
            Ok(written) => *written,
            Err(line) => {
                self.toasts.error(&line);
                return;
            }
        };
        self.toasts.done(format!("{} written", path.display()));
        let source = self.deployments.get(id).and_then(|open| open.source.clone());
        if let Some(source) = source {
            self.deployments.undo.forget_extras(id);
            self.give_up_replacing(id);
            self.replace_by(id, source.with(stays), false);
        }
    }
}

fn propose(id: u64, source: &Source, deployment: &Deployment) -> Result<AskedToml, String> {
    let Some(path) = source.path() else {
        return Err(
            "a built-in sample has no folder; save the session to keep the corrections".to_owned()
        );
    };
    let folder = if path.is_dir() { path } else { path.parent().unwrap_or(Path::new(".")) };
    let folder =
        windows::canonical(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let path = folder.join("deployment.toml");
    let before = match std::fs::read_to_string(&path) {
        Ok(text) => Some(text),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => None,
        Err(error) => return Err(format!("{}: {error}; check its permissions", path.display())),
    };
    let sets: Vec<String> = deployment.control_points.iter().map(|set| set.file.clone()).collect();
    let (writes, stays) = into_folder(&source.extras, &deployment.as_read, &sets, &folder);
    let name = path.display().to_string();
    let after = deployment_toml::merge(&name, before.as_deref().unwrap_or_default(), &writes)
        .map_err(|error| error.to_string())?;
    let old = match &before {
        Some(text) => deployment_toml::read(&name, text).map_err(|error| error.to_string())?,
        None => Overrides::default(),
    };
    let said = override_changes(&old, &writes.over(old.clone()));
    let said = said.iter().map(ToString::to_string).collect();
    Ok(AskedToml { id, path, before, after, said, stays })
}

/// Splits extras into those that the folder's file can contain, and those that stay in the session: files outside the folder.
///
/// `sets` are the files of control points in use.
fn into_folder(
    extras: &Extras,
    as_read: &Overrides,
    sets: &[String],
    folder: &Path,
) -> (Overrides, Extras) {
    let mut writes = extras.corrections.clone();
    let mut stays = Extras { corrections: Overrides::default(), ..extras.clone() };
    let below = |path: &PathBuf| {
        let path = windows::canonical(path).ok()?;
        let name = windows::with_slashes(path.strip_prefix(folder).ok()?).to_str()?.to_owned();
        path.is_file().then_some(name)
    };
    if let Some(name) = extras.rig.as_ref().and_then(below) {
        writes.rig = Some(OneOrMany::One(name));
        stays.rig = None;
    }
    let named: Option<Vec<String>> = extras
        .gcp
        .iter()
        .map(|path| below(path).filter(|_| sets.contains(&path.display().to_string())))
        .collect();
    if let Some(named) = named.filter(|named| !named.is_empty()) {
        let listed = writes.control_points.take().or_else(|| as_read.control_points.clone());
        writes.control_points = match listed {
            _ if extras.gcp_instead => Some(named),
            Some(listed) => Some([listed, named].concat()),
            // All files in the folder are used anyway.
            None => None,
        };
        (stays.gcp, stays.gcp_instead) = (Vec::new(), false);
    }
    (writes, stays)
}

fn write(proposed: &AskedToml) -> Result<(), String> {
    let AskedToml { path, before, after, .. } = proposed;
    if std::fs::read_to_string(path).ok() != *before {
        return Err(format!("{} was changed in the meantime; write it again", path.display()));
    }
    atomic::write(path, after).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_of_the_folder_are_named_in_it_and_others_stay_in_the_session() {
        let folder = tempfile::tempdir().expect("a folder");
        let elsewhere = tempfile::tempdir().expect("a folder");
        let top = folder.path().canonicalize().expect("there");
        for path in [top.join("rig.csv"), top.join("a.txt"), elsewhere.path().join("b.txt")] {
            std::fs::write(path, "x").expect("written");
        }
        let extras = Extras {
            rig: Some(top.join("rig.csv")),
            gcp: vec![top.join("a.txt")],
            gcp_instead: true,
            ..Extras::default()
        };
        let sets = [top.join("a.txt").display().to_string()];
        let (writes, stays) = into_folder(&extras, &Overrides::default(), &sets, &top);
        assert_eq!(writes.rig, Some(OneOrMany::One("rig.csv".into())));
        assert_eq!(writes.control_points, Some(vec!["a.txt".to_owned()]));
        assert!(stays.is_empty());
        let outside = Extras {
            rig: Some(elsewhere.path().to_owned()),
            gcp: vec![elsewhere.path().join("b.txt")],
            ..Extras::default()
        };
        let (writes, stays) = into_folder(&outside, &Overrides::default(), &[], &top);
        assert!(writes.is_empty());
        assert_eq!(stays, outside);
    }
}
