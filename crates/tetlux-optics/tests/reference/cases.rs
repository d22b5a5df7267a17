//! Every quantity of the 50-digit reference values beside ours.

use serde_json::Value;
use tetlux_optics::accuracy::relative_error;
use tetlux_optics::emission::{EmissionConvention, density_weights, q_e};
use tetlux_optics::segment::{psi, q, segment_with, weights, zeta};
use tetlux_optics::transfer::{ColorNode, OpacityNode, TransferFunction};
use tetlux_optics::widget::{Shape, WaveProfile, Widget};
use tetlux_optics::widget_integral::{RaySegment, optical_depth, widget_integral};

/// The largest errors of one quantity over the cases of one file.
#[derive(Clone, Debug)]
pub(crate) struct Row {
    pub(crate) file: &'static str,
    pub(crate) quantity: &'static str,
    pub(crate) relative: f64,
    pub(crate) absolute: f64,
    /// Where the relative error was largest.
    pub(crate) case: String,
}

/// Collects the largest errors.
#[derive(Default)]
pub(crate) struct Rows(pub(crate) Vec<Row>);

impl Rows {
    /// Notes one value of `quantity` beside what it should be.
    pub(crate) fn see(&mut self, file: &'static str, quantity: &'static str, value: f64, expected: f64, case: &Value) {
        let relative = relative_error(value, expected);
        let absolute = if value == expected { 0.0 } else { (value - expected).abs() };
        let absolute = if absolute.is_nan() { f64::INFINITY } else { absolute };
        match self.0.iter_mut().find(|row| row.file == file && row.quantity == quantity) {
            Some(row) => {
                row.absolute = row.absolute.max(absolute);
                if relative > row.relative {
                    (row.relative, row.case) = (relative, case.to_string());
                }
            }
            None => self.0.push(Row { file, quantity, relative, absolute, case: case.to_string() }),
        }
    }
}

/// All files; those that are absent are replaced by the extracts beside this file.
pub(crate) fn compare() -> Rows {
    let mut rows = Rows::default();
    for case in cases("psi", include_str!("../fixtures/psi.json")) {
        compare_weights(&case, &mut rows);
    }
    for case in cases("segment", include_str!("../fixtures/segment.json")) {
        compare_segment(&case, &mut rows);
    }
    for case in cases("piecewise_linear_tf", include_str!("../fixtures/piecewise_linear_tf.json")) {
        compare_transfer_function(&case, &mut rows);
    }
    for (file, extract) in [
        ("widget_uniform", include_str!("../fixtures/widget_uniform.json")),
        ("widget_gaussian", include_str!("../fixtures/widget_gaussian.json")),
        ("widget_triangle", include_str!("../fixtures/widget_triangle.json")),
        ("widget_sine", include_str!("../fixtures/widget_sine.json")),
    ] {
        for case in cases(file, extract) {
            compare_widget(file, &case, &mut rows);
        }
    }
    rows
}

fn cases(name: &str, extract: &str) -> Vec<Value> {
    let path = format!("{}/../../../shared/reference/{name}.json", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(&path).unwrap_or_else(|_| {
        println!("{name}: the full reference set is absent, using the extract");
        extract.to_owned()
    });
    let file: Value = serde_json::from_str(&text).expect("a reference file is JSON");
    let cases = file["cases"].as_array().expect("a reference file has cases").clone();
    assert!(!cases.is_empty());
    cases
}

fn number(case: &Value, name: &str) -> f64 {
    case[name].as_f64().unwrap_or_else(|| panic!("{name} is missing in {case}"))
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().into_iter().flatten().filter_map(Value::as_f64).collect()
}

fn compare_weights(case: &Value, rows: &mut Rows) {
    let (a, b) = (number(case, "a"), number(case, "b"));
    let (absorbed, density) = (weights(a, b), density_weights(a, b));
    let mut see = |quantity, value| rows.see("psi", quantity, value, number(case, quantity), case);
    see("alpha", absorbed.alpha);
    see("w_b", absorbed.back);
    see("w_f", absorbed.front);
    see("zeta", zeta(a, b));
    see("psi", psi(a, b));
    see("m_b", density.back);
    see("m_f", density.front);
    rows.see("psi", "q_e", q_e(a, b), number(case, "m_b") / number(case, "psi"), case);
    if let Some(expected) = case["q"].as_f64() {
        rows.see("psi", "q", q(a, b), expected, case);
    }
}

fn compare_segment(case: &Value, rows: &mut Rows) {
    let get = |name| number(case, name);
    let length = get("length");
    let (a, b) = (get("tau_b") * length, get("tau_f") * length);
    let (absorbed, density) = (weights(a, b), density_weights(a, b));
    let (back, front) = (length * density.back, length * density.front);
    let mut see = |quantity, value| rows.see("segment", quantity, value, get(quantity), case);
    see("transmittance", zeta(a, b));
    see("psi", psi(a, b));
    see("I_D", get("I_0") * zeta(a, b) + get("L_b") * absorbed.back + get("L_f") * absorbed.front);
    see("B", back);
    see("F", front);
    see("emission_only", get("L_b") * back + get("L_f") * front);
}

fn compare_transfer_function(case: &Value, rows: &mut Rows) {
    let get = |name| number(case, name);
    let (s, tau) = (numbers(&case["s"]), numbers(&case["tau"]));
    let light: Vec<Vec<f64>> = case["L"].as_array().into_iter().flatten().map(numbers).collect();
    // A power of two as unit distance: opacity and back again without rounding.
    let unit_distance = 4.0;
    let nodes = 0..s.len();
    let color = nodes.clone().map(|i| ColorNode { s: s[i], rgb: [light[i][0], light[i][1], light[i][2]] });
    let opacity = nodes.map(|i| OpacityNode { s: s[i], opacity: tau[i] * unit_distance });
    let tf = TransferFunction::new(color.collect(), opacity.collect()).expect("a reference function is valid");
    for (quantity, convention) in
        [("C", EmissionConvention::EmissionAbsorption), ("emission_only", EmissionConvention::EmissionDensity)]
    {
        let result = segment_with(&tf, unit_distance, get("s_f"), get("s_b"), get("length"), convention);
        let file = "piecewise_linear_tf";
        rows.see(file, "transmittance", result.transmittance, get("transmittance"), case);
        let expected = numbers(&case[quantity]);
        assert_eq!(expected.len(), 3);
        for (value, expected) in result.color.into_iter().zip(expected) {
            rows.see(file, quantity, value, expected, case);
        }
    }
}

fn compare_widget(file: &'static str, case: &Value, rows: &mut Rows) {
    let get = |name| number(case, name);
    let (shape, largest, front, back) = match file {
        "widget_uniform" => (Shape::Uniform, get("extinction"), [0.0; 2], [1.0; 2]),
        "widget_gaussian" => {
            let shape = Shape::Gaussian { center: [get("s_0"), get("g_0")], sigma: [get("sigma_s"), get("sigma_g")] };
            (shape, get("a_max"), [get("s_f"), get("g_f")], [get("s_b"), get("g_b")])
        }
        _ => {
            let profile = match case["profile"].as_str() {
                Some("triangle") => WaveProfile::Triangle,
                Some("abs_sine") => WaveProfile::AbsSine,
                Some("sine_squared") => WaveProfile::SineSquared,
                other => panic!("profile {other:?}"),
            };
            // The second scalar changes, but not the phase.
            let shape = Shape::Wave { profile, frequency: [1.0, 0.0], offset: 0.0 };
            (shape, get("a_max"), [get("phase_f"), 7.0], [get("phase_b"), -3.0])
        }
    };
    let widget = Widget::new(shape, None, largest, [1.0; 3]).expect("a reference widget is valid");
    let ray = RaySegment { front, back, length: get("length") };
    let result = widget_integral(&widget, 1.0, &ray);
    rows.see(file, "optical_depth, alone", optical_depth(&widget, 1.0, &ray), get("optical_depth"), case);
    let mut see = |quantity, value| rows.see(file, quantity, value, get(quantity), case);
    see("optical_depth", result.optical_depth);
    see("transmittance", result.transmittance);
    see("alpha", result.alpha);
    see("psi", result.psi);
    see("w_b", result.back);
    see("w_f", result.front);
    see("emission_only", result.emission_only);
}
