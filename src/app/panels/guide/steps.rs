//! What the guide says, step by step: plain data. Buttons are entries of the menus, by their names there.

use crate::app::actions::Menu;
use crate::app::actions::Menu::{Edit, Export, File, View};

/// A step on the way from readings to an answer that is trusted.
pub struct Step {
    pub title: &'static str,
    pub parts: &'static [Part],
}

pub enum Part {
    /// A paragraph.
    Say(&'static str),
    /// Buttons that do what the paragraph above says.
    Do(&'static [(Menu, &'static str)]),
    /// What is open now.
    Open,
    /// The present verdict, with its doubts and what to drive next.
    Verdict,
    /// What each doubt means.
    Doubts,
    /// The command that repeats the present answer.
    Headless,
}

use Part::{Do, Doubts, Headless, Open, Say, Verdict};

pub const STEPS: [Step; 5] = [
    Step {
        title: "Open your data",
        parts: &[
            Say(
                "Drop a deployment's folder on the window, or open it here: bags of ROS 1 or ROS 2, or tables of polar \
                 readings. Control points, rig and GNSS beside the tracks are found by what is in them. What no file tells, \
                 such as columns or topics, the window asks once.",
            ),
            Do(&[
                (File, "Open folder…"),
                (File, "Open bag or CSV…"),
                (File, "Sample: Warthog on uneven ground"),
            ]),
            Open,
        ],
    },
    Step {
        title: "Is it right?",
        parts: &[
            Say(
                "Look at the data before you tune it. Findings has what the readers noticed. Under Put right, Deployment \
                 corrects a prism constant, exchanged stations, inter-prism distances or the sense of azimuth; each \
                 correction can be taken back.",
            ),
            Do(&[(View, "Findings"), (View, "Deployment")]),
            Say(
                "Gaps: only what all three stations saw counts. Intervals shows who was silent when, and which spans are \
                 left.",
            ),
            Do(&[(View, "Intervals")]),
            Say(
                "Clocks: a millisecond between stations is a millimetre at 1 m/s. The joint estimate finds offsets and \
                 drifts by itself. A jump no offset puts right: drag over the times before or after it, and use only those.",
            ),
            Do(&[(View, "Clocks"), (Edit, "Use only the selected times"), (Edit, "Use all times")]),
            Say(
                "One reading looks wrong? Click it in the scene: Reading says what became of it and why, and can leave it \
                 out.",
            ),
            Do(&[(View, "Reading")]),
        ],
    },
    Step {
        title: "Tune",
        parts: &[
            Say(
                "The thresholds start as in the paper. Set τ_r to the top speed of your vehicle. Where Rates shows that τ_a \
                 or τ_e cuts real turns near a station, raise it; where Intervals shows that τ_s loses much of the drive, \
                 raise that, a little. Each change is solved at once and can be undone.",
            ),
            Do(&[(View, "Layout: Tune"), (View, "Rates"), (Edit, "Reset to the defaults")]),
            Say(
                "Pin a result, and later ones are seen against it, in σ. Changes below 1 σ do not matter: stop tuning there.",
            ),
            Do(&[(Edit, "Pin the result"), (View, "Runs")]),
            Say("To see what a threshold does to the errors over its whole range, run a study."),
            Do(&[(View, "Studies")]),
        ],
    },
    Step {
        title: "Trust it?",
        parts: &[
            Verdict,
            Say(
                "Good: every direction is held, and nothing speaks against it. Not independently checked: nothing that it does \
                 not rest on confirms it; three or more control points that every station measured would. Weak: an answer with a \
                 large σ, or with a doubt. Ambiguous: one of two answers, and nothing decides. Degenerate: the drive leaves \
                 a direction free; use it for nothing.",
            ),
            Say(
                "A small inter-prism error alone proves nothing: method D makes it small itself. Look for trends in the distance \
                 errors over time, and compare the methods.",
            ),
            Do(&[(View, "Result"), (View, "Distance errors over time"), (View, "Side by side")]),
            Doubts,
        ],
    },
    Step {
        title: "Save and repeat",
        parts: &[
            Say(
                "A session keeps all that is open, with settings, view and pinned results. The report is one page to keep with the \
                 run.",
            ),
            Do(&[(File, "Save session"), (Export, "Report (HTML)…"), (Export, "Trajectory…")]),
            Say("The same answer without a window, for scripts:"),
            Headless,
            Say(
                "When the stations stay, hold the calibration against the next run: resect validate tells whether it still \
                 holds, and which station moved.",
            ),
        ],
    },
];
