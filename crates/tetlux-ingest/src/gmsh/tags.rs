//! From the tags of nodes or elements, which need not be consecutive, to their places.

/// Places by tag.
#[derive(Default, PartialEq, Eq)]
pub(super) struct Tags {
    /// In ascending order, with the place of each.
    sorted: Vec<(u64, u32)>,
    /// Whether tag and place in `sorted` differ by the first tag: then there is nothing to search.
    dense: bool,
}

impl Tags {
    /// Fails with a tag that is there twice.
    pub(super) fn new(tags: Vec<u64>) -> Result<Tags, u64> {
        // There are fewer than 2^32: their places fit.
        let mut sorted: Vec<(u64, u32)> = tags.into_iter().enumerate().map(|(i, tag)| (tag, i as u32)).collect();
        sorted.sort_unstable();
        if let Some(pair) = sorted.windows(2).find(|pair| pair[0].0 == pair[1].0) {
            return Err(pair[0].0);
        }
        let ends = sorted.first().zip(sorted.last());
        let dense = ends.is_some_and(|(first, last)| last.0 - first.0 == sorted.len() as u64 - 1);
        Ok(Tags { sorted, dense })
    }

    /// The place of a tag.
    pub(super) fn get(&self, tag: u64) -> Option<u32> {
        if self.dense {
            let at = usize::try_from(tag.checked_sub(self.sorted[0].0)?).ok()?;
            return self.sorted.get(at).map(|&(_, place)| place);
        }
        self.sorted.binary_search_by_key(&tag, |&(tag, _)| tag).ok().map(|i| self.sorted[i].1)
    }
}

#[cfg(test)]
mod tests {
    use super::Tags;

    #[test]
    fn tags_are_found_in_any_order_dense_or_sparse() {
        for tags in [vec![7, 5, 6], vec![100, u64::MAX, 3], vec![]] {
            let found = Tags::new(tags.clone()).unwrap();
            assert!(
                (0..200)
                    .chain([u64::MAX])
                    .all(|tag| { found.get(tag).map(|place| place as usize) == tags.iter().position(|&t| t == tag) })
            );
        }
        assert_eq!(Tags::new(vec![4, 9, 4]).err(), Some(4));
    }
}
