//! How long a way of drawing may take, so that a bench ends: what is slow is drawn once, and what is very slow is not asked
//! for more.

use tetlux_scene::Work;

/// Processor seconds of a frame. What takes longer is told by one frame; on a software adapter that is its
/// first, compiling included.
pub(crate) const ONCE: f64 = 1.0;

/// Processor seconds of a frame. A way that took longer is not asked for pictures of as much work and more.
pub(crate) const MOST: f64 = 6.0;

/// The ways that took longer than that.
#[derive(Default)]
pub(crate) struct Patience {
    lost: Vec<Lost>,
}

struct Lost {
    way: &'static str,
    work: f64,
    seconds: f64,
    /// The scene.
    on: String,
}

/// One measure of how much there is to draw.
fn size(work: &Work) -> f64 {
    work.cells + work.fragments
}

impl Patience {
    /// Why a way is not to be asked for a picture, if so.
    pub(crate) fn refusal(&self, way: &str, work: &Work) -> Option<String> {
        let lost = self.lost.iter().find(|lost| lost.way == way && lost.work <= size(work))?;
        Some(format!("not measured: {:.0} s of processor time on {}, which is less", lost.seconds, lost.on))
    }

    /// Notes what a frame took.
    pub(crate) fn note(&mut self, way: &'static str, work: &Work, seconds: f64, on: &str) {
        if seconds > MOST {
            self.lost.push(Lost { way, work: size(work), seconds, on: on.to_owned() });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_slow_is_not_asked_for_more() {
        let work = |cells| Work { cells, fragments: 10.0 * cells };
        let mut patience = Patience::default();
        patience.note("fast", &work(1e6), 0.9 * MOST, "a box");
        patience.note("slow", &work(1e5), 1.5 * MOST, "a box");
        assert_eq!(patience.refusal("fast", &work(1e7)), None);
        assert_eq!(patience.refusal("slow", &work(0.9e5)), None, "less may be tried");
        let why = patience.refusal("slow", &work(1e6)).unwrap();
        assert!(why.contains("9 s") && why.contains("a box"), "{why}");
    }
}
