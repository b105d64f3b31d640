use super::*;
use resect_core::deployment::kinds;
use resect_tools::experiment::{Group, Series};
use resect_tools::experiment::{Level, Quantiles};

const SIZES: [[f32; 2]; 5] =
    [[420.0, 260.0], [480.0, 300.0], [1000.0, 600.0], [1600.0, 1000.0], [420.0, 900.0]];

/// Parameters of the test charts.
#[derive(Clone, Copy, Debug)]
struct Shape {
    groups: usize,
    series: usize,
    label: &'static str,
    values: fn(f64) -> Quantiles,
    level: f64,
}

fn quantiles(median: f64, spread: f64) -> Quantiles {
    Quantiles {
        q05: median * (1.0 - 1.9 * spread),
        q25: median * (1.0 - spread),
        median,
        q75: median * (1.0 + spread),
        q95: median * (1.0 + 2.5 * spread),
        n: 2032,
    }
}

fn shapes() -> Vec<Shape> {
    let values: [fn(f64) -> Quantiles; 8] = [
        |x| quantiles(1.0 + x, 0.5),
        |x| quantiles(1.0 + x.powi(3), 0.5),
        |x| quantiles(1.0 + x, 1e-4),
        |x| quantiles(x - 3.0, 0.5),
        |_| quantiles(0.0, 0.5),
        |x| quantiles(1e-7 * (1.0 + x), 1.0),
        |x| quantiles(1e14 * x, 0.1),
        |x| quantiles(if x < 2.0 { f64::NAN } else { f64::INFINITY }, 0.5),
    ];
    let labels =
        ["0.5 s", "both filters on", "20220224-1-long-deployment-name without a space", ""];
    let mut shapes = Vec::new();
    for groups in [0, 1, 4, 11, 21] {
        for series in [0, 1, 2, 3] {
            for label in labels {
                for values in values {
                    for level in [f64::NAN, 3.0] {
                        shapes.push(Shape { groups, series, label, values, level });
                    }
                }
            }
        }
    }
    shapes
}

fn chart(shape: Shape) -> Study {
    let cell = |group: usize, series: usize| match (group + 2 * series) % 7 {
        3 => Err("no control points while moving".to_owned()),
        _ => Ok((shape.values)(group as f64 + 0.3 * series as f64)),
    };
    let level = |label: &str, value| Level { label: label.to_owned(), value };
    Study {
        name: "test".into(),
        settings: resect_core::analysis::Settings::default(),
        findings: vec![
            Finding::new(
                kinds::METHODS_DISAGREE,
                "B and D disagree about the yaw of station 2 by more than their uncertainty allows"
            );
            3
        ],
        title: "Longest gap between readings of deployment 20220224-1, filters 1 and 3".into(),
        subtitle: "WNOA, inter-prism calibration, all else as set".into(),
        value_label: "inter-prism error (mm)".into(),
        series: (0..shape.series)
            .map(|index| Series { name: format!("series {index}"), rgb: [86, 160, 233] })
            .collect(),
        groups: (0..shape.groups)
            .map(|group| Group {
                label: shape.label.to_owned(),
                note: "2032 triplets".to_owned(),
                boxes: (0..shape.series).map(|series| cell(group, series)).collect(),
            })
            .collect(),
        group_label: "longest gap that is bridged".into(),
        levels: vec![
            level("RTK GNSS 8.1 mm", shape.level),
            level("range noise 2 mm", 0.95 * shape.level),
        ],
    }
}

/// Returns two opposite corners of a mark.
fn extent(mark: &Mark) -> [[f32; 2]; 2] {
    match mark {
        Mark::Line { points, .. } => {
            let fold = |start: f32, pick: fn(f32, f32) -> f32| {
                [0, 1].map(|axis| points.iter().map(|point| point[axis]).fold(start, pick))
            };
            [fold(f32::INFINITY, f32::min), fold(f32::NEG_INFINITY, f32::max)]
        }
        Mark::Rect { min, max, .. } => [*min, *max],
        Mark::Text { at: [x, y], text, size, anchor, upwards, .. } => {
            let length = text_width(text, *size);
            let before = match anchor {
                Anchor::Left => 0.0,
                Anchor::Middle => 0.5 * length,
                Anchor::Right => length,
            };
            let half = 0.5 * size;
            if *upwards {
                [[x - half, y + before - length], [x + half, y + before]]
            } else {
                [[x - before, y - half], [x - before + length, y + half]]
            }
        }
    }
}

fn overlap(a: [[f32; 2]; 2], b: [[f32; 2]; 2]) -> bool {
    (0..2).all(|axis| a[0][axis] < b[1][axis] - 0.01 && b[0][axis] < a[1][axis] - 0.01)
}

#[test]
fn texts_are_whole_and_clear_of_each_other_and_of_boxes() {
    for shape in shapes() {
        for size in SIZES {
            let drawing = draw(&chart(shape), size);
            let mut texts: Vec<(&str, [[f32; 2]; 2])> = Vec::new();
            for mark in &drawing.marks {
                let [min, max] = extent(mark);
                let inside = (0..2).all(|axis| min[axis] >= 0.0 && max[axis] <= size[axis]);
                assert!(inside, "{shape:?} at {size:?}: {mark:?} is outside");
                if let Mark::Text { text, .. } = mark {
                    texts.push((text, [min, max]));
                }
            }
            for (index, (text, here)) in texts.iter().enumerate() {
                for (other, there) in &texts[..index] {
                    let clear = !overlap(*here, *there);
                    assert!(clear, "{shape:?} at {size:?}: {text} over {other}");
                }
                for mark in &drawing.marks {
                    let is_box = matches!(mark, Mark::Rect { ink: Ink::Rgb(_), .. });
                    let clear = !(is_box && overlap(*here, extent(mark)));
                    assert!(clear, "{shape:?} at {size:?}: {text} over a box");
                }
            }
        }
    }
}

fn texts(drawing: &Drawing) -> Vec<&str> {
    fn text(mark: &Mark) -> Option<&str> {
        match mark {
            Mark::Text { text, .. } => Some(text),
            _ => None,
        }
    }
    drawing.marks.iter().filter_map(text).collect()
}

#[test]
fn median_and_range_are_written_and_the_axis_tells_its_scale() {
    let values: [fn(f64) -> Quantiles; 2] =
        [|_| quantiles(1.937, 0.3), |x| quantiles(1.937 + 40.0 * x, 0.3)];
    for (values, log) in values.into_iter().zip([false, true]) {
        let shape = Shape { groups: 3, series: 1, label: "both", values, level: f64::NAN };
        let drawing = draw(&chart(shape), [1000.0, 600.0]);
        let texts = texts(&drawing);
        assert!(texts.contains(&"1.94") && texts.contains(&"1.16"), "{texts:?}");
        assert_eq!(texts.iter().any(|text| text.ends_with("log scale")), log);
        assert!(texts.iter().any(|text| text.starts_with("box: quartiles, line: median")));
    }
}

#[test]
fn a_chart_without_boxes_says_so() {
    let shape =
        Shape { groups: 0, series: 2, label: "", values: |_| quantiles(1.0, 0.1), level: 2.0 };
    assert!(texts(&draw(&chart(shape), [480.0, 300.0])).contains(&"no data"));
}

#[test]
fn quantiles_are_numpys() {
    // numpy.quantile([1, 2, 4, 8, 16, 32], [0.05, 0.25, 0.5, 0.75, 0.95])
    let found = Quantiles::of([8.0, 1.0, 32.0, 2.0, 16.0, 4.0]);
    let wanted = Quantiles { q05: 1.25, q25: 2.5, median: 6.0, q75: 14.0, q95: 28.0, n: 6 };
    assert_eq!(found, Some(wanted));
    assert_eq!(Quantiles::of([]), None);
    assert_eq!(Quantiles::of([3.0]).map(|one| one.values()), Some([3.0; 5]));
}

#[test]
fn a_box_says_its_numbers_where_it_stands() {
    let shape = shapes().into_iter().find(|shape| shape.groups == 4 && shape.series == 2);
    let chart = chart(shape.expect("one of them"));
    for size in SIZES {
        let laid_out = lay_out(&chart, &[], size);
        // The median's line is the thickest mark of a box.
        let medians: Vec<[f32; 2]> = laid_out
            .drawing
            .marks
            .iter()
            .filter_map(|mark| match mark {
                Mark::Line { points, ink: Ink::Rgb(_), width, .. } => {
                    Some((*width, [0.5 * (points[0][0] + points[1][0]), points[0][1]]))
                }
                _ => None,
            })
            .fold((0.0, Vec::new()), |(most, mut all), (width, at)| {
                if width > most {
                    all.clear();
                }
                if width >= most {
                    all.push(at);
                }
                (width.max(most), all)
            })
            .1;
        let present: Vec<String> = (0..4)
            .flat_map(|group| [0, 1].map(|series| (group, series)))
            .filter(|&(group, series)| chart.quantiles(group, series).is_ok())
            .map(|(group, series)| boxes::said(&chart, group, series).expect("a box"))
            .collect();
        let said: Vec<String> =
            medians.iter().filter_map(|at| laid_out.said_at(&chart, *at)).collect();
        assert_eq!(said, present, "{size:?}");
        assert!(said[0].contains("median 1") && said[0].contains("2032 values"), "{}", said[0]);
        assert_eq!(laid_out.said_at(&chart, [1.0, 1.0]), None);
    }
}
