use crate::app::model::kinds;
use egui::Vec2;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::super::behaviour::SIMPLIFICATION;
use super::*;

fn layouts() -> Vec<(&'static str, Layout)> {
    let ready = LayoutPreset::ALL.map(|preset| (preset.title(), Layout::from(preset)));
    let mut all = vec![("first", Layout::default())];
    all.extend(ready);
    all
}

/// Draws a layout with the titles of its panes in place of their content.
struct Drawn {
    layout: Layout,
    /// Rectangles of the active panes in the last frame.
    places: HashMap<Pane, egui::Rect>,
}

fn drawn(layout: Layout, size: Vec2) -> Harness<'static, Drawn> {
    Harness::builder().with_size(size).build_ui_state(
        |ui, drawn: &mut Drawn| {
            drawn.places.clear();
            let Drawn { layout, places } = drawn;
            layout.ui(ui, &mut |pane, ui: &mut egui::Ui| {
                places.insert(pane, ui.max_rect());
            });
        },
        Drawn { layout, places: HashMap::new() },
    )
}

fn panes(layout: &Layout) -> Vec<Pane> {
    let mut panes = tree::node_of(&layout.tree, &HashMap::new()).map_or(vec![], |n| n.panes());
    panes.sort_by_key(|pane| *pane as usize);
    panes
}

/// Writes a layout to a file's text and reads it back.
fn reread(layout: &Layout) -> (Layout, Vec<Finding>) {
    let text = toml::to_string(&layout.describe()).expect("it can be written");
    let description: LayoutDescription = toml::from_str(&text).expect("it can be read");
    Layout::of_description(&description)
}

fn read(text: &str) -> (Layout, Vec<Finding>) {
    Layout::of_description(&toml::from_str(text).expect("the format"))
}

#[test]
fn every_pane_has_a_place_in_the_first_layout_or_in_a_preset_and_none_has_one_twice() {
    let presets = LayoutPreset::ALL.map(Layout::from);
    let placed: Vec<Pane> = presets.iter().chain([&Layout::default()]).flat_map(panes).collect();
    assert!(Pane::ALL.iter().all(|pane| placed.contains(pane)), "{placed:?}");
    for (name, layout) in layouts() {
        let (again, findings) = reread(&layout);
        assert_eq!(findings, [], "{name}");
        assert!(close(&again.describe().root, &layout.describe().root), "{name}");
    }
}

#[test]
fn lists_have_room_for_their_numbers_on_small_and_on_large_windows() {
    for (name, size) in [("small", [1100.0, 660.0]), ("large", [3840.0, 2120.0])] {
        for (title, layout) in layouts() {
            let mut harness = drawn(layout, Vec2::from(size));
            harness.run_steps(2);
            for (pane, least) in [
                (Pane::Deployment, 260.0),
                (Pane::Pipeline, 270.0),
                (Pane::Result, 340.0),
                (Pane::Runs, 340.0),
                (Pane::Scene, 340.0),
                (Pane::Rates, 280.0),
                (Pane::SideBySide, 600.0),
            ] {
                if let Some(size) = harness.state().places.get(&pane).map(egui::Rect::size) {
                    assert!(size.x >= least, "{title}, {name}: {pane:?} is {} wide", size.x);
                    assert!(size.y >= 110.0, "{title}, {name}: {pane:?} is {} high", size.y);
                }
            }
        }
    }
}

#[test]
fn sizes_follow_the_window_until_something_is_moved() {
    let mut harness = drawn(Layout::default(), Vec2::new(1600.0, 960.0));
    harness.run_steps(2);
    let width = |harness: &Harness<'_, Drawn>| harness.state().places[&Pane::Pipeline].width();
    let before = width(&harness);
    harness.set_size(Vec2::new(2000.0, 960.0));
    harness.run_steps(2);
    assert!((width(&harness) - before).abs() < 3.0, "{} for {before}", width(&harness));
    // Drags the border between the first two columns by 60 points to the right.
    let border = harness.state().places[&Pane::Pipeline].right_center() + egui::vec2(1.5, 0.0);
    harness.drag_at(border);
    harness.run_steps(2);
    harness.hover_at(border + egui::vec2(60.0, 0.0));
    harness.run_steps(2);
    harness.drop_at(border + egui::vec2(60.0, 0.0));
    harness.run_steps(2);
    let moved = width(&harness);
    assert!((moved - before - 60.0).abs() < 6.0, "{moved} for {before} + 60");
    let (again, _) = reread(&harness.state().layout);
    assert!(!again.follows_window);
    let mut harness = drawn(again, Vec2::new(2000.0, 960.0));
    harness.run_steps(2);
    assert!((width(&harness) - moved).abs() < 1.0, "{} for {moved}", width(&harness));
}

#[test]
fn a_closed_pane_comes_back_to_where_it_was() {
    for (name, layout) in layouts() {
        for pane in panes(&layout) {
            let mut layout = reread(&layout).0;
            let before = beside(&layout, pane);
            let tile = layout.tree.tiles.find_pane(&pane).expect("a pane");
            layout.tree.tiles.remove(tile);
            layout.tree.simplify(&SIMPLIFICATION);
            assert!(!layout.holds(pane));
            layout.preset = LayoutPreset::ALL.into_iter().find(|preset| preset.title() == name);
            layout.show(pane);
            layout.tree.simplify(&SIMPLIFICATION);
            assert!(layout.holds(pane), "{name}: {pane:?}");
            assert_eq!(beside(&layout, pane), before, "{name}: {pane:?} has other tabs beside it");
            let shown = layout.tree.active_tiles();
            let tile = layout.tree.tiles.find_pane(&pane).expect("a pane");
            assert!(shown.contains(&tile), "{name}: {pane:?} is not in front");
        }
    }
}

/// Returns all panes in the same tabs as a pane.
fn beside(layout: &Layout, pane: Pane) -> Vec<Pane> {
    let tiles = &layout.tree.tiles;
    let tile = tiles.find_pane(&pane).expect("a pane");
    let tabs = tiles.parent_of(tile).and_then(|tabs| tiles.get_container(tabs)).expect("tabs");
    let mut panes: Vec<Pane> =
        tabs.children().filter_map(|child| tiles.get_pane(child).copied()).collect();
    panes.sort_by_key(|pane| *pane as usize);
    panes
}

#[test]
fn tabs_are_closed_by_a_named_button_and_the_last_one_stays() {
    let mut harness = drawn(Layout::default(), Vec2::new(1600.0, 960.0));
    harness.run_steps(2);
    harness.get_by_label("Close Histogram").click();
    harness.run_steps(3);
    assert!(!harness.state().layout.holds(Pane::Histogram));
    assert!(harness.query_by_label("Close Findings").is_some(), "the next one is in front");
    for _ in 0..Pane::ALL.len() {
        if let Some(close) = harness.query_all_by_label_contains("Close ").next() {
            close.click();
        }
        harness.run_steps(3);
    }
    assert_eq!(panes(&harness.state().layout).len(), 1);
    assert!(harness.query_all_by_label_contains("Close ").next().is_none());
    harness.state_mut().layout.show(Pane::Pipeline);
    harness.run_steps(2);
    assert!(harness.state().places.contains_key(&Pane::Pipeline));
}

#[test]
fn an_error_in_a_file_is_corrected_and_reported() {
    let cases = [
        (
            "version = 1\n[root]\nrow = { shares = [nan, -1.0], children = [{ pane = \"scene\" }, { pane = \"result\" }] }",
            vec![Pane::Scene, Pane::Result],
            "has invalid sizes",
        ),
        (
            "version = 1\n[root]\ntabs = { active = -7, children = [{ pane = \"scene\" }, { pane = \"teapot\" }] }",
            vec![Pane::Scene],
            "`teapot`",
        ),
        (
            "version = 1\n[root]\ncolumn = { children = [{ pane = \"scene\" }, { row = { children = [] } }, { pane = \"scene\" }] }",
            vec![Pane::Scene],
            "twice",
        ),
        ("version = 9\n[root]\npane = \"runs\"", vec![Pane::Runs], "newer resect"),
    ];
    for (text, expected, finding) in cases {
        let (layout, findings) = read(text);
        assert_eq!(panes(&layout), expected, "{text}");
        assert!(findings.iter().any(|f| f.to_string().contains(finding)), "{text}: {findings:?}");
        let mut harness = drawn(layout, Vec2::new(1100.0, 700.0));
        harness.run_steps(2);
        assert!(!harness.state().places.is_empty(), "{text}");
    }
    let (layout, findings) = read("version = 1\n[root.tabs]\nchildren = []");
    assert_eq!(panes(&layout), panes(&Layout::default()));
    assert_eq!(findings[0].kind, kinds::LAYOUT_INVALID, "{findings:?}");
}

fn any_node() -> impl Strategy<Value = Node<String>> {
    let names: Vec<&str> = Pane::ALL.iter().map(|pane| pane.name()).chain(["", "teapot"]).collect();
    let pane = proptest::sample::select(names).prop_map(|name| Node::Pane(name.to_owned()));
    let share = prop_oneof![
        Just(f32::NAN),
        Just(f32::INFINITY),
        Just(f32::MAX),
        Just(f32::MIN_POSITIVE),
        -1.0_f32..10.0
    ];
    pane.prop_recursive(5, 40, 5, move |inner| {
        let children = prop::collection::vec(inner, 0..5);
        let shares = prop::collection::vec(share.clone(), 0..6);
        (0..3, any::<i64>(), shares, children).prop_map(|(kind, active, shares, children)| {
            match kind {
                0 => Node::Tabs { active: active % 6, children },
                1 => Node::Row { shares, children },
                _ => Node::Column { shares, children },
            }
        })
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn whatever_is_described_the_window_is_not_empty_and_stays_as_it_is(
        root in any_node(),
        follows_window: bool,
    ) {
        let description = LayoutDescription { version: 1, follows_window, root };
        let (mut layout, _) = Layout::of_description(&description);
        let before = layout.describe();
        prop_assert!(!panes(&layout).is_empty());
        // The docking library has nothing left to simplify.
        layout.tree.simplify(&SIMPLIFICATION);
        prop_assert_eq!(&before, &layout.describe());
        let (again, findings) = reread(&layout);
        prop_assert_eq!(findings, vec![]);
        prop_assert!(close(&again.describe().root, &before.root));
    }
}

/// Too small shares are enlarged only once: reading them again does not enlarge them further.
#[test]
fn parts_too_small_to_be_seen_are_the_same_when_they_are_read_again() {
    let all: Vec<Node<String>> =
        Pane::ALL.iter().map(|pane| Node::Pane(pane.name().to_owned())).collect();
    let (first, others) = all.split_first().expect("panes");
    let tiny = vec![f32::MIN_POSITIVE; others.len()];
    let inner = Node::Row { shares: tiny, children: others.to_vec() };
    let shares = vec![9.0, 1.2e-38];
    let root = Node::Row { shares, children: vec![first.clone(), inner] };
    let description = LayoutDescription { version: 1, follows_window: false, root };
    let (layout, findings) = Layout::of_description(&description);
    assert_eq!(findings, []);
    let Node::Row { shares, .. } = layout.describe().root else { panic!("a row") };
    assert!(shares.iter().all(|share| *share >= 0.0199), "{shares:?}");
    let (again, _) = reread(&layout);
    assert!(close(&again.describe().root, &layout.describe().root), "{shares:?}");
}

/// Shares rounded one by one sum to more than one, and would change at every save.
#[test]
fn shares_stay_the_same_to_the_last_digit_when_they_are_read_and_written_again() {
    for share in (0..400_u16).map(|step| 0.021 + 0.002_395 * f32::from(step)) {
        let pane = |pane: Pane| Node::Pane(pane.name().to_owned());
        let children = vec![pane(Pane::Scene), pane(Pane::Result), pane(Pane::Findings)];
        let root = Node::Row { shares: vec![share, 0.25 * (1.0 - share), 0.3], children };
        let description = LayoutDescription { version: 1, follows_window: false, root };
        let (layout, _) = Layout::of_description(&description);
        let (again, _) = reread(&layout);
        assert_eq!(again.describe(), layout.describe(), "{share}");
    }
}

/// Returns true if both are equal but for rounding of the shares.
fn close(a: &Node<String>, b: &Node<String>) -> bool {
    let all = |a: &[Node<String>], b: &[Node<String>]| {
        a.len() == b.len() && a.iter().zip(b).all(|(a, b)| close(a, b))
    };
    let near = |a: &[f32], b: &[f32]| {
        a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-3)
    };
    match (a, b) {
        (Node::Pane(a), Node::Pane(b)) => a == b,
        (Node::Tabs { active: a, children: c }, Node::Tabs { active: b, children: d }) => {
            a == b && all(c, d)
        }
        (Node::Row { shares: a, children: c }, Node::Row { shares: b, children: d })
        | (Node::Column { shares: a, children: c }, Node::Column { shares: b, children: d }) => {
            near(a, b) && all(c, d)
        }
        _ => false,
    }
}

/// Moves, closes, reopens and replaces panes at random; the layout must survive writing and reading unchanged.
#[test]
fn random_edits_go_through_a_file_unchanged() {
    for seed in 0..40 {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut layout = Layout { follows_window: false, ..Layout::default() };
        for step in 0..60 {
            edit(&mut layout, &mut random);
            layout.tree.simplify(&SIMPLIFICATION);
            let (again, findings) = reread(&layout);
            assert_eq!(findings, [], "seed {seed}, step {step}");
            let (a, b) = (again.describe(), layout.describe());
            assert!(close(&a.root, &b.root), "seed {seed}, step {step}: {a:?} for {b:?}");
            assert_eq!(panes(&again), panes(&layout), "seed {seed}, step {step}");
        }
    }
}

fn edit(layout: &mut Layout, random: &mut ChaCha8Rng) {
    let pane = Pane::ALL[random.random_range(0..Pane::ALL.len())];
    let alone = panes(layout).len() == 1;
    let tiles = &mut layout.tree.tiles;
    let mut containers: Vec<TileId> =
        tiles.iter().filter(|(_, tile)| !tile.is_pane()).map(|(id, _)| *id).collect();
    containers.sort_by_key(|id| id.0);
    let container = containers[random.random_range(0..containers.len())];
    match (random.random_range(0..5), tiles.find_pane(&pane)) {
        (0, Some(tile)) if !alone => {
            layout.tree.tiles.remove(tile);
        }
        (1, _) => layout.show(pane),
        // To other tabs, or into a new container.
        (2, Some(tile)) => {
            layout.tree.move_tile_to_container(tile, container, random.random_range(0..4), false);
        }
        (3, Some(tile)) => {
            let split = match random.random_range(0..3) {
                0 => tiles.insert_horizontal_tile(vec![]),
                1 => tiles.insert_vertical_tile(vec![]),
                _ => tiles.insert_tab_tile(vec![]),
            };
            layout.tree.move_tile_to_container(split, container, 0, false);
            layout.tree.move_tile_to_container(tile, split, 0, false);
        }
        (_, _) => {
            if let Some(Tile::Container(egui_tiles::Container::Linear(linear))) =
                tiles.get_mut(container)
            {
                let child = linear.children[random.random_range(0..linear.children.len())];
                linear.shares.set_share(child, random.random_range(0.2..3.0));
            }
        }
    }
}
