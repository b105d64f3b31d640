//! The rectangle of the picture that controls and legend do not cover.

use egui::Rect;

use crate::app::model::Frame;

/// Returns the largest free rectangle of a picture after cutting off one side for each overlay.
pub fn free_part(picture: Rect, over: &[Rect]) -> Rect {
    over.iter().fold(picture, |free, over| {
        if !free.intersects(*over) {
            return free;
        }
        let sides = [
            free.with_min_x(over.right()),
            free.with_max_x(over.left()),
            free.with_min_y(over.bottom()),
            free.with_max_y(over.top()),
        ];
        let area = |rect: &Rect| rect.width().max(0.0) * rect.height().max(0.0);
        sides.into_iter().max_by(|a, b| area(a).total_cmp(&area(b))).unwrap_or(free)
    })
}

/// Returns a picture and its free rectangle as the camera's frame.
pub fn frame(picture: Rect, free: Rect) -> Frame {
    // If almost nothing is free, the camera ignores the overlays.
    let [least_width, least_height] = [picture.width(), picture.height()].map(|side| 0.2 * side);
    let free =
        if free.width() < least_width || free.height() < least_height { picture } else { free };
    let half = 0.5 * picture.size();
    let (low, high) = (free.min - picture.center(), free.max - picture.center());
    Frame {
        aspect: picture.width() / picture.height().max(1.0),
        across: [low.x / half.x, high.x / half.x],
        upwards: [-high.y / half.y, -low.y / half.y],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::Pos2;

    fn rect(left: f32, top: f32, right: f32, bottom: f32) -> Rect {
        Rect::from_min_max(Pos2::new(left, top), Pos2::new(right, bottom))
    }

    #[test]
    fn a_bar_takes_the_top_and_a_tall_legend_the_left() {
        let picture = rect(100.0, 50.0, 1000.0, 650.0);
        let (bar, legend) = (rect(500.0, 56.0, 992.0, 80.0), rect(108.0, 58.0, 300.0, 400.0));
        let free = free_part(picture, &[bar, legend]);
        assert_eq!(free, rect(300.0, 80.0, 1000.0, 650.0));
        let Frame { across, upwards, .. } = frame(picture, free);
        assert!((across[0] + 250.0 / 450.0).abs() < 1e-6 && across[1] == 1.0, "{across:?}");
        assert!(upwards[0] == -1.0 && (upwards[1] - 0.9).abs() < 1e-6, "{upwards:?}");
    }

    #[test]
    fn where_all_is_covered_the_whole_counts() {
        let picture = rect(0.0, 0.0, 200.0, 100.0);
        let free = free_part(picture, &[rect(0.0, 0.0, 195.0, 98.0)]);
        assert_eq!(frame(picture, free), Frame::whole(2.0));
    }
}
