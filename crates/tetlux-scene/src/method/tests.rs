use super::*;

#[test]
fn a_march_is_refused_what_it_does_not_do() {
    let march = Method { projection: CellProjection::March, ..Method::default() };
    assert_eq!(march.refusal(), None);
    assert_eq!(Method { order: Order::None, target: Target::Rgba32f, ..march }.refusal(), None);
    assert_eq!(Method { integrator: Integrator::PreintQ, ..march }.refusal(), None);
    for (method, named) in [
        (Method { order: Order::Centroid, ..march }, "needs no order: leave out --order centroid"),
        (Method { target: Target::Rgba8, ..march }, "--target rgba8"),
        (Method { interpolation: Interpolation::Ray, ..march }, "--interpolation ray"),
        (Method { backend: Backend::Cpu, ..march }, "--backend gpu"),
    ] {
        let refusal = method.refusal().unwrap();
        assert!(refusal.contains("march") && refusal.contains(named), "{refusal}");
    }
}

#[test]
fn tiles_are_refused_what_they_do_not_do() {
    let tiles = Method { projection: CellProjection::Tiles, ..Method::default() };
    assert_eq!(tiles.refusal(), None);
    let alike = (Order::Exact, Interpolation::Ray, Target::Rgba32f);
    assert_eq!(Method { order: alike.0, interpolation: alike.1, target: alike.2, ..tiles }.refusal(), None);
    for (method, named) in [
        (Method { order: Order::Pixel, ..tiles }, "pixel"),
        (Method { target: Target::Rgba8, ..tiles }, "--target rgba8"),
        (Method { interpolation: Interpolation::Perspective, ..tiles }, "--interpolation perspective"),
        (Method { backend: Backend::Cpu, ..tiles }, "--backend gpu"),
        (Method { integrator: Integrator::PreintQ, ..tiles }, "preint-q"),
    ] {
        let refusal = method.refusal().unwrap();
        assert!(refusal.contains("tiles") && refusal.contains(named), "{refusal}");
    }
}

#[test]
fn balanced_is_refused_what_it_does_not_do() {
    let balanced = Method { projection: CellProjection::Balanced, ..Method::default() };
    assert_eq!(balanced.refusal(), None);
    for (method, named) in [
        (Method { classification: Classification::Vertex, ..balanced }, "--classification vertex"),
        (Method { interpolation: Interpolation::Ray, ..balanced }, "--interpolation ray"),
    ] {
        let refusal = method.refusal().unwrap();
        assert!(refusal.contains("balanced") && refusal.contains(named), "{refusal}");
    }
}

#[test]
fn every_value_is_read_back_from_its_name() {
    for &order in Order::ALL {
        assert_eq!(order.to_string().parse(), Ok(order));
    }
    assert_eq!(Backend::Gpu.to_string(), "gpu");
    assert_eq!(Integrator::PreintLog.to_string(), "preint-log");
    assert_eq!(Target::Rgba8Dither.to_string(), "rgba8-dither");
    assert_eq!(TablePrecision::F16.to_string(), "f16");
    let error = "nearest".parse::<Integrator>().unwrap_err().to_string();
    assert!(error.contains("nearest") && error.contains("direct") && error.contains("average"), "{error}");
}

#[test]
fn what_cannot_be_is_refused_with_its_reason() {
    let refused = |change: fn(&mut Method)| {
        let mut method = Method::default();
        change(&mut method);
        method.refusal()
    };
    assert_eq!(refused(|_| ()), None);
    for (change, words) in [
        (
            (|m| (m.integrator, m.classification) = (Integrator::Preint, Classification::Vertex)) as fn(&mut Method),
            ["preint", "vertex"],
        ),
        (|m| (m.integrator, m.classification) = (Integrator::PreintQ, Classification::PostClip), ["preint-q", "clip"]),
        (|m| (m.projection, m.interpolation) = (CellProjection::Gator, Interpolation::Ray), ["gator", "perspective"]),
        (|m| (m.backend, m.target) = (Backend::Cpu, Target::Rgba8), ["rgba8", "--backend gpu"]),
        (|m| (m.backend, m.projection) = (Backend::Cpu, CellProjection::Pt), ["pt", "--backend gpu"]),
        (|m| (m.order, m.integrator) = (Order::Pixel, Integrator::Q), ["pixel", "\"q\""]),
        (|m| (m.backend, m.order) = (Backend::Gpu, Order::Pixel), ["pixel", "cpu"]),
        (|m| (m.integrator, m.table_precision) = (Integrator::Direct, TablePrecision::U8), ["direct", "table"]),
        (|m| (m.integrator, m.pieces) = (Integrator::Analytic, Some(10)), ["analytic", "approximate"]),
        (|m| (m.integrator, m.pieces) = (Integrator::Approximate, Some(0)), ["0 pieces", "1 to 1000"]),
        (|m| (m.integrator, m.classification) = (Integrator::Adaptive, Classification::Vertex), ["adaptive", "vertex"]),
    ] {
        let reason = refused(change).unwrap_or_else(|| panic!("{words:?} is not refused"));
        assert!(words.iter().all(|word| reason.contains(word)), "{words:?}: {reason}");
    }
}

#[test]
fn nothing_decided_is_left_open_or_refused() {
    // The plan decides the projection, by the adapter.
    for &projection in CellProjection::ALL.iter().filter(|p| **p != CellProjection::Auto) {
        let decided = Method { projection, ..Method::default() }.decided();
        // Two come by their segments in their own way, and are refused a choice that says otherwise.
        if !matches!(projection, CellProjection::Balanced | CellProjection::March) {
            assert_eq!(decided.refusal(), None);
        }
        assert!(decided.interpolation != Interpolation::Auto);
        assert!(decided.classification != Classification::Auto);
    }
}
