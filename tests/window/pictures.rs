//! Pictures of single panes: their size, their content, and the dialog that asks for them.

use egui::{Key, Modifiers, Theme};
use egui_kittest::kittest::Queryable;
use resect::app::{
    Pane, PanePicture, PictureFormat, PictureOrder, PictureTo, ResultsCommand, WorkspaceCommand,
};
use resvg::{tiny_skia, usvg};

use crate::harness::{SMALL, Window, click, press, send, window};

const SIZE: [u32; 2] = [640, 400];

fn order(pane: Pane, format: PictureFormat, scale: u32) -> PictureOrder {
    PictureOrder { pane, format, size_points: SIZE, scale, dark: false }
}

fn draw(harness: &mut Window, order: &PictureOrder) -> PanePicture {
    let ctx = harness.ctx.clone();
    harness.state_mut().picture(order, &ctx).expect("a picture")
}

fn pixels(harness: &mut Window, pane: Pane, scale: u32) -> image::RgbaImage {
    match draw(harness, &order(pane, PictureFormat::Png, scale)) {
        PanePicture::Pixels(image) => image,
        PanePicture::Svg(_) => panic!("pixels"),
    }
}

fn svg(harness: &mut Window, pane: Pane) -> String {
    match draw(harness, &order(pane, PictureFormat::Svg, 1)) {
        PanePicture::Svg(svg) => svg,
        PanePicture::Pixels(_) => panic!("SVG"),
    }
}

/// Draws an SVG with the program's own font, one pixel per point.
fn rasterised(svg: &str) -> image::RgbaImage {
    let mut options = usvg::Options { font_family: "Inter".into(), ..Default::default() };
    options.fontdb_mut().load_font_data(resect_report::font::INTER.to_vec());
    options.fontdb_mut().load_font_data(resect_report::font::FIGURES.to_vec());
    let tree = usvg::Tree::from_str(svg, &options).expect("a valid SVG");
    let mut pixels = tiny_skia::Pixmap::new(SIZE[0], SIZE[1]).expect("a size");
    resvg::render(&tree, tiny_skia::Transform::identity(), &mut pixels.as_mut());
    image::RgbaImage::from_raw(SIZE[0], SIZE[1], pixels.take()).expect("its size")
}

#[test]
fn each_pane_is_drawn_at_the_chosen_size_and_scale() {
    let mut harness = window(SMALL, Theme::Dark);
    for pane in Pane::ALL {
        let image = pixels(&mut harness, pane, 2);
        assert_eq!((image.width(), image.height()), (2 * SIZE[0], 2 * SIZE[1]));
        let ground = image.get_pixel(0, 0);
        assert!(image.pixels().any(|pixel| pixel != ground), "{pane:?} is empty");
        if PictureOrder::has_svg(pane) {
            let svg = svg(&mut harness, pane);
            rasterised(&svg);
            assert!(svg.contains("<text"), "{pane:?} has no text");
        }
    }
}

#[test]
fn an_svg_shows_what_the_pixels_show() {
    let mut harness = window(SMALL, Theme::Dark);
    send(&mut harness, ResultsCommand::Pin);
    for pane in [Pane::Residuals, Pane::Rates, Pane::Intervals, Pane::Channels, Pane::Histogram] {
        let (drawn, svg) = (pixels(&mut harness, pane, 1), rasterised(&svg(&mut harness, pane)));
        let differ = |(a, b): &(&image::Rgba<u8>, &image::Rgba<u8>)| {
            (0..3).any(|channel| a.0[channel].abs_diff(b.0[channel]) > 110)
        };
        let different = drawn.pixels().zip(svg.pixels()).filter(differ).count();
        let ground = drawn.get_pixel(0, 0);
        let inked = drawn.pixels().filter(|pixel| differ(&(pixel, ground))).count();
        // Letters are drawn by another rasteriser.
        assert!(4 * different < inked, "{pane:?}: {different} pixels of {inked} differ");
    }
}

#[test]
fn a_picture_has_no_controls() {
    let mut harness = window(SMALL, Theme::Dark);
    for (pane, control) in [
        (Pane::Channels, "Save as CSV…"),
        (Pane::Residuals, "scroll"),
        (Pane::Result, "Copy as text"),
        (Pane::PlanMap, "Remove"),
    ] {
        let svg = svg(&mut harness, pane);
        assert!(!svg.contains(control), "{pane:?}: {control}");
    }
    // The names of the pairs stay: they are the legend.
    assert!(svg(&mut harness, Pane::Residuals).contains("1–2"));
}

#[test]
fn a_picture_that_is_too_large_is_an_error_with_the_remedy() {
    let mut harness = window(SMALL, Theme::Dark);
    let ctx = harness.ctx.clone();
    let order =
        PictureOrder { size_points: [4096, 4096], ..order(Pane::Rates, PictureFormat::Png, 4) };
    let Err(why) = harness.state_mut().picture(&order, &ctx) else { panic!("16384 pixels") };
    assert!(why.starts_with("16384 × 16384 pixels") && why.contains("choose a smaller"), "{why}");
}

#[test]
fn the_dialog_copies_the_chosen_pane() {
    let mut harness = window(SMALL, Theme::Dark);
    press(&mut harness, Modifiers::COMMAND, Key::E);
    harness.get_by_label("Picture of a pane");
    click(&mut harness, "4×");
    click(&mut harness, "Copy");
    assert!(harness.query_by_label("Picture of a pane").is_none(), "the dialog closes");
    harness.get_by_label_contains("picture of Scene copied");
    send(
        &mut harness,
        WorkspaceCommand::TakePicture(
            order(Pane::Histogram, PictureFormat::Svg, 1),
            PictureTo::Clipboard,
        ),
    );
    harness.get_by_label_contains("picture of Histogram copied as SVG text");
}
