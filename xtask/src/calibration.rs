//! What this machine's graphics adapters were measured to take, kept in the cache folder between runs.

use std::path::Path;
use std::sync::{Mutex, PoisonError};

use anyhow::Result;
use serde::{Deserialize, Serialize};
use tetlux_image::write_atomically;
use tetlux_ingest::Cache;
use tetlux_mesh::TetMesh;
use tetlux_render::Renderer;
use tetlux_scene::{Cost, Costs, Device, Plan, Scene};

use crate::progress;

/// In the cache folder.
const FILE: &str = "adapter-costs.json";

/// Adapters that are kept: those measured last.
const MOST: usize = 16;

/// A file of more bytes is not ours.
const LARGEST: u64 = 1 << 16;

/// One adapter, with one driver, as one version of tetlux measured it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Kept {
    adapter: String,
    driver: String,
    version: String,
    costs: Costs,
}

impl Kept {
    fn is_of(&self, device: &Device) -> bool {
        self.adapter == device.name && self.driver == device.driver && self.version == env!("CARGO_PKG_VERSION")
    }

    pub(crate) fn is_sound(&self) -> bool {
        let Costs { pt, tiles, march } = self.costs;
        let sound = |cost: Cost| [cost.picture, cost.cell, cost.fragment].iter().all(|c| c.is_finite() && *c >= 0.0);
        [pt, tiles, march].into_iter().all(sound)
    }
}

/// What the adapter takes, found when a plan first follows it: for all pictures of a command.
#[derive(Default)]
pub(crate) struct Calibration {
    costs: Mutex<Option<Costs>>,
}

impl Calibration {
    /// The adapter there is, with what it was measured to take where a scene's plan follows that: measured now if it never
    /// was.
    pub(crate) fn device(&self, scene: &Scene, mesh: &TetMesh, renderer: &Renderer) -> Result<Option<Device>> {
        let Some(device) = renderer.device() else { return Ok(None) };
        if !Plan::follows_costs(scene, mesh, Some(device))? {
            return Ok(Some(device.clone()));
        }
        // Frames that are made at a time wait for one measurement; one that failed left nothing half done.
        let mut known = self.costs.lock().unwrap_or_else(PoisonError::into_inner);
        let costs = match *known {
            Some(costs) => costs,
            None => *known.insert(kept_or_measured(device, renderer)?),
        };
        Ok(Some(Device { costs: Some(costs), ..device.clone() }))
    }
}

/// What an adapter takes, as it is kept or else as it is measured now.
fn kept_or_measured(device: &Device, renderer: &Renderer) -> Result<Costs> {
    let file = Cache::of_user().map(|cache| cache.folder.join(FILE));
    let mut all = file.as_deref().map_or(Vec::new(), read);
    if let Some(kept) = all.iter().find(|kept| kept.is_of(device)) {
        return Ok(kept.costs);
    }
    let costs = progress::during("measuring what the adapter takes", || renderer.costs())?;
    let (adapter, driver) = (device.name.clone(), device.driver.clone());
    all.insert(0, Kept { adapter, driver, version: env!("CARGO_PKG_VERSION").into(), costs });
    all.truncate(MOST);
    // That it cannot be kept is no fault of the picture's: it is measured again.
    if let Some(file) = &file {
        let _ = write(file, &all);
    }
    Ok(costs)
}

/// Removes what is kept in a cache folder.
pub(crate) fn forget(folder: &Path) -> std::io::Result<()> {
    match std::fs::remove_file(folder.join(FILE)) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    }
}

/// All that is kept and sound; what cannot be read is nothing.
pub(crate) fn read(file: &Path) -> Vec<Kept> {
    let small = std::fs::metadata(file).is_ok_and(|metadata| metadata.len() <= LARGEST);
    let text = if small { std::fs::read(file).unwrap_or_default() } else { Vec::new() };
    let mut all: Vec<Kept> = serde_json::from_slice(&text).unwrap_or_default();
    all.retain(Kept::is_sound);
    all
}

fn write(file: &Path, all: &[Kept]) -> Result<()> {
    if let Some(folder) = file.parent() {
        std::fs::create_dir_all(folder)?;
    }
    let text = serde_json::to_vec_pretty(all)?;
    Ok(write_atomically(file, |out| out.write_all(&text))?)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kept(adapter: &str, cell: f64) -> Kept {
        let cost = Cost { picture: 1e5, cell, fragment: 0.5 };
        let costs = Costs { pt: cost, tiles: cost, march: cost };
        Kept { adapter: adapter.into(), driver: "d 1".into(), version: env!("CARGO_PKG_VERSION").into(), costs }
    }

    #[test]
    fn what_is_kept_is_read_back_and_what_is_spoilt_is_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("deep").join(FILE);
        assert!(read(&file).is_empty());
        let all = [kept("a", 3.0), kept("b", 4.0)];
        write(&file, &all).unwrap();
        assert_eq!(read(&file), all);
        // Costs that cannot be, of an adapter whose others stay.
        write(&file, &[kept("a", -1.0), kept("b", 4.0)]).unwrap();
        assert_eq!(read(&file), [kept("b", 4.0)]);
        let text = std::fs::read(&file).unwrap();
        forget(file.parent().unwrap()).unwrap();
        forget(file.parent().unwrap()).unwrap();
        assert!(read(&file).is_empty());
        for end in 0..text.len() - 1 {
            std::fs::write(&file, &text[..end]).unwrap();
            assert!(read(&file).is_empty(), "cut at {end}");
        }
        std::fs::write(&file, String::from_utf8(text).unwrap().replace("fragment", "figment")).unwrap();
        assert!(read(&file).is_empty(), "another version's");
    }

    #[test]
    fn only_the_adapter_the_driver_and_the_version_that_were_measured_count() {
        let (name, driver) = ("a".to_string(), "d 1".to_string());
        let device = Device { name, driver, software: false, blends_f32: true, norm16: true, costs: None };
        assert!(kept("a", 1.0).is_of(&device));
        assert!(!kept("b", 1.0).is_of(&device));
        assert!(!Kept { driver: "d 2".into(), ..kept("a", 1.0) }.is_of(&device));
        assert!(!Kept { version: "0.0.0".into(), ..kept("a", 1.0) }.is_of(&device));
    }
}
