//! Every fast path on every scene of the test bed: the picture agrees with the reference within the error that is stated, and
//! is the same bit for bit from run to run, and for any number of threads.

use rayon::ThreadPoolBuilder;
use tetlux_image::{Image, compare};
use tetlux_render::{Instructions, Model, Renderer};
use tetlux_scene::{Backend, CellProjection, Method, Order, Plan};

use super::cases::CASES;
use super::meshes::{Setting, cube};
use crate::input::Input;
use crate::truth;

const SIDE: u32 = 40;

/// Larger meshes take a software adapter seconds a picture: there a coarser one of the same cube takes their place.
const MOST_BY_ADAPTER: usize = 100_000;

const THREADS: [usize; 4] = [1, 2, 3, 7];

const BUDGETS: [f64; 3] = [1e-3, 1e-2, 1e-4];

/// The picture of a method, with nothing of an earlier one at hand but what was compiled; and its stated error.
fn picture(input: &Input, renderer: &Renderer, method: Method) -> (Image, f64) {
    let scene = tetlux_scene::Scene { method, ..input.scene.clone() };
    let plan = Plan::new(&scene, &input.mesh, renderer.device()).unwrap();
    let frame = renderer.render(&scene, &Model::new(&input.mesh), &plan).unwrap();
    (frame.image, plan.stated.total().expect("what is fast is bounded"))
}

/// Whether two pictures are the same bit for bit.
fn same(a: &Image, b: &Image) -> bool {
    let bits = |image: &Image| image.pixels().iter().flatten().map(|c| c.to_bits()).collect::<Vec<_>>();
    bits(a) == bits(b)
}

/// Holds a picture to its statement; gives the share of it that is used up.
fn hold(what: &str, truth: &Image, (image, stated): &(Image, f64)) -> f64 {
    let measured = compare(truth, image, *stated).unwrap().max;
    println!("{what}: {measured:.1e} of {stated:.1e}");
    assert!(measured <= *stated, "{what}: {measured:.1e}, and {stated:.1e} is stated");
    measured / stated
}

fn truth_of(input: &Input) -> Image {
    let truth = truth::image(input, &input.scene.camera.view(input.scene.size).unwrap(), [0.0; 2]).unwrap();
    let seen = truth.pixels().iter().filter(|pixel| pixel[3] > 0.01).count();
    assert!(seen > (SIDE * SIDE / 4) as usize, "{}: {seen} pixels are seen", input.name);
    truth
}

#[test]
fn the_processor_draws_every_scene_within_its_stated_error_and_always_the_same() {
    let pools: Vec<_> = THREADS.map(|n| ThreadPoolBuilder::new().num_threads(n).build().unwrap()).into();
    for case in CASES {
        let input = case.setting.input(case.name, case.title, SIDE).unwrap();
        let truth = truth_of(&input);
        for order in [Order::Auto, Order::Pixel] {
            let method = Method { backend: Backend::Cpu, order, ..Method::default() };
            let mut pictures = Vec::new();
            for max_error in BUDGETS {
                let drawn = picture(&input, &Renderer::new(), Method { max_error, ..method });
                hold(&format!("{}, order {order}, budget {max_error:.0e}", case.name), &truth, &drawn);
                pictures.push(drawn.0);
            }
            for pool in &pools {
                let drawn = pool.install(|| picture(&input, &Renderer::new(), method).0);
                assert!(same(&drawn, &pictures[0]), "{}, {order}: {} threads", case.name, pool.current_num_threads());
            }
            for set in Instructions::all().into_iter().skip(1) {
                let draw = || picture(&input, &Renderer::new().with_instructions(set), method);
                let (drawn, name) = (draw(), set.name());
                hold(&format!("{}, order {order}, {name}", case.name), &truth, &drawn);
                assert!(same(&drawn.0, &draw().0), "{}, {order}, {name}: another run", case.name);
            }
        }
    }
}

#[test]
fn the_adapter_draws_every_scene_within_its_stated_error_and_always_the_same() {
    let renderer = Renderer::new();
    for case in CASES {
        let coarse = Setting { mesh: cube::<12>, ..case.setting };
        let large = (case.setting.mesh)().cells.len() > MOST_BY_ADAPTER;
        let input = if large { &coarse } else { &case.setting }.input(case.name, case.title, SIDE).unwrap();
        let truth = truth_of(&input);
        for projection in [CellProjection::Pt, CellProjection::Tiles, CellProjection::March] {
            let method = Method { backend: Backend::Gpu, projection, ..Method::default() };
            let what = format!("{}, {projection}", case.name);
            let drawn = picture(&input, &renderer, method);
            hold(&what, &truth, &drawn);
            assert!(same(&drawn.0, &picture(&input, &renderer, method).0), "{what}: another run");
        }
    }
}

#[test]
fn a_planted_difference_is_found() {
    let input = CASES[0].setting.input("planted", "", SIDE).unwrap();
    let truth = truth_of(&input);
    let (mut image, stated) = picture(&input, &Renderer::new(), Method { backend: Backend::Cpu, ..Method::default() });
    assert!(hold("as it is", &truth, &(image.clone(), stated)) <= 1.0);
    let whole = image.clone();
    image.pixels_mut()[7][1] += 2.0 * stated as f32;
    assert!(!same(&whole, &image));
    assert!(std::panic::catch_unwind(|| hold("planted", &truth, &(image, stated))).is_err());
}
