//! Accessibility: every usable widget has a name for screen readers, and is reachable with Tab.

use egui::accesskit::{Action, Node, Role};
use egui::{Key, Modifiers, Theme};
use egui_kittest::kittest::{NodeT, Queryable};
use resect::app::{
    Command, DeploymentCommand, DialogCommand, LayoutPreset, Pane, WorkspaceCommand,
};

use crate::harness::{LARGE, Window, press, send, window};

/// Returns roles and positions of clickable or movable widgets without a name.
fn nameless(harness: &Window) -> Vec<String> {
    fn visit<'a>(node: &egui_kittest::Node<'a>, into: &mut Vec<String>) {
        let known = node.accesskit_node();
        let data: &Node = known.data();
        let used = data.supports_action(Action::Click) || data.supports_action(Action::Increment);
        // Texts, backgrounds of panes and the handles of their edges need no name.
        let passive = [Role::Label, Role::ScrollBar, Role::ScrollView, Role::Unknown];
        let is_widget = used && !passive.contains(&known.role());
        let named = known.label().is_some_and(|name| !name.trim().is_empty());
        if is_widget && !named && !known.is_hidden() {
            into.push(format!("{:?} at {:?}", known.role(), node.rect()));
        }
        for child in node.children() {
            visit(&child, into);
        }
    }
    let mut found = Vec::new();
    visit(&harness.root(), &mut found);
    found
}

#[test]
fn whatever_can_be_used_has_a_name() {
    let mut harness = window(LARGE, Theme::Dark);
    for preset in LayoutPreset::ALL {
        send(&mut harness, WorkspaceCommand::UseLayout(preset));
        assert_eq!(nameless(&harness), [""; 0], "{preset:?}");
    }
    send(&mut harness, WorkspaceCommand::ResetLayout);
    for pane in Pane::ALL {
        send(&mut harness, WorkspaceCommand::ShowPane(pane));
        assert_eq!(nameless(&harness), [""; 0], "{pane:?}");
    }
    for overlay in [
        Command::Dialog(DialogCommand::ShowPalette),
        Command::Dialog(DialogCommand::ShowShortcuts),
        Command::Dialog(DialogCommand::Explain),
        Command::Deployment(DeploymentCommand::OpenFileDialog),
    ] {
        send(&mut harness, overlay.clone());
        assert_eq!(nameless(&harness), [""; 0], "{overlay:?}");
        press(&mut harness, Modifiers::NONE, Key::Escape);
    }
}

/// From widget to widget until the first comes again: the scene, a threshold, a plot and a button of the result must be among them.
#[test]
fn tab_reaches_the_widgets() {
    let mut harness = window(LARGE, Theme::Dark);
    let mut reached: Vec<String> = Vec::new();
    for _ in 0..200 {
        harness.key_press(Key::Tab);
        harness.run_steps(2);
        let focused = harness.query_all_by(|node| node.is_focused() && node.label().is_some());
        let name = focused.last().and_then(|node| node.accesskit_node().label());
        let name = name.unwrap_or_default();
        if reached.first() == Some(&name) && reached.len() > 20 {
            break;
        }
        reached.push(name);
    }
    for wanted in ["Scene", "τ_r  range", "Pin", "Time cursor", "Play (Space)", "Colour by", "File"]
    {
        assert!(reached.iter().any(|name| name == wanted), "{wanted} in {reached:?}");
    }
}
