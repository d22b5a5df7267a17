//! Every WGSL module of tetlux, by name, and the composer that joins them.
//!
//! A module says what it needs with `import package::lib::name::{item, other};` (a subset of WESL: the files stay valid
//! WESL). [`compose`] puts every module that an entry needs before it, each once. Items keep their names, so the
//! names of all modules are one space.
//!
//! Methods are composed: `import package::axes::weights::{weights};` names an axis, and whoever composes says which of
//! its modules stands there, such as `weights::direct` (in the file `weights/direct.wgsl`). All modules of an axis
//! declare the same items.
//!
//! ```
//! use tetlux_shaders::{DEFAULTS, choose, compose};
//!
//! let source = compose("stages::draw", &choose(DEFAULTS, &[("weights", "weights::average")]))?;
//! assert!(source.contains("fn weights(") && source.contains("weights_average"));
//! # Ok::<(), tetlux_shaders::ComposeError>(())
//! ```

#[cfg(feature = "planted")]
pub mod planted;

macro_rules! modules {
    ($($folder:ident { $($file:ident)+ })+) => {
        &[$($((
            concat!(stringify!($folder), "::", stringify!($file)),
            include_str!(concat!("../", stringify!($folder), "/", stringify!($file), ".wgsl")),
        )),+),+]
    };
}

/// Every module: its name and its text. `lib` holds functions, `stages` entry points; every other folder is an axis.
pub const MODULES: &[(&str, &str)] = modules! {
    lib {
        balanced cell erf flat further gradients image integrated light lit_linear look lookup mesh mesh_buffers no_data
        plane prepared published radix ray ready scanned segment silhouette span spent symmetric thick tiles tiling transfer
        triangle two_fields view volume walk whole widget widget_tables widgets
    }
    attributes { classified given }
    data { cell mixed point }
    function { analytic approximate image two_fields widgets }
    geometry { balanced ray thick vicp }
    grouping { none sorted }
    lit { one_field turns two_fields }
    interpolation { perspective screen_linear }
    output { dither plain straight }
    quantity { color lit pair scalar }
    sample { image widgets }
    second { cell none point }
    shading { lit post_clip post_exact preint preint_log preint_q two_scalars vertex }
    source { computed stored }
    surface { none opaque }
    weights { average direct linear psi q symmetric }
    stages { add balance bounds count decompose depths draw fill group histogram march project scan scatter tiles }
};

/// An axis and the module that stands for it.
pub type Choice = (&'static str, &'static str);

/// The module of every axis that a scene takes unless told otherwise.
pub const DEFAULTS: &[Choice] = &[
    ("attributes", "attributes::classified"),
    ("data", "data::point"),
    ("function", "function::widgets"),
    ("geometry", "geometry::ray"),
    ("grouping", "grouping::none"),
    ("interpolation", "interpolation::perspective"),
    ("lit", "lit::turns"),
    ("output", "output::plain"),
    ("quantity", "quantity::scalar"),
    ("sample", "sample::widgets"),
    ("second", "second::none"),
    ("shading", "shading::post_exact"),
    ("source", "source::stored"),
    ("surface", "surface::none"),
    ("weights", "weights::direct"),
];

/// `choices` with some of them replaced.
pub fn choose(choices: &[Choice], others: &[Choice]) -> Vec<Choice> {
    let other = |axis: &str| others.iter().find(|(name, _)| *name == axis);
    choices.iter().map(|choice| *other(choice.0).unwrap_or(choice)).collect()
}

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
    /// An axis without a choice.
    #[error("{importer}: no module is chosen for the axis \"{axis}\"")]
    NoChoice {
        /// The axis.
        axis: String,
        /// The importing module and line.
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

/// The text of a module with all it imports, directly or not, ahead of it; `choices` say which modules stand for the
/// axes. Those that are not asked for do not matter.
///
/// # Errors
///
/// A module, an item or a choice that there is not; an import that cannot be read; a module that imports itself.
pub fn compose(entry: &str, choices: &[Choice]) -> Result<String, ComposeError> {
    compose_from(MODULES, entry, choices)
}

fn compose_from(modules: &[(&str, &str)], entry: &str, choices: &[Choice]) -> Result<String, ComposeError> {
    let mut composer = Composer { modules, choices, path: Vec::new(), done: Vec::new(), output: String::new() };
    composer.append(entry, "")?;
    Ok(composer.output)
}

struct Composer<'a> {
    modules: &'a [(&'a str, &'a str)],
    choices: &'a [Choice],
    /// The modules that are being appended.
    path: Vec<String>,
    /// Those that have been.
    done: Vec<String>,
    output: String,
}

impl Composer<'_> {
    /// Appends a module after those it imports.
    fn append(&mut self, name: &str, importer: &str) -> Result<(), ComposeError> {
        let text = find(self.modules, name, importer)?;
        if self.path.iter().any(|p| p == name) {
            return Err(ComposeError::Cycle { name: name.into(), through: self.path.join(", ") });
        }
        if self.done.iter().any(|d| d == name) {
            return Ok(());
        }
        self.path.push(name.into());
        #[cfg(feature = "planted")]
        let text = &planted::edited(name, text);
        let mut body = String::new();
        for (number, line) in text.lines().enumerate() {
            if !line.starts_with("import ") {
                body.push_str(line);
                body.push('\n');
                continue;
            }
            let importer = format!("{name}:{}", number + 1);
            let (module, items) = parse_import(line)
                .ok_or_else(|| ComposeError::Syntax { importer: importer.clone(), text: line.into() })?;
            let module = self.resolve(module, &importer)?;
            let imported = find(self.modules, &module, &importer)?;
            for item in items {
                if !declares(imported, item) {
                    return Err(ComposeError::NoItem { importer, module, item: item.into() });
                }
            }
            self.append(&module, &importer)?;
            // An empty line in place of the import keeps the module's line numbers.
            body.push('\n');
        }
        self.output.push_str(&format!("// ---- {name}\n{body}"));
        self.path.pop();
        self.done.push(name.into());
        Ok(())
    }

    /// The module that stands for an axis; any other as it is.
    fn resolve(&self, module: String, importer: &str) -> Result<String, ComposeError> {
        let Some(axis) = module.strip_prefix("axes::") else { return Ok(module) };
        let choice = self.choices.iter().find(|(name, _)| *name == axis);
        choice
            .map(|(_, module)| (*module).to_string())
            .ok_or_else(|| ComposeError::NoChoice { axis: axis.into(), importer: importer.into() })
    }
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

    fn validate(name: &str, choices: &[Choice]) {
        let source = compose(name, choices).unwrap_or_else(|e| panic!("{e}"));
        let module = naga::front::wgsl::parse_str(&source)
            .unwrap_or_else(|e| panic!("{name} of {choices:?}: {}", e.emit_to_string(&source)));
        let capabilities = naga::valid::Capabilities::empty();
        naga::valid::Validator::new(naga::valid::ValidationFlags::all(), capabilities)
            .validate(&module)
            .unwrap_or_else(|e| panic!("{name} of {choices:?}: {}", e.emit_to_string(&source)));
    }

    /// What a module of an axis needs of the others.
    fn with_companions(axis: &'static str, name: &'static str) -> Vec<Choice> {
        let others: &[Choice] = match name {
            "shading::vertex" => &[("quantity", "quantity::color")],
            "interpolation::perspective" | "interpolation::screen_linear" | "source::stored" | "source::computed" => {
                &[("geometry", "geometry::thick")]
            }
            "quantity::color" | "attributes::classified" | "attributes::given" => {
                &[("quantity", "quantity::color"), ("shading", "shading::vertex")]
            }
            "shading::two_scalars" | "quantity::pair" | "second::cell" | "second::point" => &[
                ("function", "function::two_fields"),
                ("quantity", "quantity::pair"),
                ("shading", "shading::two_scalars"),
            ],
            "shading::lit" | "quantity::lit" | "lit::one_field" | "lit::turns" | "lit::two_fields" => {
                &[("quantity", "quantity::lit"), ("shading", "shading::lit")]
            }
            "function::analytic" | "function::approximate" | "sample::image" | "sample::widgets" => &[
                ("function", "function::approximate"),
                ("quantity", "quantity::pair"),
                ("shading", "shading::two_scalars"),
            ],
            "function::image" | "function::two_fields" | "function::widgets" => {
                &[("quantity", "quantity::lit"), ("shading", "shading::lit")]
            }
            _ => &[],
        };
        choose(&choose(DEFAULTS, others), &[(axis, name)])
    }

    #[test]
    fn every_module_composes_and_validates() {
        for &(name, _) in MODULES {
            let (folder, _) = name.split_once("::").unwrap();
            if ["lib", "stages"].contains(&folder) {
                validate(name, DEFAULTS);
            } else {
                assert!(DEFAULTS.iter().any(|(axis, _)| *axis == folder), "{name} is of no axis");
                let choices = with_companions(folder, name);
                validate(name, &choices);
                validate("stages::draw", &choices);
            }
        }
    }

    #[test]
    fn each_module_comes_once_and_before_its_importers() {
        let modules = [
            ("a", "fn a() {}"),
            ("b", "import package::a::a;\nfn b() { a(); }"),
            ("c", "import package::b::{b};\nimport package::a::a;\nfn c() { a(); b(); }"),
        ];
        let source = compose_from(&modules, "c", &[]).unwrap();
        let at = |text: &str| source.find(text).unwrap();
        assert_eq!(source.matches("fn a()").count(), 1);
        assert!(at("fn a()") < at("fn b()") && at("fn b()") < at("fn c()"));
        assert!(!source.contains("import"));
    }

    #[test]
    fn an_axis_is_what_the_caller_chooses() {
        let modules = [
            ("noise::loud", "fn noise() { loud(); }"),
            ("noise::soft", "fn noise() { soft(); }"),
            ("noise::none", "fn silence() {}"),
            ("entry", "import package::axes::noise::{noise};\nfn entry() { noise(); }"),
        ];
        let composed = |module| compose_from(&modules, "entry", &[("noise", module)]);
        assert!(composed("noise::loud").unwrap().contains("loud()"));
        assert!(!composed("noise::soft").unwrap().contains("loud()"));
        assert!(matches!(composed("noise::none"), Err(ComposeError::NoItem { .. })));
        assert!(matches!(composed("noise::odd"), Err(ComposeError::NoModule { .. })));
        let none = compose_from(&modules, "entry", &[]).unwrap_err();
        assert_eq!(none, ComposeError::NoChoice { axis: "noise".into(), importer: "entry:1".into() });
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
        let error = |name| compose_from(&modules, name, &[]).unwrap_err();
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
