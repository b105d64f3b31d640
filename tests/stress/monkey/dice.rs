//! Choice of the monkey's next act, drawn from its seed and the number of the act, among the widgets in the window.

use std::path::PathBuf;

use egui::{Key, Modifiers, PointerButton, Pos2, Rect, Theme, Vec2};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use resect::app::{
    Command, DeploymentCommand, Picked, ResultsCommand, SessionCommand, StudyKind, StudyOptions,
    TimeCommand, actions,
};

use super::act::Act;
use super::screen::Screen;

/// Menu entries that are excluded, because they start another program.
pub const LEFT_OUT: [&str; 1] = ["Open in Rerun"];

const TEXTS: [&str; 22] = [
    "1.5",
    "0",
    "-1",
    "1e308",
    "1e-320",
    "NaN",
    "inf",
    "3.14159265358979",
    "1,5",
    "1.5 m",
    "",
    " ",
    "٣",
    "τ_s",
    "👩‍🚀",
    "a\u{0301}",
    "\u{202e}abc",
    "<b>&\"'",
    "\t",
    "../..",
    "open",
    "0.1 0.2 0.3",
];

/// Keys with a function, each as likely as all others together.
const USUAL_KEYS: [Key; 18] = [
    Key::Tab,
    Key::Enter,
    Key::Escape,
    Key::Space,
    Key::Backspace,
    Key::Delete,
    Key::ArrowLeft,
    Key::ArrowRight,
    Key::ArrowUp,
    Key::ArrowDown,
    Key::Home,
    Key::End,
    Key::PageUp,
    Key::PageDown,
    Key::F1,
    Key::Z,
    Key::A,
    Key::P,
];

pub struct Dice(ChaCha8Rng);

impl Dice {
    /// Returns the dice for an act by its number: the draws of one act do not change those of later ones.
    pub fn of(seed: u64, act: usize) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(act as u64);
        Self(rng)
    }

    fn below(&mut self, count: usize) -> usize {
        self.0.random_range(0..count.max(1))
    }

    pub fn chance(&mut self, of_one: f64) -> bool {
        self.0.random_bool(of_one)
    }

    fn between(&mut self, from: f32, to: f32) -> f32 {
        self.0.random_range(from..to)
    }

    fn one_of<T: Clone>(&mut self, all: &[T]) -> Option<T> {
        let at = self.below(all.len());
        all.get(at).cloned()
    }

    pub fn act(&mut self, screen: &Screen, things: &[PathBuf]) -> Act {
        match self.below(1000) {
            0..280 => Act::Click {
                at: self.target(screen),
                button: self.button(),
                modifiers: self.modifiers(0.9),
                times: 1,
            },
            280..320 => Act::Click {
                at: self.target(screen),
                button: PointerButton::Primary,
                modifiers: self.modifiers(0.9),
                times: 2 + usize::from(self.chance(0.2)),
            },
            320..440 => self.drag(screen),
            440..510 => Act::Wheel {
                at: self.target(screen),
                delta: Vec2::new(self.between(-3.0, 3.0), self.between(-300.0, 300.0)),
                modifiers: self.modifiers(0.6),
            },
            510..520 => Act::Pinch { at: self.target(screen), factor: self.between(0.3, 3.0) },
            520..530 => Act::PointerGone,
            530..570 => Act::Move(self.target(screen)),
            570..670 => self.key(),
            670..720 => self.text(screen, things),
            720..800 => self.entry(screen),
            800..860 => self.command(screen),
            860..885 => Act::Drop(self.some_of(things)),
            885..890 => Act::Hover(self.some_of(things)),
            890..905 => self.resize(),
            905..910 => Act::SystemTheme(if self.chance(0.5) { Theme::Dark } else { Theme::Light }),
            910..915 => Act::Focus(self.chance(0.5)),
            915..940 => {
                let each_s = if self.chance(0.5) { 0.016 } else { 1.0 };
                Act::Wait { frames: 1 + self.below(12), each_s }
            }
            940..965 => Act::Settle,
            965..972 => Act::CloseAll,
            972..980 => Act::SaveSession,
            980..986 => Act::ReopenSaved,
            986..996 => Act::Die,
            _ => Act::Exit,
        }
    }

    /// Returns a position, mostly on a widget; overlays are as likely as all the rest.
    fn target(&mut self, screen: &Screen) -> Pos2 {
        let size = screen.size();
        if self.chance(0.15) {
            // Sometimes outside.
            return Pos2::new(
                self.between(-20.0, size.x + 20.0),
                self.between(-20.0, size.y + 20.0),
            );
        }
        let (over, under): (Vec<_>, Vec<_>) = targets(screen).into_iter().partition(|it| it.0);
        let from = if self.chance(0.5) && !over.is_empty() { over } else { under };
        let Some((_, rect)) = self.one_of(&from) else { return Pos2::ZERO };
        if self.chance(0.5) {
            return rect.center();
        }
        rect.lerp_inside(Vec2::new(self.between(0.0, 1.0), self.between(0.0, 1.0)))
    }

    fn drag(&mut self, screen: &Screen) -> Act {
        let from = self.target(screen);
        let near = Vec2::new(self.between(-150.0, 150.0), self.between(-150.0, 150.0));
        let to = if self.chance(0.6) { from + near } else { self.target(screen) };
        let frames = 1 + self.below(4);
        Act::Drag { from, to, button: self.button(), modifiers: self.modifiers(0.8), frames }
    }

    fn button(&mut self) -> PointerButton {
        match self.below(20) {
            0..16 => PointerButton::Primary,
            16..19 => PointerButton::Secondary,
            _ => PointerButton::Middle,
        }
    }

    fn modifiers(&mut self, none: f64) -> Modifiers {
        if self.chance(none) {
            return Modifiers::NONE;
        }
        let several = [
            Modifiers::COMMAND | Modifiers::CTRL,
            Modifiers::SHIFT,
            Modifiers::ALT,
            Modifiers::COMMAND | Modifiers::CTRL | Modifiers::SHIFT,
        ];
        self.one_of(&several).unwrap_or_default()
    }

    fn key(&mut self) -> Act {
        let modifiers = self.modifiers(0.6);
        let keys = if self.chance(0.5) { &USUAL_KEYS[..] } else { Key::ALL };
        Act::Key(modifiers, self.one_of(keys).unwrap_or(Key::Escape))
    }

    fn text(&mut self, screen: &Screen, things: &[PathBuf]) -> Act {
        if screen.state().dialogs.prompt.is_some() && self.chance(0.7) {
            let path = self.one_of(things).unwrap_or_default();
            let new = path.join(format!("new-{}", self.below(5)));
            return Act::TypePath(if self.chance(0.5) { path } else { new });
        }
        let text = match self.below(12) {
            0 => "long ".repeat(600),
            1 => self.one_of(things).unwrap_or_default().display().to_string(),
            2 => return if self.chance(0.5) { Act::Copy } else { Act::Cut },
            _ => self.one_of(&TEXTS).unwrap_or_default().to_owned(),
        };
        if self.chance(0.2) { Act::Paste(text) } else { Act::Text(text) }
    }

    /// Returns an enabled menu entry.
    fn entry(&mut self, screen: &Screen) -> Act {
        let entries: Vec<_> = actions::all(screen.state())
            .into_iter()
            .filter(|action| !LEFT_OUT.contains(&action.name.as_str()))
            .filter_map(|action| Some((action.name, action.command?)))
            .collect();
        match self.one_of(&entries) {
            Some((name, command)) => Act::Entry(name, Box::new(command)),
            None => Act::Settle,
        }
    }

    fn some_of(&mut self, things: &[PathBuf]) -> Vec<PathBuf> {
        let count = if self.chance(0.8) { 1 } else { 1 + self.below(4) };
        (0..count).filter_map(|_| self.one_of(things)).collect()
    }

    fn resize(&mut self) -> Act {
        let sizes = [[300, 200], [480, 300], [800, 600], [1280, 800], [1920, 1080], [2560, 1440]];
        let anything = [300 + self.below(2261) as u32, 200 + self.below(1241) as u32];
        let pixels = if self.chance(0.5) { self.one_of(&sizes) } else { None };
        let scale = self.one_of(&[1.0, 1.0, 1.25, 1.5, 2.0]).unwrap_or(1.0);
        Act::Resize { pixels: pixels.unwrap_or(anything), scale }
    }

    /// Returns a command that is in no menu, with valid or outdated numbers.
    fn command(&mut self, screen: &Screen) -> Act {
        let state = screen.state();
        let open: Vec<u64> = state.deployments.open.iter().map(|open| open.id).collect();
        let open = self.one_of(&open).unwrap_or(self.below(9) as u64);
        let pins: Vec<u64> = state.results.pins.iter().map(|pin| pin.id).collect();
        let pin = self.one_of(&pins).unwrap_or(self.below(9) as u64);
        let runs: Vec<u64> = state.results.runs.iter().map(|run| run.id).collect();
        let run = self.one_of(&runs).unwrap_or(self.below(9) as u64);
        let times_s = [self.time_s(screen), self.time_s(screen)];
        let picked = Picked { station: self.below(4), index: self.below(4000) };
        Act::Send(Box::new(match self.below(24) {
            0 | 1 => Command::Deployment(DeploymentCommand::Close(open)),
            2 | 3 => Command::Deployment(DeploymentCommand::Activate(open)),
            4 => Command::Deployment(DeploymentCommand::CancelAnalysis(open)),
            5 => Command::Deployment(DeploymentCommand::CancelOpening(self.below(50) as u64)),
            6 => Command::Results(ResultsCommand::Unpin(pin)),
            7 => Command::Results(ResultsCommand::ShowPin(pin, self.chance(0.5))),
            8 => Command::Results(ResultsCommand::UsePinned(pin)),
            9 => Command::Results(ResultsCommand::PinRun(run)),
            10 => Command::Results(ResultsCommand::RestoreRun(run)),
            11 => Command::Session(SessionCommand::ForgetMissing(self.below(3))),
            12 => Command::Time(TimeCommand::MoveCursor(times_s[0])),
            13 => Command::Time(TimeCommand::ShowTimes(times_s)),
            14 => Command::Time(TimeCommand::Select(Some(times_s))),
            15 => Command::Time(TimeCommand::LookAtTimes(times_s)),
            16 => Command::Time(TimeCommand::PickInScene(picked)),
            17 => Command::Time(TimeCommand::PickInPlot(picked)),
            18 => Command::Time(TimeCommand::StepCursor(self.0.random())),
            19 => Command::Results(ResultsCommand::SetStudy(
                self.study(state.results.studies.options),
            )),
            20 | 21 => Command::Results(ResultsCommand::RunStudy),
            22 => Command::Results(ResultsCommand::CancelStudy),
            _ => Command::Results(ResultsCommand::SaveStudyDialog),
        }))
    }

    fn study(&mut self, now: StudyOptions) -> StudyOptions {
        let kind = self.one_of(&StudyKind::ALL).unwrap_or(now.kind);
        let mut options = StudyOptions { kind, all_open: self.chance(0.5), ..now };
        options.split = self.chance(0.3);
        options.splits.repeats = 1 + self.below(3);
        options.sweep.steps = 1 + self.below(4);
        options
    }

    /// Returns a time of the active deployment, or one outside of it.
    fn time_s(&mut self, screen: &Screen) -> f64 {
        let whole_s = screen.state().active().map_or([0.0; 2], |open| open.timeline.whole_s);
        let at = f64::from(self.between(-0.2, 1.2));
        let usual = whole_s[0] + at * (whole_s[1] - whole_s[0]);
        let odd = [0.0, f64::NAN, f64::INFINITY, -1e300, whole_s[0], whole_s[1]];
        if self.chance(0.8) { usual } else { self.one_of(&odd).unwrap_or(usual) }
    }
}

/// Returns the rectangles of clickable and draggable widgets, each with true if it lies over the panes.
fn targets(screen: &Screen) -> Vec<(bool, Rect)> {
    let whole = Rect::from_min_size(Pos2::ZERO, screen.size());
    let mut targets: Vec<(bool, Rect)> = screen.ctx().viewport(|viewport| {
        let widgets = &viewport.prev_pass.widgets;
        let layers = widgets.layers().flat_map(|(_, of_layer)| of_layer);
        layers
            .filter(|widget| widget.enabled && widget.sense.interactive())
            .map(|widget| {
                let over = widget.layer_id.order != egui::Order::Background;
                (over, widget.interact_rect.intersect(whole))
            })
            .filter(|(_, rect)| rect.is_positive())
            .collect()
    });
    // The order of layers is undefined.
    let key = |rect: &Rect| [rect.min.y, rect.min.x, rect.max.y, rect.max.x];
    targets.sort_by(|a, b| {
        let by_place = key(&a.1).into_iter().zip(key(&b.1)).map(|(a, b)| a.total_cmp(&b));
        a.0.cmp(&b.0).then(by_place.fold(std::cmp::Ordering::Equal, std::cmp::Ordering::then))
    });
    targets
}
