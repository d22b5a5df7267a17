//! A writer of netCDF's classic formats.

/// A dimension; of length 0 it is the record dimension.
pub(super) type Dimension = (&'static str, u64);

pub(super) const CHAR: u32 = 2;
pub(super) const I32: u32 = 4;
pub(super) const F32: u32 = 5;
pub(super) const F64: u32 = 6;
pub(super) const I64: u32 = 10;

#[derive(Clone)]
pub(super) struct Variable {
    pub(super) name: String,
    /// Names of dimensions.
    pub(super) dimensions: Vec<&'static str>,
    pub(super) elem_type: Option<&'static str>,
    pub(super) kind: u32,
    /// All values, those of one record after another.
    pub(super) values: Vec<f64>,
}

#[derive(Clone)]
pub(super) struct File {
    /// 1, 2 or 5.
    pub(super) version: u8,
    pub(super) records: u64,
    pub(super) dimensions: Vec<Dimension>,
    pub(super) variables: Vec<Variable>,
}

impl File {
    pub(super) fn add(&mut self, name: &str, dimensions: &[&'static str], kind: u32, values: Vec<f64>) {
        let (name, dimensions) = (name.to_string(), dimensions.to_vec());
        self.variables.push(Variable { name, dimensions, elem_type: None, kind, values });
    }

    /// Adds texts of 8 bytes.
    pub(super) fn add_names(&mut self, name: &str, dimension: &'static str, names: &[&str]) {
        let bytes = names.iter().flat_map(|n| format!("{n:\0<8}").into_bytes()).map(f64::from).collect();
        self.add(name, &[dimension, "len_name"], CHAR, bytes);
    }

    pub(super) fn variable(&mut self, name: &str) -> &mut Variable {
        self.variables.iter_mut().find(|v| v.name == name).unwrap()
    }

    pub(super) fn bytes(&self) -> Vec<u8> {
        // The header's length does not depend on the places that it states.
        let start = self.header(&vec![0; self.variables.len()]).len() as u64;
        let of_records = |v: &&Variable| self.is_record(v);
        let lonely = self.variables.iter().filter(of_records).count() == 1;
        let mut at = start;
        let mut begins = vec![0; self.variables.len()];
        let mut data = Vec::new();
        for (v, variable) in self.variables.iter().enumerate().filter(|(_, v)| !self.is_record(v)) {
            begins[v] = at;
            let bytes = padded(encoded(variable.kind, &variable.values));
            at += bytes.len() as u64;
            data.extend(bytes);
        }
        for record in 0..self.records as usize {
            for (v, variable) in self.variables.iter().enumerate().filter(|(_, v)| self.is_record(v)) {
                if record == 0 {
                    begins[v] = start + data.len() as u64;
                }
                let length = variable.values.len() / self.records as usize;
                let bytes = encoded(variable.kind, &variable.values[record * length..][..length]);
                data.extend(if lonely { bytes } else { padded(bytes) });
            }
        }
        [self.header(&begins), data].concat()
    }

    fn is_record(&self, variable: &Variable) -> bool {
        variable.dimensions.first().is_some_and(|d| self.dimensions.contains(&(d, 0)))
    }

    fn header(&self, begins: &[u64]) -> Vec<u8> {
        let wide = self.version == 5;
        let number =
            |wide: bool, n: u64| if wide { n.to_be_bytes().to_vec() } else { (n as u32).to_be_bytes().to_vec() };
        let count = |n: usize| number(wide, n as u64);
        let name = |text: &str| [count(text.len()), padded(text.as_bytes().to_vec())].concat();
        let tag = |tag: u32, length: usize| {
            [(if length == 0 { 0 } else { tag }).to_be_bytes().to_vec(), count(length)].concat()
        };
        let mut bytes = [b"CDF".as_slice(), &[self.version]].concat();
        bytes.extend(number(wide, self.records));
        bytes.extend(tag(10, self.dimensions.len()));
        for (dimension, length) in &self.dimensions {
            bytes.extend([name(dimension), count(*length as usize)].concat());
        }
        // An attribute of the file, with a padding.
        bytes.extend(
            [tag(12, 1), name("title"), CHAR.to_be_bytes().to_vec(), count(5), padded(b"test!".to_vec())].concat(),
        );
        bytes.extend(tag(11, self.variables.len()));
        for (variable, &begin) in self.variables.iter().zip(begins) {
            bytes.extend([name(&variable.name), count(variable.dimensions.len())].concat());
            for dimension in &variable.dimensions {
                bytes.extend(count(self.dimensions.iter().position(|(d, _)| d == dimension).unwrap()));
            }
            bytes.extend(tag(12, usize::from(variable.elem_type.is_some())));
            if let Some(kind) = variable.elem_type {
                bytes.extend([name("elem_type"), CHAR.to_be_bytes().to_vec(), count(kind.len())].concat());
                bytes.extend(padded(kind.as_bytes().to_vec()));
            }
            bytes.extend(variable.kind.to_be_bytes());
            bytes.extend(count(0));
            bytes.extend(number(self.version != 1, begin));
        }
        bytes
    }
}

fn padded(mut bytes: Vec<u8>) -> Vec<u8> {
    bytes.resize(bytes.len().next_multiple_of(4), 0);
    bytes
}

fn encoded(kind: u32, values: &[f64]) -> Vec<u8> {
    let each = |v: &f64| match kind {
        CHAR => vec![*v as u8],
        3 => (*v as i16).to_be_bytes().to_vec(),
        I32 => (*v as i32).to_be_bytes().to_vec(),
        F32 => (*v as f32).to_be_bytes().to_vec(),
        F64 => v.to_be_bytes().to_vec(),
        I64 => (*v as i64).to_be_bytes().to_vec(),
        _ => panic!("no type {kind}"),
    };
    values.iter().flat_map(each).collect()
}
