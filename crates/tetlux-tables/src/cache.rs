//! Tables of transfer functions, in memory, found by what they hold.

use std::sync::{Arc, Mutex, PoisonError};

use crate::spec::{SpecError, TableSpec};
use crate::store::key;
use crate::table::Table;

/// Keeps the tables used last, up to a number of bytes.
#[derive(Debug)]
pub struct TableCache {
    capacity: usize,
    /// The most recently used last.
    tables: Mutex<Vec<(String, Arc<Table>)>>,
}

impl TableCache {
    /// A cache that holds at most `capacity` bytes of texels (as f32); a larger table is built, given and not kept.
    pub fn new(capacity: usize) -> Self {
        Self { capacity, tables: Mutex::new(Vec::new()) }
    }

    /// The table of `spec`: the one in the cache if its content is the same, else a new one.
    ///
    /// Other callers wait while it is built, so that two never build the same.
    ///
    /// # Errors
    /// [`SpecError`] if the specification is not valid.
    pub fn get_or_build(&self, spec: &TableSpec) -> Result<Arc<Table>, SpecError> {
        spec.validate()?;
        let key = key(spec);
        // A panic while building left the list as it was.
        let mut tables = self.tables.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(index) = tables.iter().position(|(known, _)| *known == key) {
            let entry = tables.remove(index);
            let table = Arc::clone(&entry.1);
            tables.push(entry);
            return Ok(table);
        }
        let table = Arc::new(Table::build(spec)?);
        tables.push((key, Arc::clone(&table)));
        while tables.iter().map(|(_, table)| size_of_val(table.texels())).sum::<usize>() > self.capacity {
            tables.remove(0);
        }
        Ok(table)
    }

    /// Number of tables held.
    pub fn len(&self) -> usize {
        self.tables.lock().unwrap_or_else(PoisonError::into_inner).len()
    }

    /// Whether no table is held.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Precision, TableKind};

    fn spec(nodes: u32) -> TableSpec {
        TableSpec { id: "c".to_owned(), kind: TableKind::Psi, size: [nodes, nodes, 1], precision: Precision::F32 }
    }

    #[test]
    fn equal_specifications_share_a_table_and_others_do_not() {
        let cache = TableCache::new(1 << 20);
        let first = cache.get_or_build(&spec(8)).unwrap();
        assert!(Arc::ptr_eq(&first, &cache.get_or_build(&spec(8)).unwrap()));
        let other = TableSpec { precision: Precision::U8, ..spec(8) };
        assert!(!Arc::ptr_eq(&first, &cache.get_or_build(&other).unwrap()));
        assert_eq!(cache.len(), 2);
    }

    #[test]
    fn the_table_used_longest_ago_goes_first() {
        // Two tables of 8 x 8 texels of 4 bytes fit, three do not.
        let cache = TableCache::new(2 * 256);
        let sizes = [8, 7, 6];
        let [a, _] = [sizes[0], sizes[1]].map(|n| cache.get_or_build(&spec(n)).unwrap());
        assert!(Arc::ptr_eq(&a, &cache.get_or_build(&spec(8)).unwrap()), "still there, and now the latest");
        let c = cache.get_or_build(&spec(6)).unwrap();
        assert!(Arc::ptr_eq(&a, &cache.get_or_build(&spec(8)).unwrap()));
        assert!(Arc::ptr_eq(&c, &cache.get_or_build(&spec(6)).unwrap()));
        assert_eq!(cache.len(), 2);
    }

    #[test]
    fn too_large_a_table_is_given_but_not_kept() {
        let cache = TableCache::new(10);
        assert_eq!(cache.get_or_build(&spec(8)).unwrap().texels().len(), 64);
        assert!(cache.is_empty());
        assert!(cache.get_or_build(&spec(1)).is_err());
    }
}
