//! Comparison of shader text with its twin in Rust.

/// The numbers of the constant `name` in WGSL text, in order.
pub(crate) fn shader_constant(shader: &str, name: &str) -> Vec<f32> {
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

/// The literals of a function's body: what remains equal between the two languages.
pub(crate) fn numbers_of(source: &str, function: &str) -> Vec<f32> {
    let start = source.find(&format!("fn {function}(")).unwrap();
    let body = &source[start..][..source[start..].find("\n}").unwrap()];
    let code: Vec<&str> = body.lines().skip(1).map(|line| line.split("//").next().unwrap()).collect();
    let code = code.join("\n");
    let words = code.split(|c: char| !c.is_ascii_alphanumeric() && !"._-".contains(c));
    words.filter_map(|word| word.trim_matches('-').trim_end_matches('.').parse().ok()).collect()
}

/// Both texts have the same functions, with the same literals in each.
pub(crate) fn assert_same_functions(shader: &str, twin: &str) {
    let functions: Vec<&str> = shader.lines().filter_map(|line| line.strip_prefix("fn ")?.split('(').next()).collect();
    let ours = ["\nfn ", "\npub fn ", "\npub(crate) fn "].map(|start| twin.matches(start).count());
    assert!(!functions.is_empty() && functions.len() == ours.iter().sum::<usize>());
    for function in functions {
        let mut ours = numbers_of(twin, function);
        let mut theirs = numbers_of(shader, function);
        // Method and function calls order the same literals differently.
        ours.sort_by(f32::total_cmp);
        theirs.sort_by(f32::total_cmp);
        assert_eq!(ours, theirs, "{function}");
    }
}

/// The shader, with the shaders it imports, is valid WGSL without resources of its own.
pub(crate) fn assert_valid_shader(parts: &[&str]) {
    let lines = parts.iter().flat_map(|part| part.lines()).filter(|line| !line.starts_with("import "));
    let source: Vec<&str> = lines.collect();
    let source = source.join("\n");
    let module =
        naga::front::wgsl::parse_str(&source).unwrap_or_else(|error| panic!("{}", error.emit_to_string(&source)));
    let flags = naga::valid::ValidationFlags::all();
    naga::valid::Validator::new(flags, naga::valid::Capabilities::empty()).validate(&module).unwrap();
    assert!(module.entry_points.is_empty() && module.global_variables.is_empty());
}
