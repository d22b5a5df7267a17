use super::*;
use proptest::prelude::*;

const SEVERAL: &str = r#"[
    {"Name": "grey", "ColorSpace": "RGB", "RGBPoints": [0, 0, 0, 0, 1, 1, 1, 1], "NanColor": [1, 0.5, 0]},
    {"Name": "kitchen", "IndexedColors": [1, 0, 0, 0, 1, 0]},
    {"Name": "cool", "ColorSpace": "Diverging", "RGBPoints": [-1, 0.2298, 0.2987, 0.7537, 3, 0.7057, 0.0156, 0.1502],
     "Points": [-1, 0, 0.5, 0, 1, 0.25, 0.5, 0, 3, 1, 0.5, 0]}
]"#;

fn json(fields: &str) -> Result<Preset, PresetError> {
    read_preset(&format!(r#"{{"Name": "test", {fields}}}"#), None)
}

fn positions(preset: &Preset) -> Vec<f64> {
    preset.color.iter().map(|node| node.s).collect()
}

fn opacity(preset: &Preset) -> Vec<(f64, f64)> {
    preset.opacity.iter().map(|node| (node.s, node.opacity)).collect()
}

#[test]
fn a_preset_is_chosen_by_name() {
    let grey = read_preset(SEVERAL, Some("grey")).unwrap();
    assert_eq!((grey.name.as_str(), grey.nan_color), ("grey", Some([1.0, 0.5, 0.0])));
    assert_eq!(positions(&grey), [0.0, 1.0]);
    assert_eq!(opacity(&grey), [(0.0, 0.0), (1.0, 1.0)]);
    let message = read_preset(SEVERAL, None).unwrap_err().to_string();
    assert!(message.ends_with("grey, kitchen, cool"), "{message}");
    assert!(matches!(read_preset(SEVERAL, Some("none")), Err(PresetError::Unknown { .. })));
    assert!(matches!(read_preset(SEVERAL, Some("kitchen")), Err(PresetError::Categorical { .. })));
    assert!(matches!(read_preset("[]", None), Err(PresetError::Empty)));
}

#[test]
fn curved_spaces_are_subdivided() {
    let cool = read_preset(SEVERAL, Some("cool")).unwrap();
    assert!(cool.color.len() > 9, "{}", cool.color.len());
    let tf = cool.transfer_function(None).unwrap();
    // White in the middle, within the four digits of the preset's and VTK's constants.
    assert!(tf.luminance(1.0).iter().all(|c| (c - 0.865).abs() < 2e-3), "{:?}", tf.luminance(1.0));
    assert_eq!(tf.luminance(-1.0), [0.2298, 0.2987, 0.7537]);
    assert_eq!(tf.opacity(0.0), 0.125);
}

#[test]
fn rescaling_moves_both_ends_exactly() {
    let cool = read_preset(SEVERAL, Some("cool")).unwrap();
    let tf = cool.transfer_function(Some([10.0, 10.3])).unwrap();
    let points = tf.control_points();
    assert_eq!((points[0], points[points.len() - 1]), (10.0, 10.3));
    // The opacity node at 1 was half-way.
    assert!((tf.opacity_nodes()[1].s - 10.15).abs() < 1e-14);
    for range in [[1.0, 1.0], [2.0, 1.0], [f64::NAN, 1.0], [0.0, f64::INFINITY]] {
        assert!(matches!(cool.transfer_function(Some(range)), Err(PresetError::Range { .. })), "{range:?}");
    }
}

#[test]
fn step_holds_the_second_color() {
    let preset = json(r#""ColorSpace": "Step", "RGBPoints": [0,1,0,0, 1,0,1,0, 2,0,0,1]"#).unwrap();
    let tf = preset.transfer_function(None).unwrap();
    assert_eq!(tf.luminance(-0.5), [1.0, 0.0, 0.0]);
    assert_eq!(tf.luminance(0.5), [0.0, 1.0, 0.0]);
    assert_eq!(tf.luminance(1.5), [0.0, 0.0, 1.0]);
    assert_eq!(tf.luminance_below(1.0), [0.0, 1.0, 0.0]);
}

#[test]
fn midpoints_and_steps_of_opacity_are_exact() {
    let color = r#""RGBPoints": [0,0,0,0, 1,1,1,1]"#;
    // Half-way at a quarter.
    let bent = json(&format!(r#"{color}, "Points": [0,0,0.25,0, 1,1,0.5,0]"#)).unwrap();
    assert_eq!(opacity(&bent), [(0.0, 0.0), (0.25, 0.5), (1.0, 1.0)]);
    let step = json(&format!(r#"{color}, "Points": [0,0.5,0.25,1, 1,2,0.5,0]"#)).unwrap();
    assert_eq!(opacity(&step), [(0.0, 0.5), (0.25, 0.5), (0.25, 2.0), (1.0, 2.0)]);
    let curve = json(&format!(r#"{color}, "Points": [0,0,0.5,0, 0.5,1,0.5,0.3, 1,0,0.5,0]"#));
    assert!(matches!(curve, Err(PresetError::Curve { point: 1, sharpness: 0.3, .. })));
}

#[test]
fn unsorted_and_coincident_points() {
    let preset = json(r#""RGBPoints": [1,1,0,0, 0,0,0,0, 1,0,1,0, 2,0,0,1]"#).unwrap();
    let tf = preset.transfer_function(None).unwrap();
    assert_eq!((tf.luminance_below(1.0), tf.luminance(1.0)), ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]));
}

#[test]
fn a_logarithmic_scale_is_even_in_ratios() {
    let preset = json(r#""UseLogScale": 1, "RGBPoints": [1,0,0,0, 10000,1,1,1]"#).unwrap();
    let tf = preset.transfer_function(None).unwrap();
    // One quarter of the decades is a quarter of the colour; exact at a node of the subdivision.
    assert!((tf.luminance(10.0)[0] - 0.25).abs() < 1e-12);
    let moved = preset.transfer_function(Some([1e-2, 1e2])).unwrap();
    assert!((moved.luminance(0.1)[0] - 0.25).abs() < 1e-12);
    assert!(matches!(preset.transfer_function(Some([0.0, 1.0])), Err(PresetError::Log { .. })));
    let zero = json(r#""UseLogScale": true, "RGBPoints": [0,0,0,0, 1,1,1,1]"#);
    assert!(matches!(zero, Err(PresetError::Log { s: 0.0, .. })));
}

#[test]
fn xml_color_maps() {
    let text = |space: &str, last: f64| {
        format!(
            "<ColorMaps><!-- old --><ColorMap name=\"a &amp; b\" space=\"{space}\">\
             <Point x=\"0\" o=\"1\" r=\"1\" g=\"0.5\" b=\"0\"/><Point x=\"2\" o=\"{last}\" r=\"1\" g=\"0\" b=\"0.5\"/>\
             <NaN r=\"0\" g=\"0.25\" b=\"1\" o=\"0.5\"/></ColorMap></ColorMaps>"
        )
    };
    let wrapped = read_preset(&text("Wrapped", 1.0), Some("a & b")).unwrap();
    assert_eq!((wrapped.nan_color, wrapped.nan_opacity), (Some([0.0, 0.25, 1.0]), Some(0.5)));
    let json = json(r#""NanColor": [0,1,0], "NanOpacity": 0.75, "RGBPoints": [0,0,0,0, 1,1,1,1]"#).unwrap();
    assert_eq!((json.nan_color, json.nan_opacity), (Some([0.0, 1.0, 0.0]), Some(0.75)));
    // Through red, not through cyan.
    let tf = wrapped.transfer_function(None).unwrap();
    assert!(tf.luminance(1.0)[0] == 1.0 && tf.luminance(1.0)[1] < 1e-14);
    // A constant `o` is ParaView's filler, a varying one is meant.
    assert_eq!(opacity(&wrapped), [(0.0, 0.0), (2.0, 1.0)]);
    assert_eq!(opacity(&read_preset(&text("RGB", 0.5), None).unwrap()), [(0.0, 1.0), (2.0, 0.5)]);
}

#[test]
fn broken_files_say_where() {
    let fail = |text: &str| read_preset(text, None).unwrap_err();
    let bad = fail("\n<ColorMap name=\"m\"><Point x=\"0\" r=\"red\" g=\"0\" b=\"0\"/></ColorMap>");
    assert!(matches!(&bad, PresetError::Xml { position: 20, reason } if reason.contains("\"red\"")), "{bad}");
    assert!(matches!(fail("<ColorMap name=\"m\">"), PresetError::Xml { .. }));
    assert!(matches!(fail("<ColorMap name=\"m\"/>"), PresetError::Length { length: 0, .. }));
    assert!(matches!(fail("{\"Name\": "), PresetError::Json(_)));
    assert!(matches!(json(r#""RGBPoints": [0,0,0]"#), Err(PresetError::Length { length: 3, .. })));
    assert!(matches!(json(r#""Points": [0,0,0.5,0]"#), Err(PresetError::Length { field: "RGBPoints", .. })));
    let space = json(r#""ColorSpace": "Lab/CIEDE2000", "RGBPoints": [0,0,0,0]"#).unwrap_err();
    assert!(space.to_string().contains("Lab/CIEDE2000"));
    assert!(matches!(json(r#""RGBPoints": [0,0,-1,0]"#), Err(PresetError::Nodes { .. })));
    assert!(matches!(
        fail("<ColorMap><Point x=\"inf\" r=\"0\" g=\"0\" b=\"0\"/></ColorMap>"),
        PresetError::Nodes { .. }
    ));
}

#[test]
fn a_single_point_is_one_luminance() {
    let preset = json(r#""RGBPoints": [4,1,0.5,0]"#).unwrap();
    assert_eq!(preset.transfer_function(Some([0.0, 1.0])).unwrap().single_luminance(), Some([1.0, 0.5, 0.0]));
}

/// The preset of one interval between two colours.
fn interval(space: ColorSpace, ends: [[f64; 3]; 2], log_scale: bool) -> Vec<ColorNode> {
    let [[r, g, b], [r1, g1, b1]] = ends;
    let color = vec![[1.0, r, g, b], [2.0, r1, g1, b1]];
    color_nodes(&RawPreset { color, log_scale, ..RawPreset::default() }, space)
}

/// The largest difference between a space and linear `nodes` from 1 to 2, away from the jumps at its ends.
fn worst_difference(nodes: &[ColorNode], space: ColorSpace, [from, to]: [[f64; 3]; 2]) -> f64 {
    let tf = TransferFunction::new(nodes.to_vec(), vec![OpacityNode { s: 0.0, opacity: 1.0 }]).unwrap();
    let mut worst = 0.0_f64;
    // A prime count: no sample coincides with a node. The first and last 1/250 are left out.
    for step in 4..995 {
        let t = f64::from(step) / 997.0;
        let (exact, linear) = (space.interpolate(from, to, t), tf.luminance(1.0 + t));
        worst = (0..3).map(|c| (exact[c] - linear[c]).abs()).fold(worst, f64::max);
    }
    worst
}

/// All pairs of a lattice of 3^3 colours, black, white, greys and every primary among them.
fn color_pairs() -> impl Iterator<Item = [[f64; 3]; 2]> {
    let color = |i: i32| [i % 3, i / 3 % 3, i / 9].map(|level| f64::from(level) / 2.0);
    (0..27 * 27).map(move |i| [color(i % 27), color(i / 27)])
}

#[test]
fn the_stated_tolerance_holds() {
    for (space, most_nodes) in [
        (ColorSpace::Rgb, 2),
        (ColorSpace::Lab, 150),
        (ColorSpace::Hsv { wrap: false }, 150),
        (ColorSpace::Diverging, 150),
    ] {
        let (mut worst, mut most) = (0.0_f64, 0);
        for ends in color_pairs() {
            let nodes = interval(space, ends, false);
            worst = worst.max(worst_difference(&nodes, space, ends));
            most = most.max(nodes.len());
        }
        println!("{space:?}: {worst:.2e} with at most {most} nodes an interval");
        assert!(worst <= SUBDIVISION_TOLERANCE, "{space:?}: {worst:.2e}");
        assert!(most <= most_nodes, "{space:?}: {most} nodes");
    }
}

#[test]
fn coarser_pieces_would_be_noticed() {
    // Half-way on the hue circle from red to cyan: a chord across the circle is grey where the space is saturated.
    let (space, ends) = (ColorSpace::Hsv { wrap: false }, [[1.0, 0.0, 0.0], [0.0, 1.0, 1.0]]);
    let nodes = interval(space, ends, false);
    assert!(worst_difference(&nodes, space, ends) <= SUBDIVISION_TOLERANCE);
    let coarse = [nodes[0], nodes[nodes.len() - 1]];
    assert!(worst_difference(&coarse, space, ends) > 0.4);
}

#[test]
fn nearly_straight_intervals_stay_whole() {
    // Neighbours in a map of hundreds of points.
    assert_eq!(interval(ColorSpace::Lab, [[0.40, 0.50, 0.60], [0.41, 0.50, 0.59]], false).len(), 2);
    assert_eq!(interval(ColorSpace::Rgb, [[0.0; 3], [1.0; 3]], true).len() % 2, 1);
}

proptest! {
    #[test]
    fn no_text_makes_the_reader_panic(position in 0_usize..400, byte in 0_u8..128, cut in 0_usize..400) {
        for text in [SEVERAL, "<ColorMap name=\"m\"><Point x=\"0\" o=\"1\" r=\"0\" g=\"0\" b=\"0\"/></ColorMap>"] {
            let mut bytes = text.as_bytes().to_vec();
            let length = bytes.len();
            bytes[position % length] = byte;
            bytes.truncate(cut.max(1));
            if let Ok(text) = String::from_utf8(bytes) {
                for name in [None, Some("cool")] {
                    if let Ok(preset) = read_preset(&text, name) {
                        prop_assert!(preset.transfer_function(None).is_ok());
                    }
                }
            }
        }
    }
}
