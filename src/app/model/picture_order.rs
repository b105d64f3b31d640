//! Choices for a picture of a pane.

use super::Pane;

/// Destination of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureTo {
    File,
    Clipboard,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureFormat {
    Png,
    Svg,
}

impl PictureFormat {
    pub const ALL: [Self; 2] = [Self::Png, Self::Svg];

    pub fn name(self) -> &'static str {
        match self {
            Self::Png => "PNG",
            Self::Svg => "SVG",
        }
    }

    pub fn extension(self) -> &'static str {
        match self {
            Self::Png => "png",
            Self::Svg => "svg",
        }
    }
}

/// A picture of one pane without its controls.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PictureOrder {
    pub pane: Pane,
    pub format: PictureFormat,
    /// Width and height (points).
    pub size_points: [u32; 2],
    /// Pixels per point.
    pub scale: u32,
    pub dark: bool,
}

impl PictureOrder {
    /// Least and greatest width and height (points).
    pub const SIDES: [u32; 2] = [100, 4096];
    /// Greatest number of pixels per point.
    pub const MOST_SCALE: u32 = 4;
    /// Size of a pane that is not in the window (points).
    const USUAL_POINTS: [u32; 2] = [900, 500];

    /// Returns the picture of a pane as large as in the window, with two pixels per point.
    pub fn of(pane: Pane, place: Option<egui::Rect>, dark: bool) -> Self {
        Self { pane, format: PictureFormat::Png, size_points: Self::size_of(place), scale: 2, dark }
    }

    /// Returns the size of a pane in the window (points).
    pub fn size_of(place: Option<egui::Rect>) -> [u32; 2] {
        let [least, most] = Self::SIDES;
        place.map_or(Self::USUAL_POINTS, |place| {
            [place.width(), place.height()].map(|side| (side.round() as u32).clamp(least, most))
        })
    }

    /// Returns true if a pane can be written as SVG, which is all but the three-dimensional scene.
    pub fn has_svg(pane: Pane) -> bool {
        pane != Pane::Scene
    }

    /// Returns the width and height of the image (pixels).
    pub fn size_pixels(&self) -> [u32; 2] {
        self.size_points.map(|side| side * self.scale)
    }
}
