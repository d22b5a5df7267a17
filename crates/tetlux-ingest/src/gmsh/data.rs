//! Post-processing views: values on nodes or elements, a section for each step.

use std::collections::BTreeMap;

use tetlux_mesh::{Field, Location};

use super::input::Input;
use super::tags::Tags;
use crate::source::Source;
use crate::{IngestError, MixedMesh};

/// So many values there may be whatever the length of the file.
const FREE_VALUES: usize = 1 << 16;

/// The sections of values of a file.
#[derive(Default)]
pub(super) struct Views(Vec<Section>);

/// Values of one step, or of the part of one that lies in one partition.
struct Section {
    name: String,
    location: Location,
    step: i64,
    components: usize,
    tags: Vec<u64>,
    values: Vec<f64>,
}

impl Views {
    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Reads a section after its heading.
    pub(super) fn read(&mut self, input: &mut Input, location: Location) -> Result<(), IngestError> {
        let words = &mut input.words;
        let mut name = None;
        let strings: u64 = words.number("the number of texts")?;
        words.line();
        for _ in 0..strings {
            let line = words.line().ok_or_else(|| words.cut("a text of the view"))?.trim_ascii();
            let text = line.strip_prefix(b"\"").and_then(|l| l.strip_suffix(b"\"")).unwrap_or(line);
            name.get_or_insert_with(|| String::from_utf8_lossy(text).into_owned());
        }
        let reals: u64 = words.number("the number of real numbers")?;
        words.numbers::<f64>("the time of the view", reals)?;
        let whole: u64 = words.number("the number of whole numbers")?;
        let whole: Vec<i64> = words.numbers("step, components and number of values of the view", whole)?;
        let &[step, components, count, ..] = whole.as_slice() else {
            let remedy = "there must be three: step, components and number of values";
            return Err(words.malformed("the whole numbers of the view", whole.len(), remedy));
        };
        let Some(components) = usize::try_from(components).ok().filter(|n| (1..=9).contains(n)) else {
            return Err(words.malformed("the components of the view", components, "they must be 1, 3 or 9"));
        };
        let count = input.tag(count)?;
        input.begin_binary();
        let (binary, least) = (4 + 8 * components as u64, 2 + 2 * components as u64);
        let mut tags = Vec::with_capacity(input.bounded(count, binary, least));
        let mut values = Vec::with_capacity(tags.capacity() * components);
        for _ in 0..count {
            let [tag] = input.ints_of("a tag of the view")?;
            tags.push(input.tag(tag)?);
            values.extend(input.reals("the values of the view", components as u64)?);
        }
        let name = name.unwrap_or_else(|| format!("view {}", self.0.len()));
        self.0.push(Section { name, location, step, components, tags, values });
        Ok(())
    }

    /// Makes a field of each view: of the step numbered `time` among its own from 0 on, or the last, which is that of
    /// a view with fewer steps too. Where nothing is given it is NaN.
    pub(super) fn assemble(
        self,
        source: &Source,
        mesh: &mut MixedMesh,
        [nodes, elements]: [&Tags; 2],
        time: Option<usize>,
    ) -> Result<(), IngestError> {
        // Views on few nodes of many could fill any memory. Those on all nodes have more bytes than values.
        let mut budget = source.bytes.len().max(FREE_VALUES);
        let mut most = 0;
        let mut views: BTreeMap<(String, bool, usize), Vec<Section>> = BTreeMap::new();
        for section in self.0 {
            let key = (section.name.clone(), section.location == Location::Cell, section.components);
            views.entry(key).or_default().push(section);
        }
        for ((name, on_cells, components), sections) in views {
            let mut steps: Vec<i64> = sections.iter().map(|s| s.step).collect();
            steps.sort_unstable();
            steps.dedup();
            most = most.max(steps.len());
            let last = steps.len() - 1;
            let chosen = time.unwrap_or(last).min(last);
            if last > 0 {
                mesh.notes.push(format!("field \"{name}\" has {} steps: step {chosen} (from 0 on) is read", last + 1));
            }
            let (tags, tuples, location) = match on_cells {
                false => (nodes, mesh.points.len(), Location::Point),
                true => (elements, mesh.cells.types.len(), Location::Cell),
            };
            let Some(rest) = budget.checked_sub(tuples * components) else {
                mesh.notes.push(format!("field \"{name}\" is on few {} of many: it is left out", location.plural()));
                continue;
            };
            budget = rest;
            let mut values = vec![f64::NAN; tuples * components];
            let mut given = vec![false; tuples];
            for section in sections.iter().filter(|s| s.step == steps[chosen]) {
                for (&tag, from) in section.tags.iter().zip(section.values.chunks_exact(components)) {
                    // Elements without volume have values too: they are passed over with these.
                    let Some(place) = tags.get(tag) else { continue };
                    let place = place as usize;
                    given[place] = true;
                    values[place * components..][..components].copy_from_slice(from);
                }
            }
            let missing = given.iter().filter(|&&given| !given).count();
            if missing == tuples {
                mesh.notes.push(format!("field \"{name}\" has no value on any cell with a volume: it is left out"));
                continue;
            }
            let note = format!("field \"{name}\" has no value on {missing} of {tuples} {}: NaN", location.plural());
            mesh.notes.extend((missing > 0).then_some(note));
            mesh.fields.push(Field { name, location, components, values });
        }
        match time {
            Some(step) if step >= most => {
                let (step, count) = (step as u64, most as u64);
                Err(IngestError::NoSuchTimeStep { path: source.path.clone(), step, count })
            }
            _ => Ok(()),
        }
    }
}
