//! Every WGSL module of tetlux, by name, and the composer that joins them.
//!
//! A module says what it needs with `import package::lib::name::{item, other};` (a subset of WESL: the files stay valid
//! WESL). [`compose`] puts every module that an entry needs before it, each once. Items keep their names, so the
//! names of all modules are one space.
//!
//! ```
//! let source = tetlux_shaders::compose("lib::segment")?;
//! assert!(source.contains("fn weights_direct"));
//! # Ok::<(), tetlux_shaders::ComposeError>(())
//! ```

/// Every module: its name and its text.
pub const MODULES: &[(&str, &str)] = &[
    ("lib::cell", include_str!("../lib/cell.wgsl")),
    ("lib::mesh", include_str!("../lib/mesh.wgsl")),
    ("lib::published", include_str!("../lib/published.wgsl")),
    ("lib::segment", include_str!("../lib/segment.wgsl")),
    ("lib::silhouette", include_str!("../lib/silhouette.wgsl")),
    ("lib::symmetric", include_str!("../lib/symmetric.wgsl")),
    ("lib::transfer", include_str!("../lib/transfer.wgsl")),
    ("lib::view", include_str!("../lib/view.wgsl")),
    ("stages::draw", include_str!("../stages/draw.wgsl")),
    ("stages::project", include_str!("../stages/project.wgsl")),
];

/// Why modules could not be joined.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ComposeError {
    /// No module of that name.
    #[error("there is no shader module \"{name}\"{}; there are: {}", place(importer), names())]
    NoModule {
        /// The name asked for.
        name: String,
        /// The importing module and line; empty for the entry.
        importer: String,
    },
    /// An import that is not of the form `import package::module::{item, item};`.
    #[error("{importer}: \"{text}\" is not of the form import package::module::{{item, item}};")]
    Syntax {
        /// The importing module and line.
        importer: String,
        /// The line.
        text: String,
    },
    /// A module without the item that is imported from it.
    #[error("{importer}: module \"{module}\" has no item \"{item}\"")]
    NoItem {
        /// The importing module and line.
        importer: String,
        /// The module imported from.
        module: String,
        /// The item it lacks.
        item: String,
    },
    /// A module that needs itself.
    #[error("shader module \"{name}\" imports itself through {through}")]
    Cycle {
        /// The module.
        name: String,
        /// The modules in between.
        through: String,
    },
}

fn place(importer: &str) -> String {
    if importer.is_empty() { String::new() } else { format!(" (imported by {importer})") }
}

fn names() -> String {
    MODULES.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", ")
}

/// The text of a module with all it imports, directly or not, ahead of it.
pub fn compose(entry: &str) -> Result<String, ComposeError> {
    compose_from(MODULES, entry)
}

fn compose_from(modules: &[(&str, &str)], entry: &str) -> Result<String, ComposeError> {
    let mut output = String::new();
    append(modules, entry, "", &mut Vec::new(), &mut Vec::new(), &mut output)?;
    Ok(output)
}

/// Appends a module after those it imports; `path` holds the modules that are being appended, `done` those that are.
fn append(
    modules: &[(&str, &str)],
    name: &str,
    importer: &str,
    path: &mut Vec<String>,
    done: &mut Vec<String>,
    output: &mut String,
) -> Result<(), ComposeError> {
    let text = find(modules, name, importer)?;
    if path.iter().any(|p| p == name) {
        return Err(ComposeError::Cycle { name: name.into(), through: path.join(", ") });
    }
    if done.iter().any(|d| d == name) {
        return Ok(());
    }
    path.push(name.into());
    let mut body = String::new();
    for (number, line) in text.lines().enumerate() {
        if !line.starts_with("import ") {
            body.push_str(line);
            body.push('\n');
            continue;
        }
        let importer = format!("{name}:{}", number + 1);
        let (module, items) =
            parse_import(line).ok_or_else(|| ComposeError::Syntax { importer: importer.clone(), text: line.into() })?;
        let imported = find(modules, &module, &importer)?;
        for item in items {
            if !declares(imported, item) {
                return Err(ComposeError::NoItem { importer, module, item: item.into() });
            }
        }
        append(modules, &module, &importer, path, done, output)?;
        // An empty line in place of the import keeps the module's line numbers.
        body.push('\n');
    }
    output.push_str(&format!("// ---- {name}\n{body}"));
    path.pop();
    done.push(name.into());
    Ok(())
}

fn find<'a>(modules: &[(&str, &'a str)], name: &str, importer: &str) -> Result<&'a str, ComposeError> {
    let found = modules.iter().find(|(module, _)| *module == name);
    found.map(|(_, text)| *text).ok_or_else(|| ComposeError::NoModule { name: name.into(), importer: importer.into() })
}

/// Module and items of `import package::a::b::{x, y};` or `import package::a::b::x;`.
fn parse_import(line: &str) -> Option<(String, Vec<&str>)> {
    let path = line.strip_prefix("import package::")?.trim_end().strip_suffix(';')?;
    let (module, items) = path.rsplit_once("::")?;
    let items: Vec<&str> = match items.strip_prefix('{') {
        Some(list) => list.strip_suffix('}')?.split(',').map(str::trim).filter(|item| !item.is_empty()).collect(),
        None => vec![items],
    };
    (!items.is_empty()).then(|| (module.to_string(), items))
}

/// Whether a module declares an item of that name at its top level.
fn declares(text: &str, item: &str) -> bool {
    // A declaration begins its line, perhaps after attributes; a variable's address space stands before its name.
    text.lines().filter(|line| !line.starts_with(char::is_whitespace)).any(|line| {
        ["fn ", "struct ", "const ", "override ", "alias ", "var<", "var "].iter().any(|keyword| {
            let Some((_, rest)) = line.split_once(keyword) else { return false };
            let name = if *keyword == "var<" { rest.split_once('>').map_or("", |(_, name)| name) } else { rest };
            name.trim_start().split(|c: char| !c.is_alphanumeric() && c != '_').next() == Some(item)
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_module_composes_and_validates() {
        for (name, _) in MODULES {
            let source = compose(name).unwrap_or_else(|e| panic!("{e}"));
            let module = naga::front::wgsl::parse_str(&source)
                .unwrap_or_else(|e| panic!("{name}: {}", e.emit_to_string(&source)));
            let capabilities = naga::valid::Capabilities::empty();
            naga::valid::Validator::new(naga::valid::ValidationFlags::all(), capabilities)
                .validate(&module)
                .unwrap_or_else(|e| panic!("{name}: {}", e.emit_to_string(&source)));
        }
    }

    #[test]
    fn each_module_comes_once_and_before_its_importers() {
        let modules = [
            ("a", "fn a() {}"),
            ("b", "import package::a::a;\nfn b() { a(); }"),
            ("c", "import package::b::{b};\nimport package::a::a;\nfn c() { a(); b(); }"),
        ];
        let source = compose_from(&modules, "c").unwrap();
        let at = |text: &str| source.find(text).unwrap();
        assert_eq!(source.matches("fn a()").count(), 1);
        assert!(at("fn a()") < at("fn b()") && at("fn b()") < at("fn c()"));
        assert!(!source.contains("import"));
    }

    #[test]
    fn what_is_wrong_is_named() {
        let modules = [
            ("a", "@group(0) @binding(0) var<storage, read> data: array<f32>;\nfn a() {}"),
            ("lost", "import package::nowhere::x;"),
            ("item", "import package::a::{a, data, missing};"),
            ("form", "import a.b"),
            ("loop", "import package::pool::p;\nfn l() {}"),
            ("pool", "import package::loop::l;\nfn p() {}"),
        ];
        let error = |name| compose_from(&modules, name).unwrap_err();
        assert!(error("none").to_string().contains("lib::segment"), "the names there are");
        assert_eq!(error("lost"), ComposeError::NoModule { name: "nowhere".into(), importer: "lost:1".into() });
        assert_eq!(
            error("item"),
            ComposeError::NoItem { importer: "item:1".into(), module: "a".into(), item: "missing".into() }
        );
        assert!(matches!(error("form"), ComposeError::Syntax { .. }));
        assert!(matches!(error("loop"), ComposeError::Cycle { .. }));
    }
}
