//! Texts of the guide, step by step: plain data. Buttons are menu entries, identified by their names.

use crate::app::actions::Menu;
use crate::app::actions::Menu::{Edit, Export, File, View};

/// A step from readings to a trusted result.
pub struct GuideStep {
    pub title: &'static str,
    pub parts: &'static [Part],
}

pub enum Part {
    /// A paragraph.
    Say(&'static str),
    /// Buttons that do what the paragraph above says.
    Do(&'static [(Menu, &'static str)]),
    /// The data open now.
    Open,
    /// The present verdict, with its doubts and what to drive next.
    Verdict,
    /// Meaning of each doubt.
    Doubts,
    /// The command that repeats the present result.
    Headless,
}

use Part::{Do, Doubts, Headless, Open, Say, Verdict};

pub const STEPS: [GuideStep; 5] = [
    GuideStep {
        title: "Open your data",
        parts: &[
            Say(
                "Drop a deployment's folder on the window, or open it here: bags of ROS 1 or ROS 2, or tables of polar \
                 readings. Control points, rig and GNSS beside the tracks are recognised by their content. If the files do not \
                 give columns or topics, the window asks once.",
            ),
            Do(&[
                (File, "Open folder…"),
                (File, "Open bag or CSV…"),
                (File, "Sample: Warthog on uneven ground"),
            ]),
            Open,
        ],
    },
    GuideStep {
        title: "Is it right?",
        parts: &[
            Say(
                "Check the data before you tune. Findings lists problems found while reading. Corrections, in the Deployment \
                 pane, changes a prism constant, exchanged stations, inter-prism distances or the sense of azimuth. Each \
                 correction can be reset.",
            ),
            Do(&[(View, "Findings"), (View, "Deployment")]),
            Say(
                "Gaps: only times at which all stations measured are used. Intervals shows the gaps of each station \
                 and the spans that remain.",
            ),
            Do(&[(View, "Intervals")]),
            Say(
                "Clocks: a millisecond between stations is a millimetre at 1 m/s. The joint estimate includes offsets \
                 and drifts. An offset cannot correct a jump: drag over the times before or after it, and use only those.",
            ),
            Do(&[(View, "Clocks"), (Edit, "Use only the selected times"), (Edit, "Use all times")]),
            Say(
                "If a reading looks wrong, click it in the scene. Reading shows if it is used and why, and can leave it out.",
            ),
            Do(&[(View, "Reading")]),
        ],
    },
    GuideStep {
        title: "Tune",
        parts: &[
            Say(
                "The thresholds start as in the paper. Set τ_r to the top speed of your vehicle. If Rates shows that τ_a or \
                 τ_e rejects real turns near a station, raise it. If Intervals shows that τ_s loses much of the drive, raise it \
                 a little. Each change takes effect at once and can be undone.",
            ),
            Do(&[(View, "Layout: Tune"), (View, "Rates"), (Edit, "Reset to the defaults")]),
            Say(
                "Pin a result to compare later ones with it, in σ. Changes below 1 σ do not matter: stop tuning there.",
            ),
            Do(&[(Edit, "Pin the result"), (View, "Runs")]),
            Say("To see the errors over the whole range of a threshold, run a study."),
            Do(&[(View, "Studies")]),
        ],
    },
    GuideStep {
        title: "Trust it?",
        parts: &[
            Verdict,
            Say(
                "Good: every direction is observable, and no check contradicts the result. Not independently checked: no \
                 independent data confirm it; three or more control points that every station measured would. Weak: a \
                 large σ, or a warning. Ambiguous: two solutions, and the data do not decide between them. Degenerate: \
                 a direction is unobservable; do not use the result.",
            ),
            Say(
                "A small inter-prism error alone proves nothing: method D minimises it. Look for trends in the distance \
                 errors over time, and compare the methods.",
            ),
            Do(&[(View, "Result"), (View, "Distance errors over time"), (View, "Side by side")]),
            Doubts,
        ],
    },
    GuideStep {
        title: "Save and repeat",
        parts: &[
            Say(
                "A session stores all open data, settings, view and pinned results. The report is one page to keep with the \
                 run.",
            ),
            Do(&[(File, "Save session"), (Export, "Report (HTML)…"), (Export, "Trajectory…")]),
            Say("The same result without a window, for scripts:"),
            Headless,
            Say(
                "If the stations stay, test the calibration on the next run: resect validate reports if it is still valid, \
                 and which station moved.",
            ),
        ],
    },
];
