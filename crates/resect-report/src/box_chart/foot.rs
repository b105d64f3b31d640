//! Text below a box chart: names and notes of the groups in their slots, axis title, caption, findings.

use super::sizes::{LABEL, SMALL};
use crate::drawing::{Anchor, Ink, Mark, text_width, wrap};
use resect_core::deployment::Finding;
use resect_tools::experiment::Study;

const LABEL_LINE: f32 = 1.25 * LABEL;
const SMALL_LINE: f32 = 1.25 * SMALL;
/// Space between the axis and the groups' names, for a median's number right at the axis.
const GAP: f32 = 8.0;

pub struct Foot {
    groups: Vec<GroupText>,
    upwards: bool,
    /// Interval of groups with a name, if even upright names would overlap.
    every: usize,
    /// Height of the tallest name with its note.
    depth: f32,
    title: Vec<String>,
    caption: Vec<String>,
    /// Findings of the study, in full ink.
    remarks: Vec<String>,
}

/// Text at the bottom.
pub struct FootText<'a> {
    pub caption: String,
    pub findings: &'a [Finding],
}

struct GroupText {
    label: Vec<String>,
    note: Vec<String>,
}

impl Foot {
    /// Lays names out horizontally if all of them fit their slots, otherwise upwards.
    pub fn of(chart: &Study, text: &FootText<'_>, slot: f32, [width, height]: [f32; 2]) -> Self {
        let level = |text: &str, size: f32| {
            let lines = wrap(text, size, slot - 6.0, 3);
            let whole = lines.iter().all(|line| !line.contains('…') && !line.is_empty());
            whole.then_some(lines)
        };
        let labels: Option<Vec<_>> =
            chart.groups.iter().map(|group| level(&group.label, LABEL)).collect();
        let notes: Option<Vec<_>> =
            chart.groups.iter().map(|group| level(&group.note, SMALL)).collect();
        let upwards = labels.is_none();
        let longest = 0.26 * height;
        let abreast = ((slot / LABEL_LINE) as usize).clamp(1, 3);
        let labels = labels.unwrap_or_else(|| {
            chart.groups.iter().map(|group| wrap(&group.label, LABEL, longest, abreast)).collect()
        });
        // An upright name leaves no room for a note; the caption has the number of values.
        let notes =
            notes.filter(|_| !upwards).unwrap_or_else(|| vec![Vec::new(); chart.groups.len()]);
        let groups: Vec<GroupText> =
            labels.into_iter().zip(notes).map(|(label, note)| GroupText { label, note }).collect();
        let depth = |group: &GroupText| {
            if upwards {
                return group.label.iter().map(|line| text_width(line, LABEL)).fold(0.0, f32::max);
            }
            LABEL_LINE * group.label.len() as f32 + SMALL_LINE * group.note.len() as f32
        };
        Self {
            depth: groups.iter().map(depth).fold(0.0, f32::max),
            groups,
            upwards,
            every: if upwards { (LABEL_LINE / slot).ceil() as usize } else { 1 },
            title: wrap(&chart.group_label, LABEL, width - 24.0, 1),
            caption: wrap(&text.caption, SMALL, width - 24.0, 3),
            remarks: remarks(text.findings, width, height),
        }
    }

    pub fn height(&self) -> f32 {
        GAP + self.depth
            + self.title.len() as f32 * (LABEL_LINE + 4.0)
            + (self.caption.len() + self.remarks.len()) as f32 * SMALL_LINE
            + 16.0
    }

    /// Draws the foot. `left` and `right` are the ends of the axis, `top` its height; `aside` is the offset of names
    /// from the middles of their groups.
    pub fn draw(
        &self,
        [left, right]: [f32; 2],
        aside: f32,
        top: f32,
        width: f32,
        marks: &mut Vec<Mark>,
    ) {
        let slot = (right - left) / self.groups.len().max(1) as f32;
        for (index, group) in self.groups.iter().enumerate().step_by(self.every) {
            let x = left + slot * (index as f32 + 0.5) + aside;
            if self.upwards {
                let first = x - 0.5 * LABEL_LINE * (group.label.len() as f32 - 1.0);
                for (index, line) in group.label.iter().enumerate() {
                    let at = [first + LABEL_LINE * index as f32, top + GAP];
                    marks.push(Mark::upwards(at, line, LABEL, Ink::Text, Anchor::Right));
                }
                continue;
            }
            let mut y = top + GAP + 0.5 * LABEL_LINE;
            for line in &group.label {
                marks.push(Mark::text([x, y], line, LABEL, Ink::Text, Anchor::Middle));
                y += LABEL_LINE;
            }
            y += 0.5 * (SMALL_LINE - LABEL_LINE);
            for line in &group.note {
                marks.push(Mark::text([x, y], line, SMALL, Ink::Weak, Anchor::Middle));
                y += SMALL_LINE;
            }
        }
        let mut y = top + GAP + self.depth + 4.0 + 0.5 * LABEL_LINE;
        for line in &self.title {
            // Centred on the axis if the canvas is wide enough.
            let half = 0.5 * text_width(line, LABEL);
            let x = (0.5 * (left + right)).min(width - 12.0 - half).max(12.0 + half);
            marks.push(Mark::text([x, y], line, LABEL, Ink::Text, Anchor::Middle));
            y += LABEL_LINE + 4.0;
        }
        y += 4.0;
        let captions = self.caption.iter().map(|line| (line, Ink::Weak));
        for (line, ink) in captions.chain(self.remarks.iter().map(|line| (line, Ink::Text))) {
            marks.push(Mark::text([12.0, y], line, SMALL, ink, Anchor::Left));
            y += SMALL_LINE;
        }
    }
}

/// Returns the study's findings, two lines each, in at most a sixth of the canvas; the last line counts the rest.
fn remarks(findings: &[Finding], width: f32, height: f32) -> Vec<String> {
    let room = (height / 6.0 / SMALL_LINE) as usize;
    let mut lines = Vec::new();
    for (index, finding) in findings.iter().enumerate() {
        let text = format!("{} {finding}", finding.severity.mark());
        let more = wrap(&text, SMALL, width - 24.0, 2);
        let left = findings.len() - index;
        let last = left == 1;
        if lines.len() + more.len() + usize::from(!last) > room {
            lines.push(format!("! {left} more findings in the table"));
            break;
        }
        lines.extend(more);
    }
    lines
}
