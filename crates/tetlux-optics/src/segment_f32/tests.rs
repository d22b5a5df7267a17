use super::*;
use crate::segment::weights;

const SHADER: &str = include_str!("../../../../shaders/lib/segment.wgsl");

/// Relative error of the weights against f64; the fits alone have 4.2e-6.
const RELATIVE: f64 = 1e-5;

/// Absolute error of the weights against f64.
const ABSOLUTE: f64 = 2e-6;

/// Below this f32 has no relative accuracy to keep: values are denormal or nearly so.
const SMALLEST: f64 = 1e-37;

/// Deterministic numbers (Marsaglia's xorshift64): the figures are the same on every run.
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Log-uniform between two powers of ten.
    fn decades(&mut self, low: f64, high: f64) -> f32 {
        10.0_f64.powf(low + (high - low) * self.unit()) as f32
    }
}

/// Errors of (w_b, w_f): the larger relative and absolute one, by the f64 weights of the same f32 inputs.
fn errors(result: [f32; 3], a: f32, b: f32) -> (f64, f64) {
    let exact = weights(f64::from(a), f64::from(b));
    let pairs = [(result[0], exact.alpha), (result[1], exact.back), (result[2], exact.front)];
    pairs.into_iter().fold((0.0, 0.0), |(relative, absolute): (f64, f64), (value, exact)| {
        // Not finite must win over every finite error.
        let error = if value.is_finite() { (f64::from(value) - exact).abs() } else { f64::INFINITY };
        let share = if error == 0.0 || (exact < SMALLEST && error < SMALLEST) { 0.0 } else { error / exact };
        (relative.max(share), absolute.max(error))
    })
}

type Generator = fn(&mut Random) -> (f32, f32);

/// The regimes in which closed forms lose their digits in different ways.
const SETS: [(&str, Generator); 9] = [
    ("log-uniform", |random| (random.decades(-8.0, 6.0), random.decades(-8.0, 6.0))),
    ("nearly equal", |random| {
        let b = random.decades(-8.0, 6.0);
        let sign = if random.unit() < 0.5 { -1.0 } else { 1.0 };
        (b * (1.0 + sign * random.decades(-7.0, -2.0)), b)
    }),
    ("equal", |random| {
        let b = random.decades(-8.0, 6.0);
        (b, b)
    }),
    ("thin", |random| (random.decades(-8.0, -3.0), random.decades(-8.0, -3.0))),
    ("usual", |random| ((0.01 + 19.99 * random.unit()) as f32, (0.01 + 19.99 * random.unit()) as f32)),
    ("dense back", |random| {
        let a = random.decades(0.0, 6.0);
        (a, a * random.decades(-10.0, -4.0))
    }),
    ("dense front", |random| {
        let b = random.decades(0.0, 6.0);
        (b * random.decades(-10.0, -4.0), b)
    }),
    ("dense", |random| (random.decades(3.0, 6.0), random.decades(3.0, 6.0))),
    ("one end empty", |random| {
        let depth = random.decades(-8.0, 6.0);
        if random.unit() < 0.5 { (depth, 0.0) } else { (0.0, depth) }
    }),
];

#[test]
fn direct_weights_keep_their_error_in_every_regime() {
    let mut random = Random(0x9E37_79B9_7F4A_7C15);
    for (name, generate) in SETS {
        let (mut relative, mut absolute) = (0.0_f64, 0.0_f64);
        for _ in 0..20_000 {
            let (a, b) = generate(&mut random);
            let result = weights_direct(a, b);
            let error = errors(result, a, b);
            relative = relative.max(error.0);
            absolute = absolute.max(error.1);
            // One rounding of each product and of their sum.
            assert!((result[1] + result[2] - result[0]).abs() <= 2.0 * f32::EPSILON * result[0], "{a} {b}");
        }
        println!("{name}: relative {relative:.2e}, absolute {absolute:.2e}");
        assert!(relative <= RELATIVE && absolute <= ABSOLUTE, "{name}: {relative:.2e}, {absolute:.2e}");
    }
}

#[test]
fn the_comparison_sees_a_planted_difference() {
    let (a, b) = (0.3, 0.2);
    let good = weights_direct(a, b);
    assert!(errors(good, a, b).0 <= RELATIVE);
    for index in 0..3 {
        for wrong in [good[index] * (1.0 + 3e-5), f32::NAN, f32::INFINITY, 0.0] {
            let mut bad = good;
            bad[index] = wrong;
            assert!(errors(bad, a, b).0 > RELATIVE, "{bad:?}");
            assert!(wrong.is_finite() || errors(bad, a, b).1 > ABSOLUTE);
        }
    }
}

#[test]
fn any_input_gives_finite_weights() {
    let inputs = [
        0.0,
        -0.0,
        1e-45,
        1e-40,
        f32::MIN_POSITIVE,
        1e-30,
        1e-7,
        1.0,
        3.0,
        1e6,
        1e14,
        1e15,
        1e16,
        f32::MAX,
        f32::INFINITY,
        f32::NEG_INFINITY,
        f32::NAN,
        -f32::NAN,
        -1.0,
        -1e-40,
    ];
    for a in inputs {
        for b in inputs {
            for [alpha, back, front] in [weights_direct(a, b), weights_average(a, b)] {
                let all = [alpha, back, front];
                assert!(all.iter().all(|w| (0.0..=1.0).contains(w)), "({a}, {b}): {all:?}");
                // Roundings of each product and of their sum; of denormals, units of the last place.
                let rounding = 2.0 * f32::EPSILON * alpha + 3.0 * f32::from_bits(1);
                assert!((back + front - alpha).abs() <= rounding, "({a}, {b}): {all:?}");
            }
            assert_eq!(weights_direct(a, b), weights_direct(clean(a), clean(b)));
        }
    }
}

#[test]
fn empty_and_opaque_limits() {
    for nothing in [0.0, -0.0, -1.0, f32::NAN, f32::NEG_INFINITY] {
        assert_eq!(weights_direct(nothing, nothing), [0.0; 3]);
        assert_eq!(weights_average(nothing, nothing), [0.0; 3]);
    }
    // An infinite back end: q tends to sqrt(pi / (2 a)), at a = 1e15 4.0e-8; an infinite front end: 1 / b.
    let [alpha, back, front] = weights_direct(f32::INFINITY, 0.0);
    assert!(alpha == 1.0 && front >= 1.0 - f32::EPSILON && (back / 3.963_327e-8 - 1.0).abs() < 1e-5, "{back}");
    let [alpha, back, front] = weights_direct(0.0, f32::INFINITY);
    assert!(alpha == 1.0 && front == 1.0 && (back / 1e-15 - 1.0).abs() < 1e-5, "{back}");
    // Thin: w_b = a / 3 + b / 6.
    assert_eq!(weights_average(0.2, 0.4)[1], 0.5 * opacity(0.3));
    let [_, back, front] = weights_direct(6e-20, 0.0);
    assert!((back / 2e-20 - 1.0).abs() < 1e-5 && (front / 1e-20 - 1.0).abs() < 1e-5);
}

#[test]
fn opacity_keeps_relative_accuracy() {
    let mut random = Random(1);
    for _ in 0..20_000 {
        let x = random.decades(-37.0, 3.0);
        let exact = -(-f64::from(x)).exp_m1();
        // A few roundings of the series; of 1 - exp(-x) from 0.25 on.
        assert!((f64::from(opacity(x)) / exact - 1.0).abs() < 5e-7, "{x}");
    }
}

/// The numbers of the constant `name` in WGSL text, in order.
fn shader_constant(shader: &str, name: &str) -> Vec<f32> {
    let start = shader.find(&format!("const {name} =")).unwrap();
    let text = &shader[start..][..shader[start..].find(';').unwrap()];
    let text = text.split_once('=').unwrap().1;
    // Type parameters hold counts, not coefficients.
    let mut depth = 0;
    let outside: String = text
        .chars()
        .map(|c| {
            depth += i32::from(c == '<') - i32::from(c == '>');
            if depth == 0 && c != '>' { c } else { ' ' }
        })
        .collect();
    outside.split(|c: char| !c.is_ascii_digit() && !".-e".contains(c)).filter_map(|word| word.parse().ok()).collect()
}

#[test]
fn shader_and_twin_have_the_same_constants() {
    assert_eq!(shader_constant(SHADER, "Q_SMALL"), Q_SMALL.concat());
    assert_eq!(shader_constant(SHADER, "ERFCX_P"), ERFCX_P);
    assert_eq!(shader_constant(SHADER, "ERFCX_Q"), ERFCX_Q);
    assert_eq!(shader_constant(SHADER, "DAWSON_P"), DAWSON_P);
    assert_eq!(shader_constant(SHADER, "DAWSON_Q"), DAWSON_Q);
    assert_eq!(shader_constant(SHADER, "SQRT_PI"), [SQRT_PI]);
    assert_eq!(shader_constant(SHADER, "MAX_DEPTH"), [MAX_DEPTH]);
    // The last digit of the last coefficient changed.
    let changed = SHADER.replace("1.4655121e-6", "1.4655123e-6");
    assert_ne!(shader_constant(&changed, "Q_SMALL"), Q_SMALL.concat());
}

/// A function's body as bare arithmetic: what remains equal between the two languages.
fn numbers_of(source: &str, function: &str) -> Vec<f32> {
    let start = source.find(&format!("fn {function}(")).unwrap();
    let body = &source[start..][..source[start..].find("\n}").unwrap()];
    let code: Vec<&str> = body.lines().skip(1).map(|line| line.split("//").next().unwrap()).collect();
    let code = code.join("\n");
    let words = code.split(|c: char| !c.is_ascii_alphanumeric() && !"._-".contains(c));
    words.filter_map(|word| word.trim_matches('-').trim_end_matches('.').parse().ok()).collect()
}

#[test]
fn shader_and_twin_have_the_same_functions() {
    let twin = include_str!("../segment_f32.rs");
    let functions: Vec<&str> = SHADER.lines().filter_map(|line| line.strip_prefix("fn ")?.split('(').next()).collect();
    assert_eq!(functions.len(), twin.matches("\nfn ").count() + twin.matches("\npub fn ").count());
    for function in functions {
        let mut ours = numbers_of(twin, function);
        let mut theirs = numbers_of(SHADER, function);
        // Method and function calls order the same literals differently.
        ours.sort_by(f32::total_cmp);
        theirs.sort_by(f32::total_cmp);
        assert_eq!(ours, theirs, "{function}");
    }
    let changed = SHADER.replace("3.0 * (1.0 - x / 4.0", "3.0 * (1.0 - x / 5.0");
    assert_ne!(numbers_of(&changed, "opacity"), numbers_of(SHADER, "opacity"));
}

#[test]
fn the_shader_is_valid() {
    let module =
        naga::front::wgsl::parse_str(SHADER).unwrap_or_else(|error| panic!("{}", error.emit_to_string(SHADER)));
    let flags = naga::valid::ValidationFlags::all();
    naga::valid::Validator::new(flags, naga::valid::Capabilities::empty()).validate(&module).unwrap();
    assert!(module.entry_points.is_empty() && module.global_variables.is_empty());
}
