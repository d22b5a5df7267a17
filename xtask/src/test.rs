//! `cargo xtask test`: everything a change must pass, in one command.
//!
//! First a Vulkan driver, since the renderer's tests run on a real one (a software driver will do); then format,
//! lints, tests, examples in the docs, and the docs themselves.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use anyhow::{Context, Result, bail};

/// One command of the run.
struct Step {
    title: &'static str,
    /// Arguments of cargo.
    args: &'static [&'static str],
    env: &'static [(&'static str, &'static str)],
}

const STEPS: &[Step] = &[
    Step { title: "format", args: &["fmt", "--all", "--check"], env: &[] },
    Step {
        title: "lints",
        args: &["clippy", "--workspace", "--all-targets", "--locked", "--", "-D", "warnings"],
        env: &[],
    },
    Step {
        title: "tests",
        // All targets but the benchmarks; the examples in the docs are a step of their own.
        args: &["test", "--workspace", "--lib", "--bins", "--tests", "--examples", "--locked", "--no-fail-fast"],
        env: &[],
    },
    Step {
        title: "examples in the docs",
        args: &["test", "--workspace", "--doc", "--locked", "--no-fail-fast"],
        env: &[],
    },
    Step {
        title: "docs",
        args: &["doc", "--workspace", "--no-deps", "--locked"],
        env: &[("RUSTDOCFLAGS", "-D warnings")],
    },
];

/// Packages of Debian and Ubuntu: a software driver with the hardware ones, and the loader.
const DEBIAN_PACKAGES: [&str; 2] = ["mesa-vulkan-drivers", "libvulkan1"];

/// Provides a Vulkan driver if need be, then runs every step in order and stops at the first that fails.
///
/// # Errors
/// If no Vulkan driver is there and none can be installed, or if a step fails; the message names which.
pub(crate) fn run() -> Result<()> {
    let start = Instant::now();
    ensure_vulkan()?;
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().context("xtask lies in the workspace's root")?;
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".to_owned());
    for step in STEPS {
        println!("\n=== {}: cargo {}", step.title, step.args.join(" "));
        let start = Instant::now();
        let status = Command::new(&cargo)
            .args(step.args)
            .envs(step.env.iter().copied())
            .current_dir(root)
            .status()
            .with_context(|| format!("cannot start {cargo}"))?;
        println!("=== {}: {:.1} s", step.title, start.elapsed().as_secs_f64());
        if !status.success() {
            bail!("step \"{}\" failed ({status}); repeat it alone: cargo {}", step.title, step.args.join(" "));
        }
    }
    println!("\nall steps passed in {:.1} s", start.elapsed().as_secs_f64());
    Ok(())
}

/// On Linux, makes sure that a Vulkan loader and a driver are there; macOS and Windows bring Metal and DX12.
fn ensure_vulkan() -> Result<()> {
    if !cfg!(target_os = "linux") || has_vulkan() {
        return Ok(());
    }
    let packages = DEBIAN_PACKAGES.join(" ");
    let debian = is_debian_like(&fs::read_to_string("/etc/os-release").unwrap_or_default());
    let Some(prefix) = administrator().filter(|_| debian) else {
        bail!(
            "no Vulkan driver found. Install one, with the Vulkan loader: {packages} on Debian and Ubuntu; \
             mesa-vulkan-drivers and vulkan-loader on Fedora; vulkan-swrast and vulkan-icd-loader on Arch"
        );
    };
    println!("=== no Vulkan driver found: installing {packages}");
    let install = ["apt-get", "install", "-y", "--no-install-recommends"];
    for command in [&["apt-get", "update"][..], &[&install[..], &DEBIAN_PACKAGES].concat()] {
        let line = [prefix, &["env", "DEBIAN_FRONTEND=noninteractive"], command].concat();
        let status = Command::new(line[0]).args(&line[1..]).status().with_context(|| format!("cannot run {line:?}"))?;
        if !status.success() {
            bail!("{} failed ({status}); install {packages} by hand", line.join(" "));
        }
    }
    if !has_vulkan() {
        bail!("{packages} are installed, and still there is no Vulkan driver; see `vulkaninfo --summary`");
    }
    Ok(())
}

fn has_vulkan() -> bool {
    let variable = |name: &str| std::env::var(name).ok().filter(|value| !value.is_empty());
    has_driver(&driver_places(variable)) && has_loader(&library_folders(variable))
}

/// What to put before a command to run it as root without being asked for a password, if that can be done.
fn administrator() -> Option<&'static [&'static str]> {
    let output = |program: &str, args: &[&str]| Command::new(program).args(args).output().ok();
    if output("id", &["-u"]).is_some_and(|id| id.stdout.trim_ascii() == b"0") {
        Some(&[])
    } else if output("sudo", &["-n", "true"]).is_some_and(|sudo| sudo.status.success()) {
        Some(&["sudo", "-n"])
    } else {
        None
    }
}

/// Whether an os-release file is that of Debian, Ubuntu or one of their descendants.
fn is_debian_like(os_release: &str) -> bool {
    os_release
        .lines()
        .filter_map(|line| line.split_once('='))
        .filter(|(key, _)| matches!(*key, "ID" | "ID_LIKE"))
        .flat_map(|(_, value)| value.trim_matches(['"', '\'']).split_whitespace())
        .any(|id| matches!(id, "debian" | "ubuntu"))
}

/// Where the Vulkan loader looks for drivers: manifest files, or folders of them ("Driver Discovery" in the Vulkan
/// loader's documentation).
fn driver_places(variable: impl Fn(&str) -> Option<String>) -> Vec<PathBuf> {
    if let Some(forced) = variable("VK_DRIVER_FILES").or_else(|| variable("VK_ICD_FILENAMES")) {
        return split_paths(&forced);
    }
    let home = |name: &str, below: &str| {
        variable(name).map(PathBuf::from).or_else(|| Some(PathBuf::from(variable("HOME")?).join(below)))
    };
    let list = |name: &str, default: &str| split_paths(&variable(name).unwrap_or_else(|| default.to_owned()));

    let mut roots = Vec::new();
    roots.extend(home("XDG_CONFIG_HOME", ".config"));
    roots.extend(list("XDG_CONFIG_DIRS", "/etc/xdg"));
    roots.push(PathBuf::from("/etc"));
    roots.extend(home("XDG_DATA_HOME", ".local/share"));
    roots.extend(list("XDG_DATA_DIRS", "/usr/local/share:/usr/share"));
    let folders = roots.into_iter().map(|root| root.join("vulkan/icd.d"));
    variable("VK_ADD_DRIVER_FILES")
        .map(|added| split_paths(&added))
        .unwrap_or_default()
        .into_iter()
        .chain(folders)
        .collect()
}

/// Where the loader's library may lie: each folder and the folders in it, since distributions add one per processor.
fn library_folders(variable: impl Fn(&str) -> Option<String>) -> Vec<PathBuf> {
    let mut folders = split_paths(&variable("LD_LIBRARY_PATH").unwrap_or_default());
    folders.extend(["/lib", "/lib64", "/usr/lib", "/usr/lib64", "/usr/local/lib"].map(PathBuf::from));
    folders
}

fn split_paths(list: &str) -> Vec<PathBuf> {
    list.split(':').filter(|path| !path.is_empty()).map(PathBuf::from).collect()
}

fn has_driver(places: &[PathBuf]) -> bool {
    let is_manifest = |path: &Path| path.is_file() && path.extension().is_some_and(|extension| extension == "json");
    places.iter().any(|place| is_manifest(place) || entries(place).any(|path| is_manifest(&path)))
}

fn has_loader(folders: &[PathBuf]) -> bool {
    let holds = |folder: &Path| folder.join("libvulkan.so.1").exists();
    folders.iter().any(|folder| holds(folder) || entries(folder).any(|inner| holds(&inner)))
}

/// What a folder holds; nothing if it is absent.
fn entries(folder: &Path) -> impl Iterator<Item = PathBuf> {
    fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An environment of these variables only.
    fn variables(set: &[(&str, &str)]) -> impl Fn(&str) -> Option<String> {
        move |name| set.iter().find(|(key, _)| *key == name).map(|(_, value)| (*value).to_owned())
    }

    fn paths(list: &[&str]) -> Vec<PathBuf> {
        list.iter().map(PathBuf::from).collect()
    }

    #[test]
    fn debian_and_its_descendants_are_known_by_id_or_id_like() {
        assert!(is_debian_like("PRETTY_NAME=\"Debian GNU/Linux\"\nID=debian\n"));
        assert!(is_debian_like("ID=ubuntu\nID_LIKE=debian\n"));
        assert!(is_debian_like("ID=pop\nID_LIKE=\"ubuntu debian\"\n"));
        for other in ["", "ID=fedora\n", "ID=arch\nHOME_URL=https://debian.example\n", "VARIANT_ID=debian\n"] {
            assert!(!is_debian_like(other), "{other}");
        }
    }

    #[test]
    fn without_variables_the_standard_folders_are_searched() {
        let system =
            ["/etc/xdg/vulkan/icd.d", "/etc/vulkan/icd.d", "/usr/local/share/vulkan/icd.d", "/usr/share/vulkan/icd.d"];
        assert_eq!(driver_places(variables(&[])), paths(&system));

        let found = driver_places(variables(&[("HOME", "/u"), ("XDG_DATA_DIRS", "/a:/b"), ("XDG_CONFIG_HOME", "/c")]));
        let expected = [
            "/c/vulkan/icd.d",
            "/etc/xdg/vulkan/icd.d",
            "/etc/vulkan/icd.d",
            "/u/.local/share/vulkan/icd.d",
            "/a/vulkan/icd.d",
            "/b/vulkan/icd.d",
        ];
        assert_eq!(found, paths(&expected));
    }

    #[test]
    fn driver_files_replace_the_folders_and_the_new_name_wins() {
        let both = [("VK_DRIVER_FILES", "/a.json:/b"), ("VK_ICD_FILENAMES", "/old.json"), ("HOME", "/u")];
        assert_eq!(driver_places(variables(&both)), paths(&["/a.json", "/b"]));
        assert_eq!(driver_places(variables(&both[1..])), paths(&["/old.json"]));
        let added = driver_places(variables(&[("VK_ADD_DRIVER_FILES", "/c.json")]));
        assert_eq!((added[0].as_path(), added.len()), (Path::new("/c.json"), 5));
    }

    #[test]
    fn a_driver_is_a_json_file_named_or_in_a_named_folder() {
        let folder = tempfile::tempdir().unwrap();
        let manifest = folder.path().join("software.json");
        let places = [folder.path().to_owned()];
        fs::write(folder.path().join("readme.txt"), "").unwrap();
        assert!(!has_driver(&places) && !has_driver(std::slice::from_ref(&manifest)) && !has_driver(&[]));
        fs::write(&manifest, "{}").unwrap();
        assert!(has_driver(&places) && has_driver(&[manifest]));
    }

    #[test]
    fn the_loader_is_found_in_a_folder_or_one_below() {
        let folder = tempfile::tempdir().unwrap();
        let inner = folder.path().join("x86_64-linux-gnu");
        fs::create_dir(&inner).unwrap();
        let folders = [folder.path().to_owned()];
        fs::write(inner.join("libvulkan_lvp.so"), "").unwrap(); // a driver, not the loader
        assert!(!has_loader(&folders));
        fs::write(inner.join("libvulkan.so.1"), "").unwrap();
        assert!(has_loader(&folders) && has_loader(&[inner]));
    }
}
