use super::*;

struct Desk {
    folder: tempfile::TempDir,
    prompt: PathPrompt,
}

impl Desk {
    fn new(wanted: Wanted) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        std::fs::create_dir_all(folder.path().join("field/day 1")).expect("writable");
        let tracks = "timestamp,id,distance,ha,va\n0.0,1,10,0.1,1.5\n";
        std::fs::write(folder.path().join("field/tracks.csv"), tracks).expect("writable");
        std::fs::write(folder.path().join("field/notes.txt"), "rain\n").expect("writable");
        std::fs::write(folder.path().join("field/.hidden"), "").expect("writable");
        let question = Question::new("Open", wanted);
        let (prompt, step) = PathPrompt::new(question, folder.path().join("field"), vec![]);
        let mut desk = Self { folder, prompt };
        desk.follow(step);
        desk
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Reads the folder that a step requests.
    fn follow(&mut self, step: PromptStep) -> PromptStep {
        if let PromptStep::Read(folder) = &step {
            assert!(self.prompt.is_reading());
            self.prompt.take(Listing::read(folder));
        }
        step
    }

    fn handle(&mut self, command: PromptCommand) -> PromptStep {
        let step = self.prompt.handle(command);
        self.follow(step)
    }

    fn enter(&mut self, text: &str) -> PromptStep {
        self.handle(PromptCommand::Type(text.to_owned()));
        self.handle(PromptCommand::Accept)
    }

    fn names(&self) -> Vec<(&str, &str)> {
        self.prompt.shown().iter().map(|e| (e.name.as_str(), e.what)).collect()
    }
}

#[test]
fn folders_come_first_and_files_say_what_they_are() {
    let mut desk = Desk::new(Wanted::ToOpen { folder: true });
    assert_eq!(desk.names(), [("day 1", ""), ("notes.txt", ""), ("tracks.csv", "deployment")]);
    let text = desk.prompt.text.clone();
    desk.handle(PromptCommand::Type(format!("{text}TRACK")));
    assert_eq!(desk.names(), [("tracks.csv", "deployment")]);
    // Accepts the only remaining entry.
    let tracks = desk.path("field/tracks.csv");
    assert_eq!(desk.handle(PromptCommand::Accept), PromptStep::Chosen(tracks));
    desk.handle(PromptCommand::Type(format!("{text}.h")));
    assert_eq!(desk.names(), [(".hidden", "")]);
}

#[test]
fn a_folder_is_entered_and_then_taken() {
    let mut desk = Desk::new(Wanted::ToOpen { folder: true });
    let day = desk.path("field/day 1");
    desk.handle(PromptCommand::Choose(Some(0)));
    assert_eq!(desk.handle(PromptCommand::Accept), PromptStep::Read(day.clone()));
    assert_eq!(desk.handle(PromptCommand::Accept), PromptStep::Chosen(day));
    desk.handle(PromptCommand::GoUp);
    desk.handle(PromptCommand::GoUp);
    assert_eq!(desk.prompt.folder(), desk.folder.path());
    // Relative to the folder shown, as in a shell.
    let field = desk.path("field");
    assert_eq!(desk.enter("field"), PromptStep::Read(field));
    assert_eq!(desk.enter("nowhere/x"), PromptStep::Stay);
    assert!(desk.prompt.trouble().is_some_and(|why| why.contains("nowhere/x")));
}

#[test]
fn a_path_without_a_root_is_followed_as_it_is_typed() {
    let mut desk = Desk::new(Wanted::ToOpen { folder: true });
    desk.handle(PromptCommand::GoUp);
    let step = desk.handle(PromptCommand::Type("field/".to_owned()));
    assert_eq!(step, PromptStep::Read(desk.path("field")));
    assert_eq!(desk.names(), [("day 1", ""), ("notes.txt", ""), ("tracks.csv", "deployment")]);
    desk.handle(PromptCommand::Type("field/tr".to_owned()));
    assert_eq!(desk.names(), [("tracks.csv", "deployment")]);
    assert_eq!(desk.enter("field/day 1/"), PromptStep::Chosen(desk.path("field/day 1")));
    // After deletion of the text, the folder remains, and the next path is relative to it.
    desk.handle(PromptCommand::Type(String::new()));
    assert_eq!(desk.prompt.folder(), desk.path("field/day 1"));
    assert_eq!(desk.enter("../tr"), PromptStep::Chosen(desk.path("field/day 1/../tracks.csv")));
}

#[test]
fn a_file_that_is_there_is_not_replaced_unasked() {
    let mut desk = Desk::new(new_file());
    let fresh = desk.path("field/run.html");
    assert_eq!(desk.handle(PromptCommand::Accept), PromptStep::Chosen(fresh));
    let notes = desk.path("field/notes.txt");
    let typed = notes.display().to_string();
    assert_eq!(desk.enter(&typed), PromptStep::Stay);
    assert_eq!(desk.prompt.overwrite.as_ref(), Some(&notes));
    desk.handle(PromptCommand::KeepFile);
    assert_eq!(desk.prompt.overwrite, None);
    desk.handle(PromptCommand::Accept);
    assert_eq!(desk.handle(PromptCommand::Replace), PromptStep::Chosen(notes));
    // A new folder is made; a file is none.
    let inside = desk.path("new/folder/x.html");
    let typed = inside.display().to_string();
    assert_eq!(desk.enter(&typed), PromptStep::Chosen(inside.clone()));
    assert!(inside.parent().is_some_and(Path::is_dir));
    let nowhere = desk.path("field/notes.txt/x.html").display().to_string();
    assert_eq!(desk.enter(&nowhere), PromptStep::Stay);
    assert!(desk.prompt.trouble().is_some_and(|why| why.contains("no folder for it")));
}

#[test]
fn a_folder_is_made_where_something_is_saved() {
    let mut desk = Desk::new(new_file());
    let typed = desk.path("field/other.html").display().to_string();
    desk.handle(PromptCommand::Type(typed));
    for (name, said) in
        [("", "Type a name"), ("day 1", "exists"), ("a/b", "one folder"), ("..", "one")]
    {
        desk.handle(PromptCommand::NameFolder(name.to_owned()));
        assert_eq!(desk.handle(PromptCommand::MakeFolder), PromptStep::Stay);
        let complaint = desk.prompt.complaint.clone().expect("refused");
        assert!(complaint.contains(said) && complaint.lines().count() == 1, "{complaint}");
    }
    let made = desk.path("field/day 2");
    desk.handle(PromptCommand::NameFolder(" day 2 ".to_owned()));
    assert_eq!(desk.handle(PromptCommand::MakeFolder), PromptStep::Read(made.clone()));
    assert!(made.is_dir());
    // The file name typed before remains.
    let chosen = PromptStep::Chosen(made.join("other.html"));
    assert_eq!(desk.handle(PromptCommand::Accept), chosen);
}

#[test]
fn what_was_read_too_late_is_dropped() {
    let mut desk = Desk::new(Wanted::Folder);
    assert_eq!(desk.names(), [("day 1", "")], "only folders can be written into");
    let old = Listing::read(&desk.path("field"));
    assert!(matches!(desk.prompt.handle(PromptCommand::GoUp), PromptStep::Read(_)));
    desk.prompt.take(old);
    assert!(desk.prompt.is_reading());
}

/// A report to write.
fn new_file() -> Wanted {
    Wanted::NewFile { name: "run.html".to_owned(), extension: "html".to_owned() }
}

#[test]
fn a_name_without_an_ending_gets_one_and_another_ending_stays() {
    let mut desk = Desk::new(new_file());
    for (typed, file) in [("field/day", "field/day.html"), ("field/day.htm", "field/day.htm")] {
        let typed = desk.path(typed).display().to_string();
        assert_eq!(desk.enter(&typed), PromptStep::Chosen(desk.path(file)));
    }
    // An existing file of the completed name is not replaced without asking either.
    std::fs::write(desk.path("field/day.html"), "old").expect("written");
    let typed = desk.path("field/day").display().to_string();
    assert_eq!(desk.enter(&typed), PromptStep::Stay);
    assert_eq!(desk.prompt.overwrite, Some(desk.path("field/day.html")));
}
